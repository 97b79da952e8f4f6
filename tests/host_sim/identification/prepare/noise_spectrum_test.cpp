// The colour of noise above the motion.
#include "host_sim/identification/prepare/noise_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <tuple>
#include <vector>

#include "firmware/simulation/road.hpp"
#include "host_sim/identification/prepare/sensor_noise.hpp"
#include "tests/host_sim/identification/test_signals.hpp"
#include "tests/support/reference_road.hpp"
#include "tests/truth/recorder.hpp"

namespace {

using namespace host_sim;
using identification::ChannelNoise;
using identification::NoiseColour;
using identification::NoiseSpectrumFit;

constexpr double period = 1e-3;

std::vector<double> normal(double rms, std::size_t count, std::uint64_t seed) {
  support::NormalNoise noise(seed);
  std::vector<double> samples(count);
  for (double& v : samples) v = rms * noise();
  return samples;
}

/// Through a digital low-pass of first order: bilinear, T = 1/(2π corner).
std::vector<double> low_passed(const std::vector<double>& samples, double corner) {
  const double k = std::tan(std::numbers::pi * corner * period);
  std::vector<double> out;
  double before = 0.0, last = 0.0;
  for (const double v : samples) {
    last = (k * (v + before) + (1.0 - k) * last) / (1.0 + k);
    before = v;
    out.push_back(last);
  }
  return out;
}

// Point. At its corner a low-pass of any order leaves half of the power; white noise has no corner. The mean of (1)
// with order 1 and the digital filter is t/(1 + t), t = tan(π corner T).
TEST(NoiseColour, HasHalfOfThePowerAtItsCorner) {
  using enum NoiseColour::Filter;
  for (const NoiseColour::Filter filter : {digital, analogue, folded}) {
    for (const int order : {1, 2, 4}) {
      const NoiseColour colour{150.0, order, filter};
      EXPECT_NEAR(colour.power(150.0, period), 0.5, 1e-12);
      EXPECT_NEAR(colour.power(0.0, period), 1.0, 1e-12);
    }
  }
  EXPECT_EQ(NoiseColour{}.power(400.0, period), 1.0);
  const double t = std::tan(std::numbers::pi * 150.0 * period);
  EXPECT_NEAR((NoiseColour{150.0, 1, digital}.mean_power(period)), t / (1.0 + t), 1e-5);
}

// Law. The sum over 8 images is (2) over many, to 2e-3 of it.
TEST(NoiseColour, KnowsHeldNoise) {
  for (const double corner : {70.0, 150.0, 390.0}) {
    for (const double f : {1.0, 70.0, 300.0, 480.0}) {
      std::complex<double> images = 0.0;
      for (int k = -2000; k <= 2000; ++k) {
        const double shifted = f + k / period, x = shifted / corner;
        images += 1.0 / std::complex(1.0 - x * x, std::sqrt(2.0) * x) / (shifted * period);
      }
      const double exact = std::norm(images * std::sin(std::numbers::pi * f * period) / std::numbers::pi);
      EXPECT_NEAR((NoiseColour{corner, 2, NoiseColour::Filter::held}.power(f, period)), exact, 2e-3 * exact);
    }
  }
}

// Law. Read later, it is the sum over the images, turned: to 3e-3 where they cancel each other. Of first order it is
// the answer of a low-pass to a value that is held for a sample.
TEST(NoiseColour, KnowsWhenHeldNoiseIsRead) {
  constexpr double corner = 90.0;
  for (const double late : {-0.05, 0.0, 0.08}) {
    for (const int order : {1, 2}) {
      for (const double f : {1.0, 70.0, 300.0, 480.0}) {
        std::complex<double> images = 0.0;
        for (int k = -20'000; k <= 20'000; ++k) {
          const double shifted = f + k / period, x = shifted / corner;
          const auto low_pass = order == 1 ? std::complex(1.0, x) : std::complex(1.0 - x * x, std::sqrt(2.0) * x);
          images += std::polar(1.0, 2.0 * std::numbers::pi * late * k) / low_pass / (shifted * period);
        }
        const double exact = std::norm(images * std::sin(std::numbers::pi * f * period) / std::numbers::pi);
        const identification::NoiseColour colour{corner, order, identification::NoiseColour::Filter::held, late};
        EXPECT_NEAR(colour.power(f, period), exact, 3e-3 * exact) << order << ", " << late << ", " << f;
      }
    }
  }
}

// Law. Read a twentieth of a sample late or early, level and corner are found as exactly as their intervals say: the
// mean over 20 seeds lies within three standard errors of the mean. (With d = 0 the corner of second order was 5 Hz too
// high or too low, two of its standard errors.)
TEST(NoiseSpectrum, FindsWhenHeldNoiseIsRead) {
  constexpr int fine = 20, seeds = 20;
  constexpr double corner = 93.0;
  for (const int order : {1, 2}) {
    for (const bool is_late : {false, true}) {
      double corners = 0.0, levels = 0.0, half_widths = 0.0;
      for (unsigned seed = 1; seed <= seeds; ++seed) {
        truth::LowPass filter(corner, order, period / fine);
        support::NormalNoise noise(seed);
        std::vector<double> samples;
        for (int k = 0; k < 20'000; ++k) {
          const double value = noise();
          for (int i = 0; i < fine; ++i) {
            const double behind = filter.push(value);
            if (i == (is_late ? 0 : fine - 1)) samples.push_back(behind);
          }
        }
        const auto fit = identification::fit_noise_spectrum(samples, period, false);
        ASSERT_TRUE(fit);
        EXPECT_EQ(fit->noise.colour.order, order) << is_late << ", seed " << seed;
        corners += fit->noise.colour.corner / seeds;
        levels += fit->noise.level / seeds;
        half_widths += fit->noise.corner_half_width / seeds;
      }
      const double error = half_widths / 1.96 / std::sqrt(seeds);
      EXPECT_NEAR(corners, corner, 3.0 * error) << order << ", " << is_late << ", seeds 1 to 20";
      // Above the corner only level · corner^order is seen.
      EXPECT_NEAR(levels, 1.0, 3.0 * order * error / corner) << order << ", " << is_late << ", seeds 1 to 20";
    }
  }
}

// Law. Noise of a value a sample behind an analogue low-pass of second order, in steps of a twentieth of one: level and
// corner are found. (Before, the level was off by a factor of five, under a tail that is not there.)
TEST(NoiseSpectrum, FindsALowPassBeforeTheConverter) {
  constexpr int fine = 20;
  for (const double corner : {90.0, 160.0}) {
    truth::LowPass filter(corner, 2, period / fine);
    support::NormalNoise noise(11);
    std::vector<double> samples;
    for (int k = 0; k < 40'000; ++k) {
      const double value = noise();
      double behind = 0.0;
      for (int i = 0; i < fine; ++i) behind = filter.push(value);
      samples.push_back(behind);
    }
    const auto fit = identification::fit_noise_spectrum(samples, period, false);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->noise.colour.order, 2) << corner << ", seed 11";
    EXPECT_EQ(fit->tail, 0.0) << corner << ", seed 11";
    EXPECT_NEAR(fit->noise.colour.corner, corner, 2.0 * fit->noise.corner_half_width) << "seed 11";
    EXPECT_LT(fit->noise.corner_half_width, 0.1 * corner) << "seed 11";
    // Above the corner only its square times the level is seen, so twice its share, and 5 %.
    EXPECT_NEAR(fit->noise.level, 1.0, 4.0 * fit->noise.corner_half_width / corner + 0.05) << corner << ", seed 11";
  }
}

