#include "host_sim/transfer/predict/next_measurement.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "host_sim/identification/common/multisine.hpp"
#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/plan/rehearsal.hpp"

namespace host_sim::transfer {

using identification::FreeParameter;

namespace {

/// A candidate: the first rig, what drives it, and the seconds for which it counts.
struct Candidate {
  std::string what;
  firmware::RigDescription rig;
  plan::Setting setting;
};

constexpr double rehearsed_seconds = 20.0, recorded_seconds = 60.0;

firmware::FootPointMotion motion_of(const identification::Identified& first) {
  const auto& recording = first.problem.samples().front().recording;
  const bool has_road = recording.has(model::Channel::z_r);
  const auto& values = has_road                               ? recording[model::Channel::z_r]
                       : recording.has(model::Channel::x_cmd) ? recording[model::Channel::x_cmd]
                                                              : recording[model::Channel::x_act];
  const auto count = std::min(values.size(), static_cast<std::size_t>(rehearsed_seconds / recording.sample_period));
  return firmware::through_samples({values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count)},
                                   1.0 / recording.sample_period);
}

/// The diagnosed rig: what will be measured is that one.
firmware::RigDescription rig_of(const firmware::RigDescription& from, const identification::Identified& first) {
  firmware::RigDescription rig = first.diagnosis.rig;
  rig.source = from.source;
  rig.tolerance.clear();
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (!rig.noise[c] && first.problem.samples().front().explains(model::channel_at(c))) {
      rig.noise[c] = first.problem.samples().front().noise[c];
    }
  }
  return rig;
}

std::vector<Candidate> candidates_of(const firmware::RigDescription& from, const identification::Identified& first) {
  const firmware::RigDescription rig = rig_of(from, first);
  const firmware::FootPointMotion motion = motion_of(first);
  std::vector<Candidate> list;
  const auto add = [&](std::string what, const firmware::RigDescription& description,
                       firmware::FootPointMotion driven) {
    list.push_back({std::move(what), description, {std::move(driven)}});
  };
  add("the same for another minute", rig, motion);
  for (const double level : {0.5, 2.0}) {
    firmware::FootPointMotion scaled = motion;
    identification::scale(scaled, level);
    add(level < 1.0 ? "half of the level" : "twice the level", rig, scaled);
  }
  const identification::MotionSize size = identification::size_of(motion);
  for (const double lowest : {0.7, 1.4, 2.8, 5.6, 11.0}) {
    firmware::FootPointMotion sines = identification::multisine({lowest, 2.0 * lowest}, rig.period(), motion.size());
    const identification::MotionSize own = identification::size_of(sines);
    identification::scale(sines, std::min(size.velocity / std::max(own.velocity, 1e-12),
                                          2.0 * size.travel / std::max(own.travel, 1e-12)));
    add("sines from " + firmware::shortest(lowest) + " to " + firmware::shortest(2.0 * lowest) + " Hz", rig, sines);
  }
  for (int open = 0; rig.rig.has_fdva && open <= rig.rig.fdva.ducts; ++open) {
    if (open == rig.rig.fdva.open_ducts) continue;
    firmware::RigDescription other = rig;
    other.rig.fdva.open_ducts = open;
    add(std::to_string(open) + (open == 1 ? " duct open" : " ducts open"), other, motion);
  }
  for (const model::Channel channel : first.problem.channels()) {
    firmware::RigDescription better = rig;
    auto& noise = better.noise[index(channel)];
    if (!noise || !(*noise > 0.0)) continue;
    *noise *= 0.5;
    add("a sensor of " + std::string(model::name(channel)) + " with half of the noise", better, motion);
  }
  return list;
}

/// JᵀJ of the parameters of the posterior, for a minute. Those that a rehearsal does not have (start states, faults of
/// the recording) learn nothing from it.
Eigen::MatrixXd information_of(const Candidate& candidate, const ComponentModel& model) {
  const plan::Rehearsal rehearsal(candidate.rig, candidate.setting);
  std::vector<FreeParameter> parameters;
  std::vector<Eigen::Index> whose;
  for (std::size_t i = 0; i < model.parameters.size(); ++i) {
    const auto role = model.parameters[i].role;
    if (role != FreeParameter::Role::tolerated && role != FreeParameter::Role::effect) continue;
    parameters.push_back(model.parameters[i]);
    whose.push_back(static_cast<Eigen::Index>(i));
  }
  const Eigen::MatrixXd j = rehearsal.jacobian(parameters);
  const Eigen::MatrixXd gram = j.transpose() * j * (recorded_seconds / rehearsed_seconds);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(model.mode.size(), model.mode.size());
  for (std::size_t a = 0; a < whose.size(); ++a) {
    for (std::size_t b = 0; b < whose.size(); ++b) {
      information(whose[a], whose[b]) = gram(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
    }
  }
  return information;
}

double spread_of(const Sensitivity& sensitivity, const Eigen::MatrixXd& covariance) {
  const auto n = static_cast<Eigen::Index>(sensitivity.parameters.size());
  Eigen::MatrixXd part(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      part(a, b) = covariance(static_cast<Eigen::Index>(sensitivity.parameters[static_cast<std::size_t>(a)]),
                              static_cast<Eigen::Index>(sensitivity.parameters[static_cast<std::size_t>(b)]));
    }
  }
  return std::sqrt(std::max(0.0, (sensitivity.gradient * part * sensitivity.gradient.transpose()).trace()));
}

}  // namespace

NextMeasurements next_measurements(const firmware::RigDescription& from, const identification::Identified& first,
                                   const Posterior& posterior, const Sensitivity& sensitivity,
                                   const Budget& wheel_load) {
  NextMeasurements result;
  const ComponentModel& model = posterior.diagnosed();
  if (sensitivity.parameters.empty()) return result;
  const std::vector<Candidate> candidates = candidates_of(from, first);
  const Eigen::MatrixXd known =
      model.covariance.ldlt().solve(Eigen::MatrixXd::Identity(model.covariance.rows(), model.covariance.cols()));
  const double now = spread_of(sensitivity, model.covariance);
  if (!(now > 0.0)) return result;
  std::vector<double> remaining(candidates.size(), std::nan(""));
  std::vector<std::string> why(candidates.size());
  identification::for_all(candidates.size(), [&](std::size_t i) {
    try {
      const Eigen::MatrixXd more = known + information_of(candidates[i], model);
      remaining[i] =
          spread_of(sensitivity, more.ldlt().solve(Eigen::MatrixXd::Identity(more.rows(), more.cols()))) / now;
    } catch (const firmware::InputError& error) {
      why[i] = candidates[i].what + " was not tried: " + error.what();
    }
  });
  const double share = wheel_load[static_cast<std::size_t>(Source::component)];
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!why[i].empty()) result.remarks.push_back(why[i]);
    if (!std::isfinite(remaining[i])) continue;
    const double left = std::min(remaining[i], 1.0);
    result.list.push_back({candidates[i].what, left, std::sqrt(1.0 - share + share * left * left)});
  }
  std::stable_sort(result.list.begin(), result.list.end(),
                   [](const auto& a, const auto& b) { return a.remaining < b.remaining; });
  return result;
}

}  // namespace host_sim::transfer
