// What of the recordings is fitted, how its residuals are weighted, and what the input's noise makes of them.
#include "host_sim/identification/noise/identification_problem.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/identification/noise/input_noise_covariance.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

/// A bench that is driven by a measured x_act with noise: F = k x alone.
firmware::RigDescription spring() {
  return firmware::parse_rig(
      "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 30000.0\ndamping = 0.0\n"
      "[noise]\nF = 10.0\nx_act = 2e-5\n",
      "spring.toml");
}
std::vector<PreparedRecording> spring_recordings() {
  firmware::Recording recording = sample::recorded(spring());
  recording[Channel::x_cmd].clear();
  std::vector<PreparedRecording> list;
  list.push_back(prepare_recording(spring(), std::move(recording), Use::shared, false));
  return list;
}

// Point. Through a spring of k noise σ_x of the deflection becomes noise k σ_x of the force at every frequency: N = k²
// σ_x², and the variance is the part of it below the edge above which the deflection is smoothed, with a thousandth.
TEST(InputNoiseCovariance, IsTheSquareOfAStiffnessTimesTheNoise) {
  const auto recordings = spring_recordings();
  const Hypothesis given = described_hypothesis(spring(), recordings);
  const InputNoiseCovariance noise =
      input_noise_covariance(recordings[0], given, given.starts[0], recordings[0].fitted);
  const double expected = std::pow(30000.0 * sample::deflection_noise, 2);
  ASSERT_EQ(noise.spectrum.size(), 91U);
  for (const auto& matrix : noise.spectrum) EXPECT_NEAR(matrix(0, 0).real() / expected, 1.0, 1e-6);
  const double share = 2.0 * recordings[0].input_edge * recordings[0].input.period;
  ASSERT_GT(share, 0.0);
  // 18 000 samples, of which the share is independent: √(2/(18 000 · 0.05)) = 0.05, of three realisations.
  EXPECT_NEAR(noise.variance[index(Channel::F)] / (expected * share), 1.0, 0.1);
}

// Law. With the noise of its input known, a recording of the described rig leaves χ² = n; without it, (k σ_x)² more.
TEST(IdentificationProblem, WeightsResidualsWithTheNoiseOfTheInput) {
  auto recordings = spring_recordings();
  const Hypothesis given = described_hypothesis(spring(), recordings);
  IdentificationProblem problem(std::move(recordings));
  const auto per_residual = [&] {
    const ProblemRecording& r = problem.recordings()[0];
    const host_sim::Response simulated =
        read_channels(given, *r.samples, r.samples->input, given.starts[0], 0, r.resolution());
    std::vector<double> whitened(r.fit_whitening->count());
    r.fit_whitening->whiten(r.fit_whitening->spectra(*r.samples, simulated), whitened.data());
    double squares = 0.0;
    for (const double v : whitened) squares += v * v;
    return squares / static_cast<double>(whitened.size());
  };
  const double n = static_cast<double>(problem.residual_count());
  const double extra = std::pow(30000.0 * sample::deflection_noise / sample::force_noise, 2);
  EXPECT_NEAR(per_residual(), 1.0 + extra, 5.0 * (1.0 + extra) * std::sqrt(2.0 / n));
  EXPECT_TRUE(problem.update_input_noise(given));
  EXPECT_NEAR(per_residual(), 1.0, 5.0 * std::sqrt(2.0 / n));
  // An allowed model error of 10 % of the rms adds its square to the variance of every residual.
  double squares = 0.0;
  const PreparedRecording& samples = problem.samples()[0];
  for (std::size_t k = 0; k < samples.fitted.to; ++k) squares += std::pow(samples.recording[Channel::F][k], 2);
  const double allowed = 0.01 * squares / static_cast<double>(samples.fitted.to);
  const double known = std::pow(sample::force_noise, 2) * (1.0 + extra);
  problem.allow_model_error(0.1);
  EXPECT_NEAR(per_residual(), known / (known + allowed), 0.02);
  problem.allow_model_error(0.0);
  EXPECT_NEAR(per_residual(), 1.0, 5.0 * std::sqrt(2.0 / n));
}