// Law. Level and corner of filtered noise under a motion of 20 Hz, for several corners. The level's standard error is
// that of the fit; five of them, and 5 % for what the median of a band misses.
TEST(NoiseSpectrum, FindsLevelAndCornerUnderAMotion) {
  for (const double corner : {90.0, 150.0, 250.0}) {
    std::vector<double> samples = low_passed(normal(1e-3, 40'000, 3), corner);
    const std::vector<double> motion = sample::sine(1.0, 20.0, samples.size());
    for (std::size_t k = 0; k < samples.size(); ++k) samples[k] += motion[k];
    const auto fit = identification::fit_noise_spectrum(samples, period, true);
    ASSERT_TRUE(fit);
    EXPECT_FALSE(fit->noise.colour.is_white());
    EXPECT_NEAR(fit->noise.level, 1e-3, 1e-3 * (5.0 * fit->noise.relative_error + 0.05)) << corner << ", seed 3";
    EXPECT_NEAR(fit->noise.colour.corner, corner, 2.0 * fit->noise.corner_half_width + 0.05 * corner) << "seed 3";
  }
}

// Law. A corner that other channels have is believed where the channel's own spectrum says little against it; its
// interval is that of this spectrum, and holds the truth.
TEST(NoiseSpectrum, KnowsAnExpectedCornerNoBetterThanItsSpectrum) {
  const std::vector<double> samples = low_passed(normal(1e-3, 20'000, 5), 150.0);
  const auto fit =
      identification::fit_noise_spectrum(samples, period, true, NoiseColour{152.0, 1, NoiseColour::Filter::digital});
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->noise.colour.corner, 152.0) << "seed 5";
  EXPECT_GT(fit->noise.corner_half_width, 2.0) << "seed 5";
  EXPECT_LT(fit->noise.corner_half_width, 0.15 * 152.0) << "seed 5";
}

// Law. Steps of a force at every reversal are a tail, no colour and no noise: the level of the white noise below them
// is found, while sixth differences take the tail for noise.
TEST(NoiseSpectrum, TellsTheTailOfStepsFromNoise) {
  std::vector<double> samples = normal(1.0, 60'000, 4);
  support::NormalNoise noise(5);
  double force = 40.0;
  std::size_t next = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k == next) {
      force = -force;
      next += static_cast<std::size_t>(30.0 + 10.0 * std::abs(noise()));
    }
    samples[k] += force;
  }
  const auto fit = identification::fit_noise_spectrum(samples, period, false);
  ASSERT_TRUE(fit);
  EXPECT_GT(fit->tail, 0.0);
  EXPECT_NEAR(fit->noise.level, 1.0, 5.0 * fit->noise.relative_error + 0.1) << "seeds 4, 5";
  EXPECT_GT(identification::estimated_noise(samples), 1.5);
}

// Law. A road that a low-pass of fourth order rounds off at 30 Hz reaches to 300 Hz in the acceleration of the foot
// point: a tail above white noise, and no colour. (Before: noise of 10 to 58 times the level, low-passed.)
TEST(NoiseSpectrum, TellsTheTailOfARoadFromNoise) {
  for (const char road_class : {'A', 'B', 'C'}) {
    const firmware::IsoRoad road{
        .roughness = firmware::class_roughness({&road_class, 1}), .bandwidth = 30.0, .seed = 6};
    std::vector<double> accelerations = normal(0.05, 40'000, 7), positions = normal(2e-5, 40'000, 8);
    const firmware::FootPointMotion motion = firmware::drive_over(road, 1.0 / period, accelerations.size());
    for (std::size_t k = 0; k < motion.size(); ++k) {
      accelerations[k] += motion[k].acceleration;
      positions[k] += motion[k].position;
    }
    for (const auto& [samples, level, is_position] :
         {std::tuple{accelerations, 0.05, false}, {positions, 2e-5, true}}) {
      const auto noise = identification::noise_in(
          samples, period, is_position ? model::Channel::z_r : model::Channel::zdd_r, std::nullopt);
      EXPECT_TRUE(noise.colour.is_white()) << road_class << ", seeds 6 to 8";
      EXPECT_NEAR(noise.level, level, level * (5.0 * noise.relative_error + 0.05)) << road_class << ", seeds 6 to 8";
    }
  }
}

// Of what declared channels say, a low-pass that most positions have is the recorder's.
TEST(ExpectedColour, IsWhatMostPositionsHave) {
  identification::ChannelNoises noises;
  const ChannelNoise filtered{1e-5, {200.0, 2, NoiseColour::Filter::digital}, 0.01, 5.0, 0.0};
  const ChannelNoise white{1e-5, {}, 0.01, 0.0, 0.0};
  EXPECT_FALSE(identification::expected_colour(noises));
  noises[index(model::Channel::z_r)] = noises[index(model::Channel::dz_b)] = filtered;
  noises[index(model::Channel::dz_w)] = white;
  ASSERT_TRUE(identification::expected_colour(noises));
  EXPECT_EQ(identification::expected_colour(noises)->corner, 200.0);
  noises[index(model::Channel::z_r)] = white;
  EXPECT_FALSE(identification::expected_colour(noises));

  // One position alone: its corner counts, unless it lies below all that are seen.
  identification::ChannelNoises alone;
  ChannelNoise& only = alone[index(model::Channel::x_act)] = filtered;
  EXPECT_TRUE(identification::expected_colour(alone));
  only.corner_half_width = 2.0 * only.colour.corner;
  EXPECT_FALSE(identification::expected_colour(alone));
  alone[index(model::Channel::z_b)] = only;
  EXPECT_TRUE(identification::expected_colour(alone)) << "two that agree";
}

}  // namespace
