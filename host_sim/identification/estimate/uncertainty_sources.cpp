#include "host_sim/identification/estimate/uncertainty_sources.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware/simulation/road.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/prepare/input_fusion.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using Motion = model::Motion<double>;

/// Whitened residuals of the fitted windows with inputs and starts of one's own, by recording. `doubled`: with twice
/// the steps.
Eigen::VectorXd residuals_driven_by(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                    const std::vector<SimulationInput>& inputs, const std::vector<InitialState>& starts,
                                    bool doubled) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(problem.residual_count()));
  double* out = values.data();
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    Resolution resolution = r.resolution();
    resolution.doubled = doubled;
    const SimulationInput& input = inputs.empty() ? r.samples->input : inputs[i];
    const Response readings =
        read_channels(hypothesis, *r.samples, input, starts.empty() ? hypothesis.starts[i] : starts[i],
                      r.fit_whitening->window().to, resolution);
    r.fit_whitening->whiten(r.fit_whitening->spectra(*r.samples, readings), out);
    out += r.fit_whitening->count();
  }
  return values;
}

/// (2): `offset`: of o, else of δ. Less was measured is as if more were predicted.
Eigen::VectorXd change_of_channel(const IdentificationProblem& problem, const Prediction& prediction, Channel channel,
                                  bool offset) {
  Prediction corrected = prediction;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    for (std::size_t c = 0; c < r.samples->channels.size(); ++c) {
      if (r.samples->channels[c] != channel) continue;
      Spectrum& seen = corrected.seen[i][c];
      const Spectrum one = offset
                               ? r.fit_whitening->spectrum(*r.samples, c, std::vector<double>(r.samples->size(), 1.0))
                               : prediction.seen[i][c];
      for (std::size_t k = 0; k < seen.size(); ++k) seen[k] += one[k];
    }
  }
  return residuals(problem, corrected) - residuals(problem, prediction);
}

/// The part of the input's motion that a sensor has measured, or what a constant of its samples adds to it; empty: none.
firmware::FootPointMotion motion_of_sensor(const PreparedRecording& r, Channel channel, bool offset) {
  const auto ones = [](std::size_t count) { return std::vector<double>(count, 1.0); };
  if (r.inputs_fused && (channel == Channel::z_r || channel == Channel::zdd_r)) {
    std::vector<double> position = offset ? ones(r.size()) : r.recording[Channel::z_r];
    std::vector<double> acceleration = offset ? ones(r.size()) : r.recording[Channel::zdd_r];
    std::vector<double>& other = channel == Channel::z_r ? acceleration : position;
    std::fill(other.begin(), other.end(), 0.0);
    return firmware::through_samples(
        fused_displacement(position, acceleration, r.input_noise.position, r.input_noise.acceleration, r.input.period),
        1.0 / r.input.period);
  }
  if (channel != r.input.channel) return {};
  if (!offset) return r.input.motion;
  if (r.mean_unknown) return {};
  return firmware::FootPointMotion(r.input.motion.size(), Motion{1.0, 0.0, 0.0});
}

/// m + share · (what the sensor has measured), and where that begins.
struct MovedInput {
  std::vector<SimulationInput> inputs;
  std::vector<InitialState> starts;
};
std::optional<MovedInput> moved_input(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                      Channel channel, bool offset, double share) {
  MovedInput moved;
  bool any = false;
  for (std::size_t i = 0; i < problem.samples().size(); ++i) {
    const PreparedRecording& r = problem.samples()[i];
    SimulationInput input = r.input;
    InitialState start = hypothesis.starts[i];
    if (channel == Channel::F_act) {
      any = any || !input.actuator_force.empty();
      for (double& force : input.actuator_force) force += share * (offset ? 1.0 : force);
    } else if (const firmware::FootPointMotion part = motion_of_sensor(r, channel, offset); !part.empty()) {
      any = true;
      for (std::size_t k = 0; k < input.motion.size(); ++k) {
        for (double Motion::*of : {&Motion::position, &Motion::velocity, &Motion::acceleration}) {
          input.motion[k].*of += share * part[k].*of;
        }
      }
      const bool has_car = hypothesis.rig.kind != model::RigKind::component_bench && !input.is_force();
      for (int state = 0; state < 4 && has_car; ++state) {  // wheel and body stand on it, as in true_input.hpp
        start(state) += share * (state % 2 == 0 ? part.front().position : part.front().velocity);
      }
    }
    moved.inputs.push_back(std::move(input));
    moved.starts.push_back(start);
  }
  if (!any) return std::nullopt;
  return moved;
}

/// (1) · standard deviation; `change`: what one standard deviation changes of the residuals.
Eigen::VectorXd shift_by(const Fit& fit, const Eigen::VectorXd& change) {
  return -(fit.covariance() * (fit.jacobian.transpose() * change));
}

