// Predictions of a hypothesis, what a fit leaves, and what it knows.
#include "host_sim/identification/estimate/prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/identification/estimate/fit.hpp"
#include "host_sim/identification/estimate/free_parameter.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/predict/hypothesis.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

struct Bench {
  explicit Bench(const firmware::RigDescription& truth, double seconds = 8.0)
      : Bench(sample::prepared(sample::bench(), truth, Use::shared, seconds)) {}

  Hypothesis given;
  IdentificationProblem problem;

 private:
  explicit Bench(std::vector<PreparedRecording> recordings)
      : given(described_hypothesis(sample::bench(), recordings)), problem(std::move(recordings), given) {}
};

// Point. One start for each recording: a bench without a piston has no state but to rest above its first sample. What
// is fitted keeps its start.
TEST(Hypothesis, HasAStartForEachRecording) {
  const Bench bench(sample::bench());
  ASSERT_EQ(bench.given.starts.size(), 1U);
  EXPECT_EQ(bench.given.starts[0], host_sim::resting(bench.given.rig, bench.problem.samples()[0].input));
  Hypothesis other = bench.given;
  estimate_held_out_starts(other, bench.problem.samples());
  EXPECT_EQ(other.starts[0], bench.given.starts[0]) << "its beginning is fitted";
}

// Law. Of the right hypothesis χ² = n within five standard deviations.
TEST(Prediction, LeavesNoiseOfTheRightHypothesis) {
  const Bench bench(sample::bench());
  const Eigen::VectorXd r = residuals(bench.problem, predict(bench.problem, bench.given));
  const double n = static_cast<double>(r.size());
  EXPECT_NEAR(r.squaredNorm() / n, 1.0, 5.0 * std::sqrt(2.0 / n));
  const auto all = read_all(bench.problem, bench.given);
  EXPECT_EQ(all[0][index(Channel::F)].size(), 8000U) << "readings are of the whole recording";
}

// Law. What differs in a sensor alone is predicted without a simulation, to the bit.
TEST(Prediction, OfASensorNeedsNoSimulation) {
  const Bench bench(sample::bench());
  const Prediction base = predict(bench.problem, bench.given);
  Hypothesis gain = bench.given;
  firmware::put_effect(gain.rig, {firmware::find_effect("sensor_gain"), Channel::F, {1.05}});
  const Prediction sensor = predict_sensor(bench.problem, gain, base, Channel::F);
  EXPECT_EQ(sensor.truth[0], base.truth[0]) << "shared";
  EXPECT_EQ(residuals(bench.problem, sensor), residuals(bench.problem, predict(bench.problem, gain)));
}

// Law. Several hypotheses that are predicted together leave what each leaves alone, to the bit. A variation of one
// recording takes the others from the base.
TEST(Prediction, OfSeveralHypothesesIsThatOfEach) {
  const Bench bench(sample::bench());
  std::vector<Variation> variations;
  for (const double stiffness : {29000.0, 29500.0, 30000.0, 30500.0, 31000.0}) {
    variations.push_back({bench.given, std::nullopt});
    variations.back().hypothesis.rig.suspension.stiffness = stiffness;
  }
  firmware::put_effect(variations[1].hypothesis.rig, {firmware::find_effect("sensor_gain"), Channel::F, {1.05}});
  firmware::put_effect(variations[2].hypothesis.rig, {firmware::find_effect("coulomb_friction"), std::nullopt, {20.0}});
  variations[3].recording = 0;
  const auto together = residuals_of_each(bench.problem, variations, false, nullptr);
  ASSERT_EQ(together.size(), variations.size());
  for (std::size_t i = 0; i < variations.size(); ++i) {
    EXPECT_EQ(together[i], residuals(bench.problem, predict(bench.problem, variations[i].hypothesis))) << i;
  }
  variations[3].recording = 7;  // of which there is none: all recordings are those of the base
  const Prediction base = predict(bench.problem, bench.given);
  EXPECT_EQ(residuals_of_each(bench.problem, variations, false, &base)[3], residuals(bench.problem, base));
}

