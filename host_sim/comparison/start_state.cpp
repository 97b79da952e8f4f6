#include "host_sim/comparison/start_state.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "host_sim/comparison/lane_simulation.hpp"
#include "host_sim/least_squares/gauss_newton.hpp"

namespace host_sim {
namespace {

using model::Channel;
using model::RigKind;
using Rig = model::RigParameters<double>;

/// [1] of a channel's rms: what is nearer than this is where it would be at rest.
constexpr double allowed_share = 0.05;

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

/// Measured channels that depend on the start: simulated by the model, not zero throughout.
std::vector<Channel> channels_to_fit(const Rig& rig, const SimulationInput& input,
                                     const firmware::Recording& recording) {
  std::vector<Channel> channels;
  for (const Channel channel : response_channels(rig.kind, input)) {
    if (recording.has(channel) && rms(recording[channel]) > 0.0) channels.push_back(channel);
  }
  return channels;
}

/// (1) as a least-squares problem: the states that are free, in SI units.
class StartProblem {
 public:
  StartProblem(const Rig& rig, const SimulationInput& input, const firmware::Recording& recording,
               const firmware::MeasuringRanges& range)
      : rig_(rig),
        input_(input),
        recording_(recording),
        range_(range),
        channels_(channels_to_fit(rig, input, recording)),
        start_(resting(rig, input)) {
    constexpr double window = 3.0;  // [s]
    constexpr std::size_t fewest = 10;
    samples_ = std::max(fewest, std::min(input.size(), static_cast<std::size_t>(window / input.period)));
    free_ = free_states(rig, input, recording);
    model::MachinePath<double> machine{};
    rig.effects.act_on(machine);
    if (rig.kind == RigKind::component_bench && !remembers(machine)) std::erase(free_, bench_machine_state);
    size_ = size_of_motion(rig, input, recording);
  }

  [[nodiscard]] bool is_open() const { return !free_.empty() && size_ > 0.0; }
  [[nodiscard]] const InitialState& start() const { return start_; }

  bool find_jacobian() {
    const Response base = simulate(rig_, input_, start_, samples_);
    std::vector<Response> moved;
    std::vector<double> steps;
    for (const int state : free_) {
      constexpr double rate = 10.0;  // [1/s] of a body mode: velocities are about this times displacements
      const double step = 1e-4 * size_ * (state % 2 == 1 ? rate : 1.0);
      InitialState other = start_;
      other(state) += step;
      moved.push_back(simulate(rig_, input_, other, samples_));
      steps.push_back(step);
    }
    const auto n = static_cast<Eigen::Index>(free_.size());
    equations_ = {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
    Eigen::VectorXd row(n);
    for (const Channel channel : channels_) {
      const double weight = 1.0 / rms(recording_[channel]);
      const auto& range = range_[index(channel)];
      for (std::size_t k = 0; k < std::min(samples_, input_.size()); ++k) {
        if (range && !range->holds(recording_[channel][k])) continue;
        const double simulated = base[index(channel)][k];
        for (Eigen::Index i = 0; i < n; ++i) {
          const auto at = static_cast<std::size_t>(i);
          row(i) = weight * (moved[at][index(channel)][k] - simulated) / steps[at];
        }
        equations_.hessian.noalias() += row * row.transpose();
        equations_.gradient -= row * (weight * (recording_[channel][k] - simulated));
      }
    }
    return equations_.hessian.allFinite() && equations_.gradient.allFinite();
  }

  [[nodiscard]] const NormalEquations& normal_equations() const { return equations_; }

  /// No bounds: the channels determine the state.
  [[nodiscard]] StepBox box(double) const {
    const auto n = static_cast<Eigen::Index>(free_.size());
    constexpr double far = 1e12;
    return {Eigen::VectorXd::Constant(n, -far), Eigen::VectorXd::Constant(n, far)};
  }

  double move(const Eigen::VectorXd& d) {
    for (Eigen::Index i = 0; i < d.size(); ++i) start_(free_[static_cast<std::size_t>(i)]) += d(i);
    return d.norm();
  }

 private:
  const Rig& rig_;
  const SimulationInput& input_;
  const firmware::Recording& recording_;
  const firmware::MeasuringRanges& range_;
  std::vector<Channel> channels_;
  InitialState start_;
  std::size_t samples_ = 0;
  std::vector<int> free_;  ///< indices of the states
  double size_ = 0.0;      ///< largest displacement of the input: the scale of a difference
  NormalEquations equations_;
};

}  // namespace

bool begins_at_rest(const Rig& rig, const SimulationInput& input, const firmware::Recording& recording) {
  constexpr std::size_t beginning = 10;  // samples
  const Response quiet = simulate(rig, input, resting(rig, input), 1);
  for (const Channel channel : channels_to_fit(rig, input, recording)) {
    const auto& data = recording[channel];
    const double allowed = allowed_share * rms(data);
    const double still = quiet[index(channel)].front();
    for (std::size_t k = 0; k < std::min(beginning, data.size()); ++k) {
      if (std::abs(data[k] - still) > allowed) return false;
    }
  }
  return true;
}

std::vector<int> free_states(const Rig& rig, const SimulationInput& input, const firmware::Recording& recording) {
  std::vector<int> states;
  if (rig.kind == RigKind::component_bench) {
    const std::vector<double>& reached = recording[Channel::x_act];
    if (input.channel == Channel::x_cmd && !reached.empty() &&
        std::abs(reached.front() - recording[Channel::x_cmd].front()) > allowed_share * rms(reached)) {
      states.push_back(bench_machine_state);
    }
  } else {
    states = input.wheel_prescribed || input.is_force() ? std::vector{2, 3} : std::vector{0, 1, 2, 3};
  }
  if (rig.has_fdva && rig.fdva.open_ducts > 0) states.insert(states.end(), {4, 5});
  return states;
}

InitialState estimated_start(const Rig& rig, const SimulationInput& input, const firmware::Recording& recording,
                             const firmware::MeasuringRanges& range) {
  StartProblem problem(rig, input, recording, range);
  if (problem.is_open()) full_gauss_newton_steps(problem, 2, 0.0);
  return problem.start();
}

}  // namespace host_sim