/// Both errors of one sensor.
void add_sensor(const IdentificationProblem& problem, const Fit& fit, Channel channel,
                const firmware::CalibrationDescription& calibration, std::vector<UncertaintySource>& sources) {
  using Kind = UncertaintySource::Kind;
  for (const Kind kind : {Kind::calibration_gain, Kind::calibration_offset}) {
    const bool offset = kind == Kind::calibration_offset;
    const double sigma = offset ? calibration.standard_offset() : calibration.standard_gain();
    if (!(sigma > 0.0)) continue;
    UncertaintySource source{kind, std::string(model::name(channel)), {}};
    Eigen::VectorXd change;
    auto below = moved_input(problem, fit.hypothesis, channel, offset, -sigma);
    if (below) {
      const auto above = moved_input(problem, fit.hypothesis, channel, offset, sigma);
      change = 0.5 * (residuals_driven_by(problem, fit.hypothesis, below->inputs, below->starts, false) -
                      residuals_driven_by(problem, fit.hypothesis, above->inputs, above->starts, false));
      source.input = std::move(below->inputs);
      source.input_starts = std::move(below->starts);
    } else {
      change = sigma * change_of_channel(problem, fit.prediction, channel, offset);
    }
    if (!change.allFinite() || change.squaredNorm() == 0.0) continue;  // the channel is not recorded
    source.shift = shift_by(fit, change);
    sources.push_back(std::move(source));
  }
}

/// A tolerated parameter that the fit leaves as described.
void add_tolerance(const IdentificationProblem& problem, const Fit& fit, const FreeParameter& parameter,
                   std::vector<UncertaintySource>& sources) {
  const double sigma = (parameter.upper - parameter.lower) / std::sqrt(12.0);
  const double u = parameter.get(fit.hypothesis);
  std::vector<Variation> ends;
  for (const double end : {u + sigma, u - sigma}) {
    Hypothesis moved = fit.hypothesis;
    parameter.put(moved, end);
    if (firmware::find_rig_fault(moved.rig, problem.sample_period())) return;
    ends.push_back({std::move(moved), std::nullopt});
  }
  const std::vector<Eigen::VectorXd> values = residuals_of_each(problem, ends, false, nullptr);
  const Eigen::VectorXd change = 0.5 * (values[0] - values[1]);
  if (!change.allFinite() || change.squaredNorm() == 0.0) return;
  UncertaintySource source{UncertaintySource::Kind::tolerance, parameter.path, shift_by(fit, change)};
  source.parameter_step = parameter.value(u + sigma) - parameter.value(u);
  sources.push_back(std::move(source));
}

}  // namespace

std::vector<UncertaintySource> uncertainty_sources(const firmware::RigDescription& description,
                                                   const IdentificationProblem& problem, const Fit& fit) {
  std::vector<UncertaintySource> sources;
  if (fit.parameters.empty()) return sources;
  std::vector<FreeParameter> left;
  for (const FreeParameter& tolerated : tolerated_parameters(description)) {
    const auto same = [&](const FreeParameter& other) { return other.path == tolerated.path; };
    if (!problem.samples().front().shows(tolerated.path)) continue;
    if (std::none_of(fit.parameters.begin(), fit.parameters.end(), same)) left.push_back(tolerated);
  }
  const bool calibrated = std::any_of(description.calibration.begin(), description.calibration.end(),
                                      [](const auto& calibration) { return calibration.has_value(); });
  if (left.empty() && !calibrated) return sources;
  Fit refined = fit;
  refine_jacobian(problem, refined);
  for (std::size_t c = 0; c < description.calibration.size(); ++c) {
    if (description.calibration[c]) {
      add_sensor(problem, refined, model::channel_at(c), *description.calibration[c], sources);
    }
  }
  for (const FreeParameter& parameter : left) add_tolerance(problem, refined, parameter, sources);
  return sources;
}

Eigen::MatrixXd shifts_of(const std::vector<UncertaintySource>& sources) {
  if (sources.empty()) return {};
  Eigen::MatrixXd shifts(sources.front().shift.size(), static_cast<Eigen::Index>(sources.size()));
  for (std::size_t i = 0; i < sources.size(); ++i) shifts.col(static_cast<Eigen::Index>(i)) = sources[i].shift;
  return shifts;
}

Eigen::VectorXd discretisation_shift(const IdentificationProblem& problem, const Fit& fit) {
  if (fit.parameters.empty() || has_corners(fit.hypothesis.rig)) {
    return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(fit.parameters.size()));
  }
  const Eigen::VectorXd finer = residuals_driven_by(problem, fit.hypothesis, {}, {}, true);
  const Eigen::VectorXd as_they_are = residuals_driven_by(problem, fit.hypothesis, {}, {}, false);
  return shift_by(fit, 2.0 * (finer - as_they_are)).cwiseAbs();
}

}  // namespace host_sim::identification
