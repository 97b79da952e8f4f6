// Intervals of parameters, and open combinations.
#include "host_sim/identification/estimate/uncertainty.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host_sim/identification/diagnosis.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"
#include "tests/host_sim/identification/truth_recording.hpp"

namespace {

using namespace host_sim::identification;
using model::Channel;

// Point. Tables of Student's distribution.
TEST(Student, IsThatOfTheTables) {
  EXPECT_NEAR(student(10.0), 2.228, 0.01);
  EXPECT_NEAR(student(30.0), 2.042, 0.002);
  EXPECT_NEAR(student(1e9), 1.960, 1e-3);
}

// Point. Equal entries are one ratio, and all stiffnesses and dampings have a name together; two vectors that come
// mixed are told apart; a single entry stands alone.
TEST(Undetermined, IsSaidInWords) {
  const std::vector<std::string> names{"body.mass", "suspension.damping", "suspension.stiffness", "tyre.stiffness",
                                       "wheel.mass"};
  const auto scale = in_words(Eigen::VectorXd::Constant(5, 0.447), names, false);
  ASSERT_EQ(scale.size(), 1U);
  EXPECT_EQ(scale[0].combination, "body.mass, wheel.mass and all stiffnesses and dampings in one ratio");
  EXPECT_EQ(scale[0].why, "no force is measured");
  EXPECT_EQ(in_words(Eigen::VectorXd::Constant(5, 0.447), names, true)[0].why,
            "the measured channels do not tell them apart");
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(5, 2);
  mixed.col(0) << 1.0, 1.0, 0.0, 0.0, 0.0;
  mixed.col(1) << 1.0, 1.0, 0.0, 0.5, -0.5;
  const auto two = in_words(mixed, names, true);
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].combination, "body.mass and suspension.damping in one ratio");
  EXPECT_EQ(two[1].combination, "tyre.stiffness and wheel.mass, one against the other");
  const auto one = in_words(Eigen::VectorXd::Unit(5, 3), names, true);
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].combination, "tyre.stiffness");
  EXPECT_TRUE(in_words(Eigen::MatrixXd(5, 0), names, true).empty());
}

/// The bench with its stiffness free, fitted to a recording.
struct Fitted {
  IdentificationProblem problem;
  Fit result;
  Uncertainty known;
};
Fitted fitted_to(firmware::Recording recording) {
  const firmware::RigDescription bench = sample::bench();
  std::vector<PreparedRecording> recordings{prepare_recording(bench, std::move(recording), Use::fitted, false)};
  const Hypothesis given = described_hypothesis(bench, recordings);
  IdentificationProblem problem(std::move(recordings), given);
  Fit found = fit(problem, given, tolerated_parameters(bench));
  refresh_jacobian(problem, found);
  Uncertainty known = uncertainty(problem, suspect_parameters(bench), found);
  return {std::move(problem), std::move(found), std::move(known)};
}

// Law. Of 60 intervals of 95 % 57 hold the true stiffness, give or take three times √(60 · 0.05 · 0.95) = 1.7.
TEST(Uncertainty, HoldsTheTruthInNineteenOfTwenty) {
  firmware::RigDescription truth = sample::bench();
  truth.rig.suspension.stiffness *= 1.02;
  int holds = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Fitted f = fitted_to(sample::recorded(truth, 8.0, seed));
    const double off = (0.02 / 0.05 - f.result.parameters[0].get(f.result.hypothesis)) / f.known.half_widths(0);
    holds += std::abs(off) < 1.0 ? 1 : 0;
    EXPECT_TRUE(f.known.undetermined.empty());
  }
  EXPECT_GE(holds, 52);
}

// Point. Noise that is nine times as strong in one of eight seconds makes χ²/n 10: of what a likelihood would make of
// it, √10, bursts where the motion is strong leave more.
TEST(Uncertainty, GrowsWithBursts) {
  firmware::Recording calm = sample::recorded(sample::bench(), 12.0), bursts = calm;
  const auto& x = calm[Channel::x_cmd];
  for (std::size_t k = 6000; k < 7500; ++k) bursts[Channel::F][k] += 300.0 * x[k] / 8e-3;
  const Fitted of_calm = fitted_to(calm), of_bursts = fitted_to(bursts);
  const double temper = of_bursts.result.chi_squared / static_cast<double>(of_bursts.result.residual.size());
  EXPECT_GT(of_bursts.known.half_widths(0), 1.5 * std::sqrt(temper) * of_calm.known.half_widths(0));
}

// Point. A parameter at the bound of its tolerance is known to its tolerance only.
TEST(Uncertainty, IsTheWholeToleranceAtABound) {
  firmware::RigDescription truth = sample::bench();
  truth.rig.suspension.stiffness *= 1.10;
  const Fitted f = fitted_to(sample::recorded(truth));
  ASSERT_TRUE(f.result.parameters[0].at_bound(f.result.hypothesis));
  EXPECT_TRUE(std::isinf(f.known.half_widths(0)));
}

// Journey. A car without a force sensor: its masses, stiffnesses and dampings in one ratio move nothing that is
// measured. The verdict says so, and the mass of the body is known as well as its tolerance of 1 % and no better. With
// the wheel load nothing is open.
TEST(Uncertainty, SaysWhatThreeChannelsLeaveOpen) {
  const sample::Given rig = sample::given("none:quarter_car", 3);
  const Diagnosis whole = diagnose(rig.description, {{rig.recording, Use::shared}});
  EXPECT_TRUE(whole.undetermined.empty()) << whole.undetermined.front().combination;
  const Interval known = whole.parameters.at("body.mass");
  EXPECT_LT((known.upper - known.lower) / known.value, 0.004);

  firmware::Recording few = rig.recording;
  for (const Channel channel : {Channel::zdd_r, Channel::F_w, Channel::dz_w, Channel::dz_b}) few[channel].clear();
  // Nothing that holds the unit of mass is exact.
  firmware::RigDescription loose = rig.description;
  for (const char* path : {"body.mass", "wheel.mass", "tyre.stiffness", "tyre.damping", "suspension.stiffness",
                           "suspension.damping", "fdva.coupling_stiffness", "fdva.oil_density"}) {
    const double* const value = firmware::find_parameter(loose.rig, path);
    if (value != nullptr && *value != 0.0) loose.tolerance.try_emplace(path, 0.03);
  }
  const Diagnosis found = diagnose(loose, {{few, Use::shared}});
  ASSERT_EQ(found.undetermined.size(), 1U);
  EXPECT_THAT(found.undetermined[0].combination, testing::StartsWith("body.mass, wheel.mass"));
  EXPECT_THAT(found.undetermined[0].combination, testing::EndsWith("in one ratio"));
  EXPECT_EQ(found.undetermined[0].why, "no force is measured");
  const Interval open = found.parameters.at("body.mass");
  EXPECT_GT((open.upper - open.lower) / open.value, 0.01);
}

}  // namespace