// Law. A part of a problem is a view: the same samples, the beginning of each fitted window, nothing held out, and the
// noise of the whole.
TEST(IdentificationProblem, IsTruncatedWithoutCopyingSamples) {
  auto recordings = spring_recordings();
  const Hypothesis given = described_hypothesis(spring(), recordings);
  const IdentificationProblem problem(std::move(recordings), given);
  EXPECT_TRUE(problem.has_held_out());
  EXPECT_EQ(problem.fitted_count(), 1U);
  const IdentificationProblem part = problem.truncated(0.5);
  EXPECT_EQ(&part.samples(), &problem.samples());
  EXPECT_EQ(part.recordings()[0].fitted.size(), 3000U);
  EXPECT_FALSE(part.has_held_out());
  EXPECT_EQ(part.recordings()[0].input_noise.spectrum[5](0, 0), problem.recordings()[0].input_noise.spectrum[5](0, 0));
  EXPECT_NEAR(static_cast<double>(part.residual_count()) / static_cast<double>(problem.residual_count()), 0.5, 0.02);
  EXPECT_EQ(problem.truncated(1e-6).recordings()[0].fitted.size(), 2000U) << "two seconds at least";
  EXPECT_EQ(problem.truncated_and_coarse(0.5).recordings()[0].substeps, 2);
  EXPECT_EQ(problem.recordings()[0].substeps, 4);
}

/// The first recording of a rig of tests/truth, described with its true parameters and effects.
std::vector<PreparedRecording> described_as_it_is(const truth::Truth& truth, firmware::RigDescription& description) {
  description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
  for (const auto& [path, value] : truth.actual) *firmware::find_parameter(description.rig, path) = value;
  for (const truth::Effect& effect : truth.effects) {
    const auto channel = effect.channel.empty() ? std::nullopt : model::find_channel(effect.channel);
    firmware::put_effect(description.rig,
                         {firmware::find_effect(effect.name), channel, {effect.parameters.begin()->second}});
  }
  std::vector<PreparedRecording> recordings;
  recordings.push_back(prepare_recording(
      description, firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv"), Use::fitted,
      false));
  return recordings;
}

/// χ² per residual.
double per_residual(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  return residuals(problem, predict(problem, hypothesis)).squaredNorm() / static_cast<double>(problem.residual_count());
}

// Law. Of the true rig with free play nothing but noise is left where samples at its knocks are left out; a few of them
// are on the wrong side of a jump. Of a hypothesis without free play they are used again.
TEST(IdentificationProblem, LeavesOutSamplesAtKnocks) {
  firmware::RigDescription description;
  truth::Truth truth = truth::draw("none:quarter_car", 3);
  truth.actual = truth.nominal;
  truth.effects = {{"backlash", "", {{"gap", 4e-3}}}};
  truth.records.resize(1);
  truth.records[0].duration = 10.0;
  truth.records[0].warm = 0.0;
  auto recordings = described_as_it_is(truth, description);
  const Hypothesis given = described_hypothesis(description, recordings);
  IdentificationProblem with(std::move(recordings));
  IdentificationProblem without = with;
  EXPECT_TRUE(without.update_input_noise(given));
  constexpr auto zdd_w = index(Channel::zdd_w);
  const std::size_t left_out = without.samples()[0].knocks[zdd_w].size();
  EXPECT_GT(left_out, 100U);
  EXPECT_LT(left_out, 1000U) << "of 10 000";
  EXPECT_TRUE(without.samples()[0].knocks[index(Channel::dz_b)].empty()) << "a deflection does not jump";
  with.take_input_noise(without);
  EXPECT_LT(per_residual(without, given), 1.1);
  // Σχ² of n numbers scatters by √(2/n) = 0.016.
  EXPECT_GT(per_residual(with, given), per_residual(without, given) + 10.0 * 0.016);

  Hypothesis plain = given;
  firmware::remove_effect(plain.rig, *firmware::find_effect("backlash"), std::nullopt);
  EXPECT_TRUE(without.update_input_noise(plain));
  EXPECT_TRUE(without.samples()[0].knocks[zdd_w].empty());
  const auto left_out_of = [](const IdentificationProblem& problem) {
    const std::vector<bool>& clipped = problem.samples()[0].clipped[zdd_w];
    return std::count(clipped.begin(), clipped.end(), true);
  };
  EXPECT_EQ(left_out_of(without), left_out_of(with)) << "outliers alone";
}

