// Single samples that are far off, and samples that are rounded.
#include "host_sim/identification/prepare/sample_faults.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host_sim/identification/prepare/sampled_recording.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "tests/host_sim/identification/test_signals.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"
#include "tests/support/reference_road.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;
using sample::sine;

/// 20 Hz at 1 kHz, with noise of rms 1.
std::vector<double> noisy(std::size_t count, std::uint64_t seed, double amplitude = 100.0) {
  std::vector<double> samples = sine(amplitude, 20.0, count);
  support::NormalNoise noise(seed);
  for (double& v : samples) v += noise();
  return samples;
}

using Places = std::vector<std::size_t>;

// Point. Of noise alone none; 15 standard deviations stand (15 − 4)/1.26 beyond it at least, in the middle and four
// samples apart; 30 near the ends, where fewer neighbours know less. Of the last two samples at each end nobody knows.
TEST(Outliers, AreSingleSamplesFarOff) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    std::vector<double> samples = noisy(20'000, seed);
    EXPECT_EQ(find_outliers(samples), Places{}) << "seed " << seed;
    const Places places{2, 700, 704, 9'000, 19'997};
    for (const std::size_t k : places) samples[k] += k == 2 || k == 19'997 ? 30.0 : 15.0 - 30.0 * (k % 3 == 0);
    EXPECT_EQ(find_outliers(samples), places) << "seed " << seed;
  }
}

// Law. A channel that is cut off most of the time has no noise at its limit; single samples below it are no outliers.
TEST(Outliers, AreNotBesideALimit) {
  const sample::Given given = sample::given("pair:quarter_car", 6);
  EXPECT_EQ(find_outliers(given.recording[Channel::zdd_b]), Places{});
}