// Statistics. A stiffness of 30 900 N/m within 5 % of 30 000 is found within four of its standard errors, and the error
// says so: σ_F/√Σx² of the fitted samples.
TEST(Fit, KnowsHowWellItKnowsAStiffness) {
  firmware::RigDescription truth = sample::bench();
  truth.rig.suspension.stiffness = 30900.0;
  const Bench bench(truth);
  const SearchSpace space = search_space(sample::bench(), bench.problem.samples(), bench.given);
  ASSERT_EQ(space.tolerated.size(), 1U);
  ASSERT_EQ(space.common.size(), 1U) << "no state to start in";
  Fit found = fit(bench.problem, space.given, space.common);
  refresh_jacobian(bench.problem, found);
  double squares = 0.0;
  const PreparedRecording& samples = bench.problem.samples()[0];
  for (std::size_t k = 0; k < samples.fitted.to; ++k) squares += std::pow(samples.input.motion[k].position, 2);
  const double expected = sample::force_noise / std::sqrt(squares);
  const FreeParameter& stiffness = found.parameters[0];
  const double error = stiffness.scale * std::sqrt(found.covariance()(0, 0));
  EXPECT_NEAR(error / expected, 1.0, 0.1);  // the taper takes some of the ends
  EXPECT_NEAR(stiffness.value(stiffness.get(found.hypothesis)), 30900.0, 4.0 * expected) << "seed 5";
}

// Fault. A start whose readings overflow is no model: its χ² is infinite, and nothing is thrown.
TEST(Fit, OfADivergedSimulationIsInfinite) {
  const Bench bench(sample::bench());
  Hypothesis wild = bench.given;
  firmware::put_effect(wild.rig, {firmware::find_effect("sensor_gain"), Channel::F, {1e308}});
  EXPECT_TRUE(std::isinf(fit(bench.problem, wild, {}, 3).chi_squared));
}

// Law. Nothing is left of the right hypothesis; 60 N of friction are left in F, on fitted and held-out data; the pooled
// error of the right one is that of its noise.
TEST(UnexplainedResidual, IsWhatIsNoNoise) {
  const Bench right(sample::bench());
  EXPECT_FALSE(unexplained_residual(right.problem, right.given).significant);
  EXPECT_EQ(unexplained_residual(right.problem, right.given).words, "");
  const Bench friction(sample::with_effect(sample::bench(), "coulomb_friction", {60.0}));
  const UnexplainedResidual left = unexplained_residual(friction.problem, friction.given);
  EXPECT_TRUE(left.significant);
  EXPECT_TRUE(left.words.starts_with("F, ")) << left.words;
  EXPECT_GT(pooled_error(friction.problem, friction.given), 3.0 * pooled_error(right.problem, right.given));
  // What is there in the fitted part alone, and not in the held-out quarter, is no effect.
  auto recordings = sample::prepared(sample::bench(), sample::with_effect(sample::bench(), "coulomb_friction", {60.0}));
  const firmware::Recording quiet = sample::recorded(sample::bench());
  for (std::size_t k = 6000; k < 8000; ++k) recordings[0].recording[Channel::F][k] = quiet[Channel::F][k];
  EXPECT_FALSE(unexplained_residual(IdentificationProblem(std::move(recordings)), right.given).significant);
  const auto excess = channel_excesses(band_powers(friction.problem, friction.given));
  ASSERT_EQ(excess.size(), 2U);
  EXPECT_LT(excess[0].significance, 8.0) << "x_act";
  EXPECT_GT(excess[1].significance, 8.0) << "F";
  for (const BandPower& p : band_powers(right.problem, right.given)) {
    EXPECT_LT(p.lower, p.power.ratio());
    EXPECT_GT(p.upper, p.power.ratio());
  }
}

}  // namespace
