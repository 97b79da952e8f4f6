// Bounded Gauss–Newton on recordings of tests/truth, which shares no code with the model.
#include "host_sim/identification/estimate/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/estimate/free_parameter.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace firmware;
using namespace host_sim;
using model::Channel;

struct Rig {
  RigDescription description;
  identification::IdentificationProblem problem;
  identification::Hypothesis hypothesis;
};

/// Eight seconds of a rig, from rest, with one effect; nothing else to be found.
Rig rig_with(const std::string& kind, const truth::Effect& effect) {
  truth::Truth truth = truth::draw("none:" + kind, 3);
  truth.actual = truth.nominal;
  truth.effects = {effect};
  truth.records.resize(1);
  truth.records[0].duration = 8.0;
  truth.records[0].warm = 0.0;
  const RigDescription description = parse_rig(truth::rig_toml(truth), "rig.toml");
  Recording recording = parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv");
  std::vector<identification::PreparedRecording> recordings{
      identification::prepare_recording(description, std::move(recording), identification::Use::fitted, false)};
  const identification::Hypothesis hypothesis = identification::described_hypothesis(description, recordings);
  return {description, identification::IdentificationProblem(std::move(recordings)), hypothesis};
}

// Law. What enters a channel linearly is found in a step or two, however far from its start: −400 N from 1 N. 10 N of
// noise over 8000 samples leave 0.11 N.
TEST(Fit, ReachesAnOffsetFarFromItsStart) {
  const Rig bench = rig_with("component_bench", {"sensor_offset", "F", {{"offset", -400.0}}});
  const PlacedEffect start{find_effect("sensor_offset"), Channel::F, {1.0}};
  identification::Hypothesis hypothesis = bench.hypothesis;
  put_effect(hypothesis.rig, start);
  const identification::Fit fit =
      identification::fit(bench.problem, hypothesis, identification::effect_parameters(start), 4);
  EXPECT_NEAR(fit.parameters[0].value(fit.parameters[0].get(fit.hypothesis)), -400.0, 0.6);
}

// Law. In a rig with corners slopes are taken with half of the steps; they are those of all steps, since what a step
// gets wrong is nearly the same on both sides of a difference. Left is that a contact of some 40 ms begins and ends
// within a step of 0.5 ms, 1/80, and half of the parameter's own step, 0.5 %. (A difference that is not of two like
// simulations is off by the whole of it.)
TEST(Fit, TakesSlopesInARigWithCornersWithHalfOfTheSteps) {
  const Rig car = rig_with("quarter_car", {"bump_stop", "", {{"clearance", 5e-3}, {"stiffness", 8e4}}});
  const PlacedEffect stop{find_effect("bump_stop"), std::nullopt, {5e-3, 8e4}};
  identification::Hypothesis hypothesis = car.hypothesis;
  put_effect(hypothesis.rig, stop);
  std::vector<identification::FreeParameter> parameters = identification::tolerated_parameters(car.description);
  for (const identification::FreeParameter& unknown : identification::effect_parameters(stop))
    parameters.push_back(unknown);
  identification::Fit fit = identification::fit(car.problem, hypothesis, parameters, 0);
  identification::refresh_jacobian(car.problem, fit);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto residual_at = [&](double step) {
      identification::Hypothesis other = fit.hypothesis;
      parameters[i].put(other, parameters[i].get(other) + step);
      return identification::residuals(car.problem, identification::predict(car.problem, other));
    };
    const double step = parameters[i].difference;
    const Eigen::VectorXd fine = (residual_at(step) - residual_at(-step)) / (2.0 * step);
    const Eigen::VectorXd half = fit.jacobian.col(static_cast<Eigen::Index>(i));
    EXPECT_LT((half - fine).norm(), 0.018 * fine.norm()) << parameters[i].path;
  }
}

