// Errors of calibration, tolerance and steps, carried into an estimate.
#include "host_sim/identification/estimate/uncertainty_sources.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/identification/estimate/uncertainty.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace uncertainty_sources_test {
namespace {

using namespace host_sim::identification;
using Kind = UncertaintySource::Kind;
using model::Channel;

firmware::RigDescription calibrated(firmware::RigDescription description, Channel channel, double gain,
                                    double offset = 0.0) {
  firmware::CalibrationDescription calibration;
  calibration.gain = gain;
  calibration.offset = offset;
  description.calibration[index(channel)] = calibration;
  return description;
}

/// The bench of sample_problem.hpp with its stiffness free; `driven_by`: the channel that is taken away decides which
/// of x_cmd and x_act drives.
struct Fitted {
  IdentificationProblem problem;
  Fit result;
};
Fitted fitted_to(const firmware::RigDescription& description, firmware::Recording recording,
                 std::vector<FreeParameter> parameters) {
  std::vector<PreparedRecording> recordings{prepare_recording(description, std::move(recording), Use::fitted, false)};
  const Hypothesis given = described_hypothesis(description, recordings);
  IdentificationProblem problem(std::move(recordings), given);
  for (const FreeParameter& start : start_parameters(description, problem.samples())) parameters.push_back(start);
  Fit found = fit(problem, given, std::move(parameters));
  refresh_jacobian(problem, found);
  return {std::move(problem), std::move(found)};
}
Fitted fitted_to(const firmware::RigDescription& description, firmware::Recording recording) {
  return fitted_to(description, std::move(recording), tolerated_parameters(description));
}

/// Relative change of the stiffness by one standard deviation of the only source.
double relative_shift(const Fitted& f, const firmware::RigDescription& description) {
  const auto sources = uncertainty_sources(description, f.problem, f.result);
  EXPECT_EQ(sources.size(), 1U);
  return sources.empty() ? 0.0 : sources[0].shift(0) * f.result.parameters[0].scale / 30000.0;
}

// Point (2). A force that is read too large by 0.1 % makes the stiffness too large by that: corrected, it is smaller.
// The damping, which is exact, is in quadrature: over T = 8 s its work on x leaves b/(k T) = 0.4 % of that.
TEST(UncertaintySources, MoveAStiffnessAsTheForceIsOff) {
  const auto description = calibrated(sample::bench(), Channel::F, 0.002);
  EXPECT_NEAR(relative_shift(fitted_to(description, sample::recorded(description)), description), -1e-3, 1e-5);
}

// Point (3). On a measured deflection the stiffness goes with its inverse.
TEST(UncertaintySources, MoveAStiffnessAgainstTheDeflectionThatDrives) {
  const auto description = calibrated(sample::bench(), Channel::x_act, 0.002);
  firmware::Recording recording = sample::recorded(description);
  recording[Channel::x_cmd].clear();
  EXPECT_NEAR(relative_shift(fitted_to(description, std::move(recording)), description), 1e-3, 1e-5);
}

// Law. A deflection that is only answered says nothing of a stiffness, and of a sensor that is not recorded nothing is
// said.
TEST(UncertaintySources, LeaveAloneWhatASensorDoesNotShow) {
  const auto description = calibrated(sample::bench(), Channel::x_act, 0.002);
  const Fitted answered = fitted_to(description, sample::recorded(description));
  EXPECT_NEAR(relative_shift(answered, description), 0.0, 1e-9);
  firmware::Recording without = sample::recorded(description);
  without[Channel::x_act].clear();
  const Fitted f = fitted_to(description, std::move(without));
  EXPECT_TRUE(uncertainty_sources(description, f.problem, f.result).empty());
}

// Law (1). A fit to what is corrected for the error ends where the shift says: of a constant of the force, on a motion 10 mm
// beside the middle, which does not tell it from a stiffness.
TEST(UncertaintySources, AgreeWithAFitToWhatIsCorrected) {
  const auto description = calibrated(sample::bench(), Channel::F, 0.0, 2.0);
  firmware::Recording recording = sample::recorded(description);
  for (double& value : recording[Channel::x_cmd]) value += 10e-3;
  for (double& value : recording[Channel::x_act]) value += 10e-3;
  for (double& value : recording[Channel::F]) value += 30000.0 * 10e-3;
  const Fitted as_read = fitted_to(description, recording);
  for (double& value : recording[Channel::F]) value -= 1.0;
  const Fitted corrected = fitted_to(description, std::move(recording));
  const double moved = corrected.result.parameters[0].get(corrected.result.hypothesis) -
                       as_read.result.parameters[0].get(as_read.result.hypothesis);
  const auto sources = uncertainty_sources(description, as_read.problem, as_read.result);
  ASSERT_EQ(sources.size(), 1U);
  EXPECT_EQ(sources[0].kind, Kind::calibration_offset);
  EXPECT_LT(moved, -0.02);
  EXPECT_NEAR(sources[0].shift(0) / moved, 1.0, 0.01);
}

// Law (3). The same of both sensors of one foot point: each has its share of the fusion.
TEST(UncertaintySources, ShareAFootPointAsItsFusionDoes) {
  const auto car = firmware::parse_rig(
      "kind = 'quarter_car'\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\nstiffness = "
      "200e3\ndamping = 100.0\n[suspension]\nstiffness = 31500.0\ndamping = 1500.0\n[tolerance]\n'tyre.stiffness' = "
      "0.05\n[noise]\nz_r = 2e-5\nzdd_r = 0.05\nF_w = 5.0\n",
      "car.toml");
  firmware::Recording truth;
  truth.sample_period = 1e-3;
  truth.source = "car.csv";
  truth.time = firmware::sample_times(6000, 1000.0);
  const auto road = support::random_road(64e-6, 1e-3, 6.0, 5);
  for (const auto& point : road) truth[Channel::z_r].push_back(point.position);
  const host_sim::SimulationInput input = host_sim::simulation_input(car.rig, truth);
  const host_sim::Response response = host_sim::simulate(car.rig, input, host_sim::resting(car.rig, input));
  support::NormalNoise noise(3);
  firmware::Recording recording = truth;
  for (std::size_t k = 0; k < recording.size(); ++k) {
    recording[Channel::zdd_r].push_back(input.motion[k].acceleration + 0.05 * noise());
    recording[Channel::F_w].push_back(response[index(Channel::F_w)][k] + 5.0 * noise());
    recording[Channel::z_r][k] += 2e-5 * noise();
  }
  const Fitted as_read = fitted_to(car, recording);
  ASSERT_TRUE(as_read.problem.samples().front().inputs_fused);
  double together = 0.0;
  for (const Channel channel : {Channel::z_r, Channel::zdd_r}) {
    firmware::Recording other = recording;
    for (double& value : other[channel]) value *= 1.0 - 0.001;
    const Fitted corrected = fitted_to(car, std::move(other));
    const double moved = corrected.result.parameters[0].get(corrected.result.hypothesis) -
                         as_read.result.parameters[0].get(as_read.result.hypothesis);
    const auto description = calibrated(car, channel, 0.002);
    const auto sources = uncertainty_sources(description, as_read.problem, as_read.result);
    ASSERT_EQ(sources.size(), 1U);
    EXPECT_NEAR(sources[0].shift(0), moved, 0.05 * std::abs(moved) + 1e-4) << model::name(channel);
    together += sources[0].shift(0);
  }
  // Both are the whole motion: F_w = k (z_r − z_w) is 0.1 % too small for it.
  EXPECT_GT(together, 0.0);
}

// Point (4). What is not fitted moves what is: a second spring of the same place is the first one's loss. σ = 2 · 0.05 ·
// 30 000/√12.
TEST(UncertaintySources, HoldAToleranceThatIsNotFitted) {
  const auto description = sample::with_effect(sample::bench(), "progressive_spring", {1e6});
  const Fitted other = fitted_to(description, sample::recorded(description),
                                 effect_parameters({firmware::find_effect("progressive_spring"), std::nullopt, {1e6}}));
  const auto sources = uncertainty_sources(description, other.problem, other.result);
  ASSERT_EQ(sources.size(), 1U);
  EXPECT_EQ(sources[0].kind, Kind::tolerance);
  EXPECT_EQ(sources[0].of, "suspension.stiffness");
  EXPECT_NEAR(sources[0].parameter_step, 2.0 * 0.05 * 30000.0 / std::sqrt(12.0), 1e-6);
  // ∫ x⁴ against ∫ x⁶: what a cubic spring takes over of a linear one.
  const auto& x = other.problem.samples().front().recording[Channel::x_cmd];
  double fourth = 0.0, sixth = 0.0;
  for (const double value : x) {
    fourth += std::pow(value, 4);
    sixth += std::pow(value, 6);
  }
  const double expected = -sources[0].parameter_step * fourth / sixth;
  const double found = sources[0].shift(0) * other.result.parameters[0].scale;
  EXPECT_NEAR(found / expected, 1.0, 0.02);
}

// Point (8). The interval is the root of the sum of both squares, of each parameter and of any combination.
TEST(UncertaintySources, WidenTheInterval) {
  const auto description = calibrated(sample::bench(), Channel::F, 0.002);
  const Fitted f = fitted_to(description, sample::recorded(description));
  Uncertainty known = uncertainty(f.problem, suspect_parameters(description), f.result);
  const double before = known.half_widths(0);
  const auto sources = uncertainty_sources(description, f.problem, f.result);
  known.add_shifts(shifts_of(sources));
  const double expected = std::hypot(before, 1.96 * sources[0].shift(0));
  EXPECT_GT(expected, 1.5 * before);
  EXPECT_DOUBLE_EQ(known.half_widths(0), expected);
  EXPECT_DOUBLE_EQ(known.half_width_of(Eigen::VectorXd::Unit(known.half_widths.size(), 0)), expected);
}

// Law. Without [calibration] and with every tolerance fitted nothing is added, to the bit.
TEST(UncertaintySources, AreNoneOfADescriptionWithoutCalibration) {
  const auto description = sample::bench();
  const Fitted f = fitted_to(description, sample::recorded(description));
  EXPECT_TRUE(uncertainty_sources(description, f.problem, f.result).empty());
  Uncertainty known = uncertainty(f.problem, suspect_parameters(description), f.result);
  const Eigen::VectorXd before = known.half_widths;
  known.add_shifts(shifts_of({}));
  EXPECT_EQ(known.half_widths, before);
}

/// A car with a spring of so much N/m³ (0: without), and what it answers to 8 and 70 rad/s.
struct Car {
  firmware::RigDescription description;
  firmware::Recording recording;
};
Car car_with(double cubic) {
  const std::string spring =
      cubic > 0.0 ? "[effects.progressive_spring]\ncubic_stiffness = " + std::to_string(cubic) + "\n" : "";
  Car car{firmware::parse_rig(
              "kind = 'quarter_car'\nsample_rate = 1000.0\n[body]\nmass = 290.0\n[wheel]\nmass = 40.0\n[tyre]\n"
              "stiffness = 200e3\ndamping = 100.0\n[suspension]\nstiffness = 31500.0\ndamping = 1500.0\n" +
                  spring + "[tolerance]\n'tyre.stiffness' = 0.05\n[noise]\nzdd_w = 0.1\n",
              "car.toml"),
          {}};
  car.recording.sample_period = 1e-3;
  car.recording.source = "car.csv";
  car.recording.time = firmware::sample_times(5000, 1000.0);
  for (const double t : car.recording.time) {
    car.recording[Channel::z_r].push_back(5e-3 * (1.0 - std::exp(-std::pow(t / 0.2, 3))) *
                                          (std::sin(8.0 * t) + 0.2 * std::sin(70.0 * t)));
  }
  const auto& rig = car.description.rig;
  const host_sim::SimulationInput input = host_sim::simulation_input(rig, car.recording);
  const host_sim::Response response = host_sim::simulate(rig, input, host_sim::resting(rig, input));
  support::NormalNoise noise(3);
  for (const double value : response[index(Channel::zdd_w)]) {
    car.recording[Channel::zdd_w].push_back(value + 0.1 * noise());
  }
  return car;
}

// Law (5). A linear rig is stepped exactly. Where a force bends, twice what a fit moves that takes half of the step.
TEST(DiscretisationShift, IsTwiceWhatHalfOfTheStepMoves) {
  const Car linear = car_with(0.0);
  const Fitted exact = fitted_to(linear.description, linear.recording);
  EXPECT_LT(discretisation_shift(exact.problem, exact.result)(0), 1e-12);

  Car bent = car_with(1e8);
  const Fitted f = fitted_to(bent.description, bent.recording);
  const double shift = discretisation_shift(f.problem, f.result)(0);
  const PreparedRecording& samples = f.problem.samples().front();
  const Hypothesis& found = f.result.hypothesis;
  const auto read = [&](Resolution resolution) {
    return true_channels(found, samples, samples.input, found.starts.front(), 0, resolution)[index(Channel::zdd_w)];
  };
  const std::vector<double> as_is = read({samples.substeps}), finer = read({samples.substeps, false, true});
  for (std::size_t k = 0; k < as_is.size(); ++k) bent.recording[Channel::zdd_w][k] += as_is[k] - finer[k];
  const Fitted other = fitted_to(bent.description, bent.recording);
  const double moved =
      other.result.parameters[0].get(other.result.hypothesis) - f.result.parameters[0].get(f.result.hypothesis);
  EXPECT_GT(shift, 1e-8);
  EXPECT_NEAR(shift / (2.0 * std::abs(moved)), 1.0, 0.05);
}

}  // namespace
}  // namespace uncertainty_sources_test