// Law. A force sensor that takes a value every 11.7 ms by a clock of its own takes some of them where free play ends,
// or a machine leaves the limit of its velocity: between two samples, a jump of 500 N, somewhere. Without those the
// true rig leaves hardly more than noise; with them more than four times as much.
TEST(IdentificationProblem, LeavesOutHeldValuesThatWereTakenAtKnocks) {
  firmware::RigDescription description;
  auto recordings = described_as_it_is(truth::draw_rough("many", 2026123001), description);
  Hypothesis given = described_hypothesis(description, recordings);
  given.clocks[index(Channel::F)] = {true, 0.0, 0.0};
  const IdentificationProblem with(std::move(recordings));
  IdentificationProblem without = with;
  EXPECT_TRUE(without.update_input_noise(given));
  EXPECT_LT(per_residual(without, given), 1.1);
  EXPECT_GT(per_residual(with, given), 4.0);
  const PreparedRecording& r = without.samples()[0];
  const std::vector<std::size_t>& knocks = r.knocks[index(Channel::F)];
  EXPECT_GT(knocks.size(), 100U);
  EXPECT_LT(knocks.size(), 3000U) << "of 10 000";
  const std::vector<double>& held = r.recording[Channel::F];
  for (std::size_t i = 0; i + 1 < knocks.size(); ++i) {
    if (knocks[i] + 1 == knocks[i + 1]) continue;
    EXPECT_NE(held[knocks[i]], held[knocks[i] + 1]) << "a value is left out as long as it is shown";
  }
}

// Point. Both channels of a bench pass a digital low-pass of second order at 60.35 Hz. Where the hypothesis has it,
// noise has its colour: taken for one of 70 Hz, which fits the samples as well, its level was 0.75 of what it is.
// Within four standard errors of a level that the spectrum says to 1.5 %.
TEST(IdentificationProblem, HasTheNoiseBehindAFilterOfTheHypothesis) {
  const truth::Truth truth = truth::draw_rough("noise_coloured", 2026123002);
  const firmware::RigDescription description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
  firmware::Recording recording =
      firmware::parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv");
  std::vector<PreparedRecording> recordings;
  recordings.push_back(prepare_recording(description, std::move(recording), Use::shared, false));
  Hypothesis hypothesis = described_hypothesis(description, recordings);
  IdentificationProblem problem(std::move(recordings), hypothesis);
  EXPECT_FALSE(problem.recordings()[0].noise[index(Channel::F)].on_signal);
  hypothesis.faults.push_back(filter_fault({Channel::x_act, Channel::F}, truth.rough.recorder.at("F").corner, 2));
  hypothesis.faults.back().digital = true;
  problem.update_input_noise(hypothesis);
  for (const auto& [channel, level] : {std::pair{Channel::x_act, 2e-5}, {Channel::F, 10.0}}) {
    const ChannelNoise& noise = problem.recordings()[0].noise[index(channel)];
    EXPECT_TRUE(noise.on_signal) << name(channel);
    EXPECT_NEAR(noise.level / level, 1.0, 0.06) << name(channel);
  }
}

// Law. White noise that nobody has declared is no louder than what the samples hold above the motion, where motion may be,
// too: what a model leaves there takes its place where that is quieter, and never where it is louder.
TEST(IdentificationProblem, TakesUndeclaredNoiseForABound) {
  const firmware::RigDescription bench = sample::bench();
  for (const double bound : {10.0 * sample::force_noise, 0.5 * sample::force_noise}) {
    auto recordings = sample::prepared(bench, bench);
    const Hypothesis given = described_hypothesis(bench, recordings);
    recordings[0].declared_noise[index(Channel::F)].reset();
    recordings[0].channel_noise[index(Channel::F)].level = bound;
    IdentificationProblem problem(std::move(recordings), given);
    problem.update_input_noise(given);
    // 8000 samples say the level within 2 %.
    const double expected = std::min(bound, sample::force_noise);
    EXPECT_NEAR(problem.recordings()[0].noise[index(Channel::F)].level / expected, 1.0, 0.06) << bound;
    EXPECT_FALSE(problem.update_input_noise(given));  // and then stands
  }
}

// A command is exact: nothing to weight anew.
TEST(IdentificationProblem, HasNoNoiseOfACommand) {
  const firmware::RigDescription bench = sample::bench();
  auto recordings = sample::prepared(bench, bench);
  const Hypothesis given = described_hypothesis(bench, recordings);
  IdentificationProblem problem(std::move(recordings), given);
  EXPECT_TRUE(problem.recordings()[0].input_noise.spectrum.empty());
  EXPECT_FALSE(problem.update_input_noise(given));
}

}  // namespace
