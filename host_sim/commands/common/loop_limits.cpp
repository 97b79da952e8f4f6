#include "host_sim/commands/common/loop_limits.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/compensation/compensated_stability.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/report/verdict.hpp"

namespace host_sim {
namespace {

constexpr double share_of_border = 0.8;
constexpr double longest_allowed = 0.5;  ///< what a description may say [s]
constexpr double allowed_step = 1e-6;    ///< rounded down to [s]

[[noreturn]] void refuse_limits(const firmware::RigDescription& description, const std::string& wrong,
                                const std::string& expected) {
  throw firmware::InputError(description.source, 0, wrong, expected + "; nothing was written");
}

/// What a loop without compensation leaves [s]; none: no border.
std::optional<double> left_for_samples(const firmware::RigDescription& with, const std::string& ducts) {
  const stability::StabilityAnalysis a = stability::analyse(with);
  if (!a.stable_as_run() || !a.stable_over_delays()) {
    refuse_limits(with, "the loop" + ducts + " is " + stability::verdict(a), "a stable loop");
  }
  const double longest =
      a.delay - with.delay_budget.sensor_age - with.delay_budget.computation + with.rig.delay_variation.farthest();
  std::optional<double> border;
  if (a.sampled) border = a.sampled->critical_delay;
  if (!border && a.margins.critical_delay) border = *a.margins.critical_delay - 0.5 * with.period();
  if (!border) return std::nullopt;
  return *border - longest;
}

constexpr double scanned = 0.030;           ///< delay of samples and computation up to which a border is looked for [s]
constexpr double scan_step = 0.25;          ///< [periods]
constexpr double border_resolution = 1e-7;  ///< [s]

/// The same for a loop with compensation. `outside`: delays that neither the machine nor samples and computation have.
std::optional<double> left_with_compensation(const firmware::RigDescription& with, const std::string& ducts) {
  const auto& budget = with.delay_budget;
  const double varies = with.rig.delay_variation.farthest();
  const auto refuse_unstable = [&](double delay_outside, const std::string& when) {
    const auto unstable = compensation::compensated_stability(with, delay_outside);
    refuse_limits(
        with,
        "the loop with compensation " + std::string(name(unstable.kind)) + ducts + when + " is " + in_words(unstable),
        "a stable loop");
  };
  const auto stable = [&](double outside) { return compensation::compensated_radius(with, outside) < 1.0; };
  if (!stable(budget.sum())) refuse_unstable(budget.sum(), "");
  const double first = budget.transport - varies, longest = budget.transport + varies;
  if (!stable(first)) refuse_unstable(first, ", at the shortest delay of samples, computation and machine,");
  double last_stable = first;
  const double step = scan_step * with.period();
  while (last_stable < longest + scanned) {
    double unstable = last_stable + step;
    if (stable(unstable)) {
      last_stable = unstable;
      continue;
    }
    while (unstable - last_stable > border_resolution) {
      const double middle = 0.5 * (last_stable + unstable);
      (stable(middle) ? last_stable : unstable) = middle;
    }
    if (last_stable < std::max(longest, budget.sum() + varies)) {
      refuse_unstable(std::max(longest, budget.sum() + varies), ", at the longest delay of its range,");
    }
    return last_stable - longest;
  }
  return scanned;
}

}  // namespace

double allowed_delay(const firmware::RigDescription& description) {
  double allowed = longest_allowed;
  for (const int open : compensation::duct_counts(description)) {
    firmware::RigDescription with = description;
    with.rig.fdva.open_ducts = open;
    const std::string ducts = with.rig.has_fdva ? " with " + std::to_string(open) + " open ducts" : "";
    const auto left = with.compensation ? left_with_compensation(with, ducts) : left_for_samples(with, ducts);
    if (left) allowed = std::min(allowed, share_of_border * *left);
  }
  allowed = std::floor(allowed / allowed_step + 1e-9) / 1e6;
  if (!(allowed > 0.0)) {
    refuse_limits(description, "the described delays leave nothing for samples and computation",
                  "less delay or more damping");
  }
  return allowed;
}

namespace {

/// The description with a constant delay: `outside` for samples, transport and computation, the machine's mean.
firmware::RigDescription at_constant_delay(firmware::RigDescription description, double outside) {
  description.delay_budget = {.sensor_age = outside, .transport = 0.0, .computation = 0.0};
  description.rig.delay_variation = {};
  return description;
}

/// The border of the gain at each of these delays outside the machine; none: no border.
std::optional<double> gain_border(const firmware::RigDescription& with, const std::set<double>& delays) {
  std::optional<double> border;
  for (const double outside : delays) {
    std::optional<double> gain;
    if (with.compensation) {
      gain = compensation::compensated_stability(with, outside).upper_gain;
    } else {
      const stability::StabilityAnalysis a = stability::analyse(at_constant_delay(with, outside));
      const auto& margin = a.sampled_margins ? a.sampled_margins->upper_gain : a.margins.upper_gain;
      if (margin) gain = margin->factor;
    }
    if (gain && (!border || *gain < *border)) border = gain;
  }
  return border;
}

}  // namespace

double allowed_gain(const firmware::RigDescription& description, double allowed_delay) {
  constexpr double most = 100.0, allowed_gain_step = 1e-3;  // rounded down to
  const auto& budget = description.delay_budget;
  const double varies = description.rig.delay_variation.farthest();
  const double longest = budget.transport + varies + allowed_delay;
  std::set<double> delays{budget.sum(), longest};
  if (description.compensation) delays.insert(budget.transport - varies);  // it may lead by too much there
  double allowed = most;
  for (const int open : compensation::duct_counts(description)) {
    firmware::RigDescription with = description;
    with.rig.fdva.open_ducts = open;
    const auto border = gain_border(with, delays);
    if (border) allowed = std::min(allowed, 1.0 + share_of_border * (*border - 1.0));
  }
  allowed = std::floor(allowed / allowed_gain_step + 1e-9) * allowed_gain_step;
  if (!(allowed > 1.0)) {
    refuse_limits(description, "the loop bears no more force than described", "less delay or more damping");
  }
  return std::round(allowed * 1e3) / 1e3;
}

}  // namespace host_sim
