#include "host_sim/stability/margins/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "firmware/description/text/input_error.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim::stability {
namespace {

/// −d arg(over/under)/dω at jω [s]
double group_delay(const Polynomial& over, const Polynomial& under, double omega) {
  const Complex s(0.0, omega);
  const auto [n, dn] = over.jet(s);
  const auto [d, dd] = under.jet(s);
  return (dd / d - dn / n).real();
}

DelayBalance balance_of(const StabilityAnalysis& analysis, const firmware::RigDescription& description) {
  DelayBalance balance;
  const firmware::DelayBudget& budget = description.delay_budget;
  const auto add = [&](std::string name, double seconds, bool in_loop_delay) {
    if (seconds != 0.0) balance.parts.push_back({std::move(name), seconds, in_loop_delay});
  };
  add("sensor age", budget.sensor_age, true);
  add("transport", budget.transport, true);
  add("computation", budget.computation, true);
  add("force sensor", analysis.rig.sensor_delay, true);
  balance.parts.push_back({"actuator", analysis.rig.machine_delay, true});
  const double varies = description.rig.delay_variation.farthest();
  add("swing and jitter of the actuator, worst case", varies, false);
  const double hold = 0.5 * description.period();
  balance.parts.push_back({"half a step of hold", hold, false});
  balance.total = analysis.delay + varies + hold;
  if (analysis.margins.critical_delay) balance.left = *analysis.margins.critical_delay - balance.total;

  const double omega =
      analysis.margins.critical_delay ? analysis.margins.critical_omega : analysis.roots.rightmost().imag();
  const auto [over, under] = analysis.rig.machine_response();
  add("lags of the machine, at the critical frequency", group_delay(over, under, omega), false);
  const TransferMatrix& sensor = analysis.rig.force_sensor;
  add("lag of the force sensor, at the critical frequency",
      group_delay(sensor.numerator(0, 0), sensor.denominator(), omega), false);
  return balance;
}

/// Second, independent count of the unstable roots, from the crossings.
void check_count(const StabilityAnalysis& analysis) {
  const auto counted = unstable_roots(analysis.rig.p, analysis.rig.q, analysis.margins.frequencies, analysis.delay);
  if (!counted) return;
  int found = 0;
  for (const Complex s : analysis.roots.roots) {
    if (std::abs(s.real()) < 1e-9 * (1.0 + std::abs(s))) return;  // on the axis: neither side
    if (s.real() > 0.0) found += s.imag() > 0.0 ? 2 : 1;
  }
  if (found != *counted) throw CountMismatch(found, *counted, 0.0);
}

/// The figures of the loop that runs.
void add_sampled(StabilityAnalysis& result, const firmware::RigDescription& description, const AffineFamily& family) {
  const double period = description.period(), hold = 0.5 * period;
  const auto& m = result.margins;
  if (m.delay_margin) result.delay_left = *m.delay_margin - hold;
  if (!result.sampled) return;
  const model::RigParameters<double> rig = sampled_part(description.rig);
  const double sensor = result.rig.sensor_delay, machine = result.delay - sensor;
  if (m.delay_margin) {
    const double edge = result.delay + *m.delay_margin;
    std::optional<double> border;
    if (m.critical_delay && std::abs(edge - *m.critical_delay) < 1e-12) border = result.sampled->critical_delay;
    if (!border) border = sampled_border(rig, period, {edge - sensor, m.delay_margin_omega});
    if (border) result.delay_left = *border - machine;
  }
  result.sampled_margins = sampled_margins(step_matrix(rig, period, machine), period, result.sampled->stable());
  const double given = description.rig.machine.virtual_damping;
  for (const AxisValue& value : axis_values(family, result.delay + hold, 0.0, most_virtual_damping)) {
    if (!value.border) continue;
    const auto found = sampled_damping_border(rig, period, machine, {value.value, value.omega});
    if (!found) continue;
    if (!result.sampled_damping || std::abs(found->value - given) < std::abs(result.sampled_damping->value - given)) {
      result.sampled_damping = found;
    }
  }
  const auto& v = description.rig.delay_variation;
  if (!v.any()) return;
  const double longest = static_cast<double>(model::RigModel<>::Line::longest) * period;
  result.sampled_over_delays = sampled_over_delays(rig, period, std::max(0.0, machine - v.farthest()),
                                                   std::min(longest, machine + v.farthest()));
}

StabilityAnalysis analyse_smooth(const firmware::RigDescription& description, double line) try {
  StabilityAnalysis result;
  result.rig = linearise(description.rig);
  const double extra = description.delay_budget.sum();
  result.machine_delay = result.rig.machine_delay;
  result.delay = result.rig.delay() + extra;
  if (!(result.delay <= longest_delay)) throw UnfitLoop("its delays add up to more than 1 s");
  const DelayEquation equation = result.equation();

  result.roots = characteristic_roots(equation, line);
  result.stable = result.roots.rightmost().real() < 0.0;
  result.margins = margins(equation, result.stable);
  check_count(result);
  result.sensitivity = sensitivity_peak(equation);
  for (int order = 1; order <= 5; ++order) {
    result.pade.push_back(pade_critical_delay(order, result.margins.frequencies, result.margins.critical_delay));
  }

  const AffineFamily family = affine_family(
      [&](double damping) {
        model::RigParameters<double> rig = description.rig;
        rig.machine.virtual_damping = damping;
        const LinearRig linear = linearise(rig);
        return LoopPolynomials{linear.p, linear.q};
      },
      1024.0);
  result.virtual_dampings = axis_values(family, result.delay, 0.0, most_virtual_damping);
  const double given = description.rig.machine.virtual_damping;
  for (const AxisValue& value : result.virtual_dampings) {
    if (!value.border) continue;
    if (!result.critical_damping || std::abs(value.value - given) < std::abs(result.critical_damping->value - given)) {
      result.critical_damping = value;
    }
  }

  const double critical = result.margins.critical_delay.value_or(0.0);
  const double critical_omega = result.margins.critical_delay ? result.margins.critical_omega : 0.0;
  result.critical_root = result.roots.rightmost();
  if (result.margins.critical_delay) {
    const auto followed = critical_root(result.rig.equation(critical), critical_omega, result.delay, result.roots.line);
    result.critical_root = followed.value_or(result.critical_root);
  }
  result.parameters =
      sensitivities(description.rig, extra, result.roots.rightmost(), result.critical_root, critical, critical_omega);
  std::stable_sort(result.parameters.begin(), result.parameters.end(), [](const auto& a, const auto& b) {
    return std::abs(a.critical_root_change.real()) > std::abs(b.critical_root_change.real());
  });

  // In the sampled loop all delays sit in the machine path, where they commute with everything linear.
  std::optional<ContinuousBorder> border;
  if (result.margins.critical_delay) border = ContinuousBorder{critical - result.rig.sensor_delay, critical_omega};
  try {
    result.sampled = sampled_loop(sampled_part(description.rig), description.period(),
                                  result.delay - result.rig.sensor_delay, border);
  } catch (const UnfitLoop&) {
    result.sampled.reset();
  }
  add_sampled(result, description, family);
  result.balance = balance_of(result, description);
  if (const auto& v = description.rig.delay_variation; v.any()) {
    result.varying = varying_delay(equation, result.margins, std::max(0.0, result.delay - v.farthest()),
                                   result.delay + v.farthest());
  }
  return result;
} catch (const UnfitLoop& unfit) {
  throw firmware::InputError(description.source, 0, unfit.what(), "a hil rig with a loop of less than 1 s of delay");
}

/// Whether `a` is nearer to its border than `b`.
bool worse(const StabilityAnalysis& a, const StabilityAnalysis& b) {
  const bool a_stable = a.stable_as_run() && a.stable_over_delays(),
             b_stable = b.stable_as_run() && b.stable_over_delays();
  if (a_stable != b_stable) return !a_stable;
  return a.delay_left && (!b.delay_left || *a.delay_left < *b.delay_left);
}

}  // namespace

StabilityAnalysis analyse(const firmware::RigDescription& description, double line) {
  const std::vector<SideOfRest> sides = sides_of_rest(description.rig);
  if (sides.size() == 1) return analyse_smooth(description, line);
  std::optional<StabilityAnalysis> worst;
  std::vector<FoundOnSide> found;
  for (const SideOfRest& side : sides) {
    firmware::RigDescription one = description;
    one.rig = side.rig;
    StabilityAnalysis result = analyse_smooth(one, line);
    result.side = side.name;
    found.push_back({side.name, result.stable_as_run() && result.stable_over_delays(), result.delay_left});
    if (!worst || worse(result, *worst)) worst = std::move(result);
  }
  worst->sides = std::move(found);
  return *std::move(worst);
}

}  // namespace host_sim::stability
