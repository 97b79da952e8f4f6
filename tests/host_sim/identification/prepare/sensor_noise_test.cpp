// Noise is estimated under a signal.
#include "host_sim/identification/prepare/sensor_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "tests/host_sim/identification/test_signals.hpp"
#include "tests/support/reference_road.hpp"

namespace sensor_noise_test {
namespace {

using namespace firmware;
using namespace host_sim;
using model::Channel;
using sample::sine;

/// A sine of 20 Hz at 1 kHz under normal noise, as channel dz_b.
Recording noisy(double rms, std::uint64_t seed) {
  Recording recording;
  recording.sample_period = 1e-3;
  auto& samples = recording[Channel::dz_b];
  samples = sine(1.0, 20.0, 20'000);
  support::NormalNoise noise(seed);
  for (double& v : samples) v += rms * noise();
  return recording;
}

RigDescription declared(double rms) {
  RigDescription description;
  description.noise[index(Channel::dz_b)] = rms;
  return description;
}

// Point. Sixth differences of a sine leave (2 sin(ωh/2))⁶ of it: nothing at 20 Hz and 1 kHz. The median of K = 937
// variances with k = 20 degrees of freedom each scatters by 1.25 √(2/20)/√K = 1.3 %, its root by half of that.
TEST(EstimatedNoise, SeesNoiseUnderASignal) {
  auto signal = sine(1.0, 20.0, 60'000);
  support::NormalNoise noise(7);
  for (double& v : signal) v += 1e-3 * noise();
  EXPECT_NEAR(identification::estimated_noise(signal) / 1e-3, 1.0, 4.0 * 0.0065) << "seed 7";
}

// Noise that is 2.1 times as loud as declared is taken as it is; its 95 % interval holds the truth in 15 of 20 records
// at least (binomial: a chance of 3e-4 for fewer). Half as loud as well. 3 % are as declared.
TEST(NoiseFactor, CorrectsADeclaration) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto factor = identification::noise_factor(declared(1e-3), noisy(2.1e-3, seed), Channel::dz_b);
    ASSERT_TRUE(factor);
    EXPECT_NEAR(factor->value, 2.1, 0.15);
    held += std::abs(factor->value - 2.1) < factor->half_width ? 1 : 0;
  }
  EXPECT_GE(held, 15);
  EXPECT_NEAR(identification::sensor_noise(declared(1e-3), noisy(2.1e-3, 1), Channel::dz_b), 2.1e-3, 0.15e-3);
  EXPECT_NEAR(identification::sensor_noise(declared(1e-3), noisy(0.5e-3, 1), Channel::dz_b), 0.5e-3, 0.04e-3);
  EXPECT_EQ(identification::sensor_noise(declared(1e-3), noisy(1.0e-3, 1), Channel::dz_b), 1e-3);
  EXPECT_NEAR(identification::sensor_noise(declared(1e-3), noisy(1e-2, 1), Channel::dz_b), 1e-2, 0.7e-3);
}

// Law. A level that is known to 9 % is the mean of both in logarithms, weighted by (ln 3)² and 0.09²; one that is not
// known to 10 % (thresholds::noise_level_known) says nothing.
TEST(NoiseFactor, WeighsWhatIsDeclaredByHowFarItIsUsuallyWrong) {
  using identification::ChannelNoise;
  const ChannelNoise known{2e-2, {}, 0.09, 0.0, 0.0}, unknown{2e-2, {}, 0.11, 0.0, 0.0};
  const double share = 1.0 / (1.0 + std::pow(0.09 / std::log(3.0), 2));
  EXPECT_NEAR(identification::with_declared(known, 1e-3, 1e-3).noise.level, 1e-3 * std::pow(20.0, share), 1e-12);
  EXPECT_EQ(identification::with_declared(unknown, 1e-3, 1e-3).noise.level, 1e-3);
  // At 333 Hz, where it is coloured and where it ends, noise may be motion: three times the declared rms at most.
  EXPECT_NEAR(identification::with_declared(known, 1e-3, 3e-3).noise.level, 3e-3, 1e-9);
  ChannelNoise ends = known;
  ends.ends = true;
  EXPECT_NEAR(identification::with_declared(ends, 1e-3, 1e-3).noise.level, 3e-3, 1e-9);
  const ChannelNoise coloured{2e-2, {100.0, 2}, 0.01, 0.0, 0.0};
  EXPECT_NEAR(identification::with_declared(coloured, 1e-3, 1e-3).noise.rms(1e-3), 3e-3, 1e-9);
}

// Edge. A multisine that is flat from 5 Hz to its last line at 150 Hz, lines of 0.5 Hz with random phases: above the
// motion's usual end it looks like white noise, 100 times as loud as declared, but then it would not end.
TEST(NoiseFactor, IsNotReadOffAMultisine) {
  Recording multisine = noisy(1e-6, 1);
  support::NormalNoise random(2);
  for (double f = 5.0; f <= 150.0; f += 0.5) {
    const double phase = 1e3 * random();
    for (std::size_t k = 0; k < multisine[Channel::dz_b].size(); ++k)
      multisine[Channel::dz_b][k] += 0.1 * std::sin(2.0 * std::numbers::pi * f * 1e-3 * static_cast<double>(k) + phase);
  }
  EXPECT_LE(identification::sensor_noise(declared(1e-2), multisine, Channel::dz_b), 3.01e-2);
}

// Behind a filter noise is not white: the level below its corner is what the declared rms stands for. The declaration
// is of the noise before the filter here, so that less of it is found.
TEST(NoiseFactor, KnowsTheColourOfNoise) {
  Recording recording = noisy(2.1e-3, 3);
  double filtered = 0.0;
  for (double& v : recording[Channel::dz_b]) v = filtered += 0.6 * (v - filtered);  // a corner of about 150 Hz
  const auto found = identification::find_sensor_noise(declared(1e-3), recording, Channel::dz_b);
  EXPECT_FALSE(found.noise.colour.is_white());
  EXPECT_NEAR(found.noise.level, 2.1e-3, 0.15e-3) << "seed 3";
  // Σ h² of that filter is 0.6/1.4.
  ASSERT_TRUE(found.factor);
  EXPECT_NEAR(found.factor->value, 2.1 * std::sqrt(0.6 / 1.4), 0.1);
  // Without a declaration the same.
  EXPECT_NEAR(identification::sensor_noise({}, recording, Channel::dz_b), found.noise.level, 1e-9);
}

// Law. What is declared is an rms, also where samples show nothing but the other channels' colour: behind a filter of
// 330 Hz the level below its corner is 1.25 times as high.
TEST(NoiseFactor, TakesADeclarationAsAnRms) {
  constexpr double period = 1e-3;
  const identification::NoiseColour colour{330.0, 2, identification::NoiseColour::Filter::digital};
  identification::ChannelNoise unknown;
  unknown.relative_error = 1.0;
  const auto noise = identification::with_declared(unknown, 0.04, period, colour).noise;
  EXPECT_NEAR(noise.rms(period), 0.04, 1e-12);
  EXPECT_NEAR(noise.level, 0.05, 0.001);
  EXPECT_EQ(identification::with_declared(unknown, 0.04, period).noise.level, 0.04);
}

}  // namespace
}  // namespace sensor_noise_test