// Point. The limit is the largest value that comes again, also where an interpolation overshoots it now and then; a
// channel whose largest values differ has none.
TEST(Limit, IsTheLargestValueThatComesAgain) {
  std::vector<double> samples = noisy(2'000, 3);
  EXPECT_FALSE(cut_off_at(samples));
  for (double& v : samples) v = std::clamp(v, -80.0, 80.0);
  ASSERT_TRUE(cut_off_at(samples));
  EXPECT_EQ(*cut_off_at(samples), 80.0);
  samples[10] = 81.0;
  samples[700] = -82.5;
  EXPECT_EQ(cut_off_at(samples), 80.0);
  EXPECT_FALSE(cut_off_at({}));
  EXPECT_FALSE(cut_off_at({0.0, 0.0, 0.0, 0.0}));
}

// Law. What has samples beside it is motion: a jump, a bend, pulses of 3 samples and more, and the ringing of a knock.
TEST(Outliers, AreNoMotion) {
  std::vector<double> samples = noisy(20'000, 6);
  const auto add = [&](std::size_t from, std::size_t count, const auto& shape) {
    for (std::size_t k = 0; k < count; ++k) samples[from + k] += shape(static_cast<double>(k));
  };
  add(2'000, 18'000, [](double) { return 40.0; });
  add(4'000, 2'000, [](double k) { return 30.0 * std::abs(k - 1'000.0); });
  add(8'000, 3, [](double) { return 40.0; });
  add(9'000, 10, [](double) { return 25.0; });
  add(12'000, 400, [](double k) { return 60.0 * std::exp(-k / 60.0) * std::sin(0.9 * (k + 1.0)); });
  EXPECT_EQ(find_outliers(samples), Places{});
}

// Point. Where the noise is ten times as loud, an outlier must be as well.
TEST(Outliers, AreMeasuredByTheNoiseAroundThem) {
  std::vector<double> samples = noisy(6'000, 7);
  const std::vector<double> loud = noisy(6'000, 8, 10.0);
  for (std::size_t k = 3'000; k < 6'000; ++k) samples[k] = 10.0 * loud[k];
  samples[1'000] += 30.0;
  samples[5'000] += 30.0;
  EXPECT_EQ(find_outliers(samples), Places{1'000});
}

// Law. An outlier that is mended is as good as a sample of noise; samples that are not usable take no part.
TEST(Outliers, AreMendedFromTheirNeighbours) {
  std::vector<double> samples = noisy(3'000, 9);
  std::vector<bool> unusable(samples.size(), false);
  const std::vector<double> clean = sine(100.0, 20.0, samples.size());
  for (const std::size_t k : {1'502UL, 1'503UL}) {
    samples[k] = 1e9;
    unusable[k] = true;
  }
  samples[1'500] += 50.0;
  const Places found = find_outliers(samples, unusable);
  EXPECT_EQ(found, Places{1'500});
  mend_outliers(samples, found, unusable);
  // Beside two that are missing the polynomial has a variance of 0.75: 4 standard deviations.
  EXPECT_NEAR(samples[1'500], clean[1'500], 4.0 * std::sqrt(0.75));
}

// Fault. One sample in 50 is no outlier: it is how the channel is.
TEST(Outliers, AreFew) {
  std::vector<double> samples = noisy(10'000, 10);
  for (std::size_t k = 25; k < samples.size(); k += 50) samples[k] += 40.0;
  EXPECT_EQ(find_outliers(samples), Places{});
}

// Point. A grid is found to what text holds, with an offset, with levels that never occur, and with a limit that lies
// beside it; a signal that is not rounded has none. Its noise is step/√12.
TEST(Rounding, HasAStep) {
  const double step = 0.0374;
  std::vector<double> samples = noisy(20'000, 11, 3.0);
  EXPECT_EQ(quantisation_step(samples), 0.0);
  std::vector<double> rounded;
  for (const double v : samples) {
    const double on_grid = 1.2345 + step * std::round(v / step);
    rounded.push_back(std::min(on_grid, 2.0001));
  }
  EXPECT_NEAR(quantisation_step(rounded), step, 1e-6 * step);
  for (double& v : rounded) v = std::round(v * 1e4) / 1e4;  // as text: the step is 374 of the last digit
  EXPECT_NEAR(quantisation_step(rounded), step, 2e-3 * step);
  EXPECT_NEAR(rounding_noise(step), 0.0374 / 3.4641016, 1e-9);
  EXPECT_EQ(quantisation_step({}), 0.0);
  EXPECT_EQ(quantisation_step(std::vector<double>(100, 4.0)), 0.0);
  EXPECT_EQ(quantisation_step({1.0, 2.0, 1.0, 2.0}), 0.0) << "two values tell no step";
}

firmware::Recording bench(double step, std::uint64_t seed) {
  firmware::Recording r;
  r.sample_period = 1e-3;
  r.time = firmware::sample_times(20'000, 1000.0);
  r[Channel::x_cmd] = sine(1.0, 1.0, 20'000);
  r[Channel::F] = noisy(20'000, seed, 500.0);
  if (step > 0.0) {
    for (double& v : r[Channel::F]) v = step * std::round(v / step);
  }
  return r;
}

firmware::RigDescription bench_description(std::optional<double> noise) {
  firmware::RigDescription d = firmware::parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 3e4\ndamping = 1e3\n", "bench.toml");
  d.noise[index(Channel::F)] = noise;
  return d;
}

// Law. The noise of rounding belongs to that of the channel: √(1 + 5²/12) = 1.756; it is said where the declaration
// does not hold it, and the factor of the noise is then 1. A declaration that holds it is right.
TEST(Rounding, IsNoise) {
  const auto f = index(Channel::F);
  const SampledRecording undeclared = sampled(bench_description({}), bench(5.0, 12));
  EXPECT_NEAR(undeclared.noise[f], 1.756, 0.05);
  EXPECT_NEAR(undeclared.rounding[f], 5.0, 1e-6);
  const SampledRecording declared = sampled(bench_description(1.0), bench(5.0, 12));
  EXPECT_NEAR(declared.noise[f], 1.756, 0.05);
  EXPECT_NEAR(declared.rounding[f], 5.0, 1e-6);
  ASSERT_TRUE(declared.noise_factor[f]);
  EXPECT_NEAR(declared.noise_factor[f]->value, 1.0, 0.05);
  const SampledRecording with_it = sampled(bench_description(1.756), bench(5.0, 12));
  EXPECT_NEAR(with_it.noise[f], 1.756, 1e-9);
  EXPECT_EQ(with_it.rounding[f], 0.0);
  const SampledRecording fine = sampled(bench_description(1.0), bench(0.2, 12));
  EXPECT_EQ(fine.rounding[f], 0.0);
  EXPECT_EQ(fine.noise[f], 1.0);
}

// Point. A slow signal that stays on a step for many samples shows no noise there, and is not held.
TEST(Rounding, IsNoHold) {
  firmware::Recording r = bench(0.0, 13);
  r[Channel::F] = sine(500.0, 0.7, 20'000);
  support::NormalNoise noise(13);
  for (double& v : r[Channel::F]) v = 20.0 * std::round((v + noise()) / 20.0);
  const SampledRecording found = sampled(bench_description({}), r);
  const auto f = index(Channel::F);
  EXPECT_FALSE(found.renewals[f]);
  EXPECT_NEAR(found.rounding[f], 20.0, 1e-6);
  EXPECT_GE(found.noise[f], 0.99 * rounding_noise(20.0));
}

// Law. Outliers are left out like samples that are clipped, counted at the rate of the file, and drive nothing; of a
// recording at 10 kHz one sample in ten is kept.
TEST(SampledRecording, LeavesOutliersOut) {
  firmware::Recording r = bench(0.0, 14);
  r[Channel::F][5'000] += 300.0;
  r[Channel::x_cmd][5'020] += 1.0;
  const auto f = index(Channel::F), x = index(Channel::x_cmd);
  SampledRecording found = sampled(bench_description(1.0), r);
  EXPECT_EQ(found.outliers[f].count, 1U);
  EXPECT_EQ(found.outliers[f].at, Places{5'000});
  ASSERT_FALSE(found.clipped[f].empty());
  EXPECT_TRUE(found.clipped[f][5'000]);
  EXPECT_EQ(found.outliers[x].count, 1U);
  EXPECT_NEAR(found.recording[Channel::x_cmd][5'020], std::sin(2.0 * std::numbers::pi * 5.020), 1e-6);
  r.sample_period = 1e-4;
  r.time = firmware::sample_times(20'000, 10'000.0);
  r[Channel::F][5'003] += 300.0;
  found = sampled(bench_description(1.0), r);
  EXPECT_EQ(found.outliers[f].count, 2U);
  EXPECT_EQ(found.outliers[f].at, Places{500});
}

// Point. (8): of n places at the median √n/2; of places that are spread evenly 1/(2√n); neighbours count once.
TEST(Outliers, AreAtRandomPlaces) {
  std::vector<double> values(10'001);
  for (std::size_t k = 0; k < values.size(); ++k) values[k] = static_cast<double>(k % 101);
  Places middle, spread, beside;
  for (std::size_t i = 0; i < 64; ++i) {
    middle.push_back(50 + 101 * i);
    beside.insert(beside.end(), {50 + 101 * i, 51 + 101 * i});
    spread.push_back(101 * i + (2 * i + 1) * 101 / 128);
  }
  EXPECT_NEAR(place_deviation(values, middle), 4.0, 0.1);
  EXPECT_EQ(place_deviation(values, beside), place_deviation(values, middle));
  EXPECT_NEAR(place_deviation(values, spread), 1.0 / 16.0, 0.1);
  EXPECT_EQ(place_deviation(values, {}), 0.0);
}

// Fault. Where free play is crossed a component lets go for a sample or two: a force that leaves its course wherever
// the rig passes one place does what the rig does. The same steps at random places are a recorder's.
TEST(SampledRecording, KnowsFreePlayByItsPlace) {
  constexpr std::size_t n = 20'000, strikes = 40;
  firmware::Recording r = bench(0.0, 16);
  r.time = firmware::sample_times(n, 1'000.0);
  support::NormalNoise noise(16);
  for (const Channel channel : {Channel::x_cmd, Channel::x_act, Channel::F}) {
    r[channel] = sine(10.0, 1.0, n);
    for (double& v : r[channel]) v += 0.01 * noise();
  }
  const std::vector<double> smooth = r[Channel::F];
  for (std::size_t i = 0; i < strikes; ++i) r[Channel::F][500 + i * 480] += 1.0;  // all phases of 1 s
  EXPECT_EQ(sampled(bench_description({}), r).outliers[index(Channel::F)].count, strikes);
  r[Channel::F] = smooth;
  for (std::size_t i = 0; i < 36; ++i) r[Channel::F][500 + i * 500] += i % 2 == 0 ? 1.0 : -1.0;  // at zero
  EXPECT_EQ(sampled(bench_description({}), r).outliers[index(Channel::F)].count, 0U);
}

// Fault. A knock at 200 Hz may be as short as a sample: what shows in another channel, too, is motion.
TEST(SampledRecording, KnowsAKnockByTheOtherChannels) {
  firmware::Recording r = bench(0.0, 15);
  r.sample_period = 5e-3;
  r.time = firmware::sample_times(4'000, 200.0);
  support::NormalNoise noise(15);
  for (const Channel channel : {Channel::x_cmd, Channel::x_act, Channel::F}) {
    r[channel] = sine(10.0, 1.0, 4'000, 5e-3);
    for (double& v : r[channel]) v += 0.01 * noise();
  }
  r[Channel::F][1'000] += 1.0;
  EXPECT_EQ(sampled(bench_description({}), r).outliers[index(Channel::F)].count, 1U);
  r[Channel::x_act][1'000] += 0.08;
  EXPECT_EQ(sampled(bench_description({}), r).outliers[index(Channel::F)].count, 0U);
}

}  // namespace
