#include "host_sim/compensation/method_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "host_sim/compensation/arrived_series.hpp"
#include "host_sim/compensation/compensated_loop.hpp"
#include "host_sim/compensation/delay_mismatch.hpp"
#include "host_sim/compensation/ideal_machine.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"

namespace host_sim::compensation {
namespace {

constexpr std::size_t frequency_count = 240;
constexpr double share_off = 0.2;  ///< of the delay, for the robustness table
constexpr double stiffer = 1.03;   ///< of the component

std::string_view assumptions(std::optional<Kind> kind) {
  if (!kind) return "nothing";
  switch (*kind) {
    case Kind::polynomial:
      return "one delay of the machine; a motion that is smooth over it";
    case Kind::inverse:
      return "delay, lag and resonance of the machine";
    case Kind::adaptive_time_series:
      return "bounds of the machine's coefficients; x_act is measured";
    case Kind::smith:
      return "machine and component: its springs, dampers and FDVA";
    case Kind::virtual_damping:
      return "delay, stiffness of the component, one mode; the damping stays in the result";
    case Kind::adaptive_virtual_damping:
      return "the same, acting while the interface feeds energy";
    case Kind::feedforward_feedback:
      return "the machine; x_act is measured";
  }
  return "";
}

Rig changed(const Rig& rig, Change change) {
  const double delay = machine_delay(rig);
  Rig result = rig;
  switch (change) {
    case Change::none:
      return rig;
    case Change::later:
      return with_delay_change(rig, share_off * delay);
    case Change::earlier:
      return with_delay_change(rig, -share_off * delay);
    case Change::lag: {
      model::MachinePath<double> path;
      rig.effects.act_on(path);
      result.effects.add(model::ActuatorDelay<double>{0.0});
      result.effects.add(model::ActuatorLag<double>{path.lag + path.delay});
      return result;
    }
    case Change::stiffer_specimen:
      result.suspension.stiffness *= stiffer;
      result.air_spring.volume /= stiffer;
      result.air_spring.counter_volume /= stiffer;
      result.fdva.coupling_stiffness *= stiffer;
      return result;
  }
  return result;
}

std::vector<double> spread_frequencies() {
  std::vector<double> hz;
  for (std::size_t i = 0; i < frequency_count; ++i) {
    hz.push_back(lowest_hz *
                 std::pow(highest_hz / lowest_hz, static_cast<double>(i) / static_cast<double>(frequency_count - 1)));
  }
  return hz;
}

/// The car with its component and no machine between them: a quarter car whose suspension has the virtual damping.
class Truth {
 public:
  explicit Truth(const Rig& rig) : response_(stability::linearise(without_delay(rig)), 0.0, 0.0) {}
  [[nodiscard]] Complex operator()(double hz) const { return response_(model::Channel::F_w, full_turn * hz); }

 private:
  stability::RoadResponse response_;
};

/// Highest |response| within a factor of two of the wheel's mode, on a grid of 0.2 %.
template <class Response>
std::pair<double, double> wheel_peak(const Response& response, double wheel_hz) {
  std::pair<double, double> best{wheel_hz, 0.0};
  for (double hz = 0.6 * wheel_hz; hz < 1.6 * wheel_hz; hz *= 1.004) {
    const double magnitude = std::abs(response(hz));
    if (magnitude > best.second) best = {hz, magnitude};
  }
  return best;
}

LoopResult examine(const CompensatedLoop& loop, double true_peak, double wheel_hz) {
  LoopResult result;
  result.spectral_radius = loop.spectral_radius();
  result.stable = result.spectral_radius < 1.0;
  if (!result.stable) return result;
  const auto peak =
      wheel_peak([&](double hz) { return loop.response(full_turn * hz)(CompensatedLoop::wheel_load); }, wheel_hz);
  result.peak_error = std::abs(peak.second / true_peak - 1.0);
  double error = 0.0, wanted = 0.0;  // |z_r|² ∝ 1/f² over logarithmic steps: weight 1/f
  for (const double hz : spread_frequencies()) {
    const auto y = loop.response(full_turn * hz);
    error += std::norm(y(CompensatedLoop::reached) - y(CompensatedLoop::wanted)) / hz;
    wanted += std::norm(y(CompensatedLoop::wanted)) / hz;
  }
  result.tracking = std::sqrt(error / wanted);
  return result;
}

/// The time series follows a change of the machine; every other method keeps its assumption.
CompensatedLoop loop_of(const Rig& rig, double period, const std::optional<Settings>& settings) {
  return compensated_loop(rig, period, settings ? &*settings : nullptr);
}

}  // namespace

MethodComparison compare_methods(const firmware::RigDescription& description) {
  if (description.rig.kind != model::RigKind::hil) {
    throw firmware::InputError(
        description.source, 0,
        "compensation needs the loop of a hil rig, this is a " + std::string(model::name(description.rig.kind)),
        "kind = \"hil\"");
  }
  // Delays that no effect models stand at the machine, as those of the sensors are assumed there.
  const Rig rig = with_delay_change(stability::sampled_part(description.rig), description.delay_budget.sum());
  const double period = description.period();
  MethodComparison result;
  result.delay = machine_delay(rig);
  if (!(result.delay > 0.0)) {
    throw firmware::InputError(description.source, 0, "the machine of this rig is not late",
                               "[effects.actuator_delay], actuator_lag or actuator_resonance, as diagnose names them");
  }
  result.frequency_hz = spread_frequencies();
  const double wheel_hz = firmware::wheel_mode(rig) / full_turn;
  std::array<double, 5> true_peaks{};
  for (std::size_t change = 0; change < true_peaks.size(); ++change) {
    const Truth truth(changed(rig, static_cast<Change>(change)));
    const auto [hz, peak] = wheel_peak(truth, wheel_hz);
    true_peaks[change] = peak;
    if (change > 0) continue;
    result.peak_hz = hz;
    result.peak = peak;
    for (const double f : result.frequency_hz) {
      result.truth.push_back(std::abs(truth(f)));
      result.truth_phase.push_back(std::arg(truth(f)));
    }
  }
  for (int k = -1; k < static_cast<int>(firmware::compensation::kind_names.size()); ++k) {
    const auto kind = k < 0 ? std::nullopt : std::optional(static_cast<Kind>(k));
    std::optional<Settings> settings;
    if (kind) settings = firmware::compensation_settings(description, *kind);
    MethodResult method;
    method.name = kind ? std::string(name(*kind)) : "none";
    method.needs_component_model = kind && needs_component_model(*kind);
    method.assumes = assumptions(kind);
    for (std::size_t change = 0; change < true_peaks.size(); ++change) {
      const auto loop = loop_of(changed(rig, static_cast<Change>(change)), period, settings);
      method.over_changes[change] = examine(loop, true_peaks[change], wheel_hz);
      if (change > 0) continue;
      for (const double f : result.frequency_hz) {
        const Complex y = loop.response(full_turn * f)(CompensatedLoop::wheel_load);
        method.magnitude.push_back(std::abs(y));
        method.phase.push_back(std::arg(y));
      }
    }
    const DelayMismatch mismatch = delay_mismatch(rig, period, settings ? &*settings : nullptr);
    method.critical_later = mismatch.later;
    method.critical_earlier = mismatch.earlier;
    method.critical_error = method.over_changes[0].stable ? mismatch.smallest() : 0.0;
    method.radius_over_error = mismatch.radius;
    result.delay_error = mismatch.error;
    result.methods.push_back(std::move(method));
  }
  return result;
}

}  // namespace host_sim::compensation
