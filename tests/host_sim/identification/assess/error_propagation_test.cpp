// Uncertainty budgets of estimates and predictions.
#include "host_sim/identification/assess/error_propagation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/host_sim/identification/sample_problem.hpp"

namespace error_propagation_test {
namespace {

using namespace host_sim::identification;
using model::Channel;
using Source = UncertaintyBudget::Source;

firmware::RigDescription calibrated_bench() {
  firmware::RigDescription bench = sample::bench();
  bench.tolerance["suspension.damping"] = 0.05;
  firmware::CalibrationDescription calibration;
  calibration.gain = 0.002;
  bench.calibration[index(Channel::F)] = calibration;
  return bench;
}

struct Fitted {
  IdentificationProblem problem;
  Fit result;
  FitErrors errors;
};
Fitted fitted_to(const firmware::RigDescription& bench, firmware::Recording recording) {
  std::vector<PreparedRecording> recordings{prepare_recording(bench, std::move(recording), Use::fitted, false)};
  const Hypothesis given = described_hypothesis(bench, recordings);
  IdentificationProblem problem(std::move(recordings), given);
  Fit found = fit(problem, given, tolerated_parameters(bench));
  refresh_jacobian(problem, found);
  FitErrors errors = fit_errors(bench, problem, found, uncertainty(problem, suspect_parameters(bench), found));
  return {std::move(problem), std::move(found), std::move(errors)};
}

double part_of(const UncertaintyBudget& budget, Source source, const std::string& of = "") {
  for (const UncertaintyBudget::Part& part : budget.parts) {
    if (part.source == source && part.of == of) return part.standard;
  }
  return 0.0;
}

/// (1) of uncertainty_budget.hpp, to rounding and what is left out as nothing.
void expect_to_sum_up(const UncertaintyBudget& budget) {
  double variance = 0.0, shares = 0.0;
  for (const UncertaintyBudget::Part& part : budget.parts) {
    variance += part.standard * part.standard;
    shares += budget.share(part);
  }
  EXPECT_NEAR(variance / (budget.combined * budget.combined), 1.0, 1e-4);
  EXPECT_NEAR(shares, 1.0, 1e-4);
}

// Law. The parts are the whole, in the unit of the value, and half of the interval is coverage times the whole.
TEST(ParameterBudgets, SumUp) {
  const auto bench = calibrated_bench();
  const Fitted f = fitted_to(bench, sample::recorded(bench));
  const auto budgets = parameter_budgets(f.result, f.errors);
  ASSERT_EQ(budgets.size(), f.result.parameters.size());
  const std::vector<Interval> values = intervals(f.result, f.errors.known.half_widths);
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    expect_to_sum_up(budgets[i]);
    EXPECT_NEAR(budgets[i].coverage * budgets[i].combined, 0.5 * (values[i].upper - values[i].lower),
                1e-9 * values[i].value);
  }
}

// Point. k = F/x: 0.1 % of F is 0.1 % of the stiffness and of the damping.
TEST(ParameterBudgets, HoldTheCertificateOfTheForce) {
  const auto bench = calibrated_bench();
  const Fitted f = fitted_to(bench, sample::recorded(bench));
  const auto budgets = parameter_budgets(f.result, f.errors);
  for (std::size_t i = 0; i < budgets.size(); ++i) {
    const FreeParameter& parameter = f.result.parameters[i];
    const double value = parameter.value(parameter.get(f.result.hypothesis));
    EXPECT_NEAR(part_of(budgets[i], Source::calibration, "F"), 1e-3 * value, 2e-5 * value) << parameter.path;
  }
  EXPECT_TRUE(largest_part(budgets.back()).starts_with("mostly calibration of F: ")) << largest_part(budgets.back());
}

// Point. Of noise alone the part is that of the likelihood; a model that is right adds nothing.
TEST(ParameterBudgets, HoldTheLikelihoodsNoise) {
  const Fitted f = fitted_to(sample::bench(), sample::recorded(sample::bench(), 12.0));
  const UncertaintyBudget budget = parameter_budgets(f.result, f.errors).front();
  const double of_likelihood = std::sqrt(f.result.covariance()(0, 0)) * f.result.parameters[0].scale;
  EXPECT_NEAR(part_of(budget, Source::noise) / of_likelihood, 1.0, 0.05);
  EXPECT_LT(part_of(budget, Source::model), 0.35 * budget.combined);
  // Its width of 2 has the information 12/2², whose part of the variance is 3 A⁻².
  const double of_tolerance = std::sqrt(3.0) * f.result.covariance()(0, 0) * f.result.parameters[0].scale;
  EXPECT_NEAR(part_of(budget, Source::tolerance, "suspension.stiffness") / of_tolerance, 1.0, 0.1);
  EXPECT_EQ(part_of(budget, Source::calibration, "F"), 0.0);
}

// Point. What the residual holds beyond noise is the model's: bursts in one of eight seconds.
TEST(ParameterBudgets, GiveBurstsToTheModel) {
  firmware::Recording bursts = sample::recorded(sample::bench(), 12.0);
  const auto& x = bursts[Channel::x_cmd];
  for (std::size_t k = 6000; k < 7500; ++k) bursts[Channel::F][k] += 60.0 * x[k] / 8e-3;
  const Fitted f = fitted_to(sample::bench(), std::move(bursts));
  const UncertaintyBudget budget = parameter_budgets(f.result, f.errors).front();
  EXPECT_GT(part_of(budget, Source::model), 0.9 * budget.combined);
  expect_to_sum_up(budget);
}

// Point. Where the tolerance alone holds a parameter, its budget is a uniform distribution's: 5 %/√3.
TEST(ParameterBudgets, AreTheToleranceAtItsBound) {
  firmware::RigDescription truth = sample::bench();
  truth.rig.suspension.stiffness *= 1.10;
  const Fitted f = fitted_to(sample::bench(), sample::recorded(truth));
  const UncertaintyBudget budget = parameter_budgets(f.result, f.errors).front();
  ASSERT_EQ(budget.parts.size(), 1U);
  EXPECT_EQ(words(budget.parts[0]), "tolerance of suspension.stiffness");
  EXPECT_NEAR(budget.combined, 0.05 * 30000.0 / std::sqrt(3.0), 1e-6);
  EXPECT_NEAR(budget.coverage, std::sqrt(3.0), 1e-12);
}

// Law (2). The force that a bench predicts for its command is as uncertain as its load cell: 0.1 %; the deflection, which
// follows the command, is not uncertain at all.
TEST(PredictedChannels, AreAsUncertainAsTheirSensor) {
  const auto bench = calibrated_bench();
  const Fitted f = fitted_to(bench, sample::recorded(bench));
  const auto predictions = predicted_channels(f.problem, f.result, f.errors, false);
  ASSERT_EQ(predictions.size(), 2U);
  for (const PredictedNumber* const force : {&predictions.at(Channel::F).rms, &predictions.at(Channel::F).peak}) {
    expect_to_sum_up(force->budget);
    EXPECT_NEAR(part_of(force->budget, Source::calibration, "F"), 1e-3 * force->interval.value,
                2e-5 * force->interval.value);
    EXPECT_NEAR(force->interval.upper - force->interval.value, 1.96 * force->budget.combined, 1e-9);
  }
  EXPECT_LT(predictions.at(Channel::x_act).rms.budget.combined, 1e-9);
}

// Law (2). On a deflection whose sensor is off by σ the force that is predicted is the measured one: the error of the
// estimate and that of the input take each other away.
TEST(PredictedChannels, CountAnErrorOnce) {
  firmware::RigDescription bench = calibrated_bench();
  std::swap(bench.calibration[index(Channel::F)], bench.calibration[index(Channel::x_act)]);
  firmware::Recording recording = sample::recorded(bench);
  recording[Channel::x_cmd].clear();
  const Fitted f = fitted_to(bench, std::move(recording));
  EXPECT_NEAR(part_of(parameter_budgets(f.result, f.errors).back(), Source::calibration, "x_act"), 30.0, 1.0);
  const PredictedNumber force = predicted_channels(f.problem, f.result, f.errors, false).at(Channel::F).rms;
  EXPECT_LT(part_of(force.budget, Source::calibration, "x_act"), 2e-5 * force.interval.value);
}

// Point (4). A rest of D beyond noise moves a rms by at most D.
TEST(PredictedChannels, HoldTheRest) {
  firmware::Recording bursts = sample::recorded(sample::bench(), 12.0);
  for (std::size_t k = 0; k < bursts.size(); ++k)
    bursts[Channel::F][k] += 50.0 * std::sin(0.02 * static_cast<double>(k));
  const Fitted f = fitted_to(sample::bench(), std::move(bursts));
  const auto with = predicted_channels(f.problem, f.result, f.errors, true).at(Channel::F).rms;
  EXPECT_NEAR(part_of(with.budget, Source::model), 50.0 / std::sqrt(2.0) / std::sqrt(3.0), 2.0);
  expect_to_sum_up(with.budget);
}

}  // namespace
}  // namespace error_propagation_test
