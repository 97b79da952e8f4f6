// Lower minima beside a fit, on recordings of tests/truth, which shares no code with the model.
#include "host_sim/identification/estimate/lower_minimum.hpp"

#include <gtest/gtest.h>

#include "firmware/recording/recording_csv.hpp"
#include "tests/truth/truth.hpp"

namespace {

using namespace firmware;
using namespace host_sim::identification;

struct FittedCar {
  IdentificationProblem problem;
  Fit fit;
};

/// Ten seconds of a car with one effect, fitted from where its parameters are 3 % off.
FittedCar fitted_car(const truth::Effect& effect, const std::vector<double>& start) {
  truth::Truth truth = truth::draw("none:quarter_car", 4);
  truth.effects = {effect};
  truth.records.resize(1);
  truth.records[0].duration = 10.0;
  truth.records[0].warm = 0.0;
  const RigDescription description = parse_rig(truth::rig_toml(truth), "rig.toml");
  std::vector<PreparedRecording> recordings;
  recordings.push_back(prepare_recording(
      description, parse_recording_csv(truth::csv(truth, truth::simulate(truth)[0]), "rec.csv"), Use::fitted, false));
  Hypothesis hypothesis = described_hypothesis(description, recordings);
  const PlacedEffect placed{find_effect(effect.name), std::nullopt, start};
  put_effect(hypothesis.rig, placed);
  std::vector<FreeParameter> parameters = tolerated_parameters(description);
  for (const FreeParameter& parameter : effect_parameters(placed)) parameters.push_back(parameter);
  IdentificationProblem problem(std::move(recordings), hypothesis);
  Fit result = fit(problem, hypothesis, parameters);
  return {std::move(problem), std::move(result)};
}

// Law. Free play has many minima; one that is found is lower, with as many parameters, and the next search finds none
// that is higher. The same in every run.
TEST(LowerMinimum, IsFoundBesideFreePlay) {
  const FittedCar car = fitted_car({"backlash", "", {{"gap", 3e-3}}}, {2.9e-3});
  Fit once = car.fit, again = car.fit;
  find_lower_minimum(car.problem, once);
  EXPECT_LT(once.chi_squared, car.fit.chi_squared);
  EXPECT_EQ(once.parameters.size(), car.fit.parameters.size());
  EXPECT_DOUBLE_EQ(once.chi_squared, residuals(car.problem, predict(car.problem, once.hypothesis)).squaredNorm());
  find_lower_minimum(car.problem, again);
  EXPECT_EQ(once.chi_squared, again.chi_squared);
}

// Law. In a smooth valley four tries end where they began: one round. Without corners nothing is tried.
TEST(LowerMinimum, IsNotSoughtInASmoothValley) {
  const FittedCar stop = fitted_car({"bump_stop", "", {{"clearance", 8e-3}, {"stiffness", 8e4}}}, {8e-3, 8e4});
  Fit same = stop.fit;
  const std::size_t one_round = 4 * (1 + 5 * 6), before = stop.problem.work().simulations();
  find_lower_minimum(stop.problem, same);
  EXPECT_LE(stop.problem.work().simulations() - before, stop.fit.parameters.size() + one_round);
  EXPECT_NEAR(same.chi_squared, stop.fit.chi_squared, 1.0);
  const FittedCar spring = fitted_car({"progressive_spring", "", {{"cubic_stiffness", 1e7}}}, {0.97e7});
  Fit untouched = spring.fit;
  const std::size_t so_far = spring.problem.work().simulations();
  find_lower_minimum(spring.problem, untouched);
  EXPECT_EQ(spring.problem.work().simulations(), so_far);
  EXPECT_EQ(untouched.chi_squared, spring.fit.chi_squared);
}

}  // namespace