// Law. Starts of a motion stay near the motion: ten times as large at most, three in one step.
TEST(FreeParameter, KnowsHowFarItsSlopeMayBeBelieved) {
  identification::FreeParameter u{};
  u.role = identification::FreeParameter::Role::start;
  EXPECT_EQ(u.trust_radius(7.0), 3.0);
  u.role = identification::FreeParameter::Role::effect;
  EXPECT_EQ(u.trust_radius(0.2), 1.0);
  EXPECT_EQ(u.trust_radius(-8.0), 8.0);
  u.logarithmic = true;
  EXPECT_EQ(u.trust_radius(-8.0), 1.0);
  u = {};
  u.role = identification::FreeParameter::Role::effect;
  u.sensor = Channel::F;
  EXPECT_TRUE(std::isinf(u.trust_radius(1.0)));
}

// Law. A hypothesis from elsewhere may lie beyond the bounds of this fit, which are relative to its own start. Its step
// may stay where it is or come back, and never has less than no room: then a parameter without a slope would run away.
TEST(FreeParameter, HasRoomForAStepEvenBeyondItsBounds) {
  const PlacedEffect lag{find_effect("sensor_lag"), Channel::F, {1e-3}};
  const identification::FreeParameter u = identification::effect_parameters(lag)[0];
  for (const double at : {u.lower - 1.7, u.lower - 0.2, u.lower, 0.0, u.upper, u.upper + 3.0}) {
    for (const double trust : {1.0, 0.25}) {
      const auto [lower, upper] = u.step_bounds(at, trust);
      EXPECT_LE(lower, 0.0) << at;
      EXPECT_GE(upper, 0.0) << at;
      EXPECT_GE(lower, -trust) << at;
      EXPECT_LE(upper, trust) << at;
      if (at <= u.lower) {
        EXPECT_EQ(lower, 0.0) << at;
        EXPECT_EQ(upper, trust) << at;
      }
      if (at >= u.upper) {
        EXPECT_EQ(upper, 0.0) << at;
      }
    }
  }
}

// Law. What is read off a recording stays near it in every fit: a ripple of 5 mm between 4 and 6 mm.
TEST(FreeParameter, StaysNearWhatARecordingShows) {
  const PlacedEffect ripple{find_effect("position_ripple"), std::nullopt, {5e-3, 10.0, 3.0}};
  const identification::FreeParameter period = identification::effect_parameters(ripple)[0];
  EXPECT_NEAR(period.value(period.lower), 4e-3, 1e-12);
  EXPECT_NEAR(period.value(period.upper), 6e-3, 1e-12);
  const PlacedEffect stop{find_effect("bump_stop"), std::nullopt, {5e-3, 1e5}};
  const identification::FreeParameter clearance = identification::effect_parameters(stop)[0];
  EXPECT_LT(clearance.value(clearance.lower), 1e-3);
}

// Edge. A factor on a reading is sought from a third to three, inside of what its card allows; other numbers wherever
// their cards do.
TEST(FitRange, KeepsAFactorWithinThree) {
  using namespace host_sim::identification;
  const FitRange gain = fit_range(find_effect("sensor_gain")->parameters[0]);
  EXPECT_DOUBLE_EQ(gain.lower, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(gain.upper, 3.0);
  const model::EffectParameter& offset = find_effect("sensor_offset")->parameters[0];
  EXPECT_EQ(fit_range(offset).lower, offset.lower);
  EXPECT_EQ(fit_range(offset).upper, offset.upper);
  // Only what an effect is proportional to is scanned at its best size: no shape, no exponent, no position.
  EXPECT_TRUE(is_proportional(find_effect("sensor_gain")->parameters[0]));
  EXPECT_TRUE(is_proportional(find_effect("position_ripple")->parameters[1]));
  EXPECT_FALSE(is_proportional(find_effect("bouc_wen")->parameters[2]));
  EXPECT_FALSE(is_proportional(find_effect("gas_exponent")->parameters[0]));
  EXPECT_FALSE(is_proportional(find_effect("stuck_area")->parameters[0]));
  const FreeParameter u = effect_parameters({find_effect("sensor_gain"), model::Channel::F, {1.1}}).front();
  EXPECT_NEAR(u.value(u.lower), 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(u.value(u.upper), 3.0, 1e-12);
}

}  // namespace
