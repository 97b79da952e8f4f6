#include "host_sim/commands/loop_limits.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <set>
#include <string>

#include "firmware/description/text/input_error.hpp"
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
  const bool varies_out = a.varying && !a.varying->stable;
  if (!a.stable || varies_out || (a.sampled && !a.sampled->stable())) {
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

}  // namespace

double allowed_delay(const firmware::RigDescription& description) {
  std::set<int> counts{description.rig.fdva.open_ducts};
  for (const auto& entry : description.controller.valve_plan)
    counts.insert(std::popcount(static_cast<unsigned>(entry.open)));
  double allowed = longest_allowed;
  for (const int open : counts) {
    firmware::RigDescription with = description;
    with.rig.fdva.open_ducts = open;
    const std::string ducts = with.rig.has_fdva ? " with " + std::to_string(open) + " open ducts" : "";
    const auto left = left_for_samples(with, ducts);
    if (left) allowed = std::min(allowed, share_of_border * *left);
  }
  allowed = std::floor(allowed / allowed_step + 1e-9) / 1e6;
  if (!(allowed > 0.0)) {
    refuse_limits(description, "the described delays leave nothing for samples and computation",
                  "less delay or more damping");
  }
  return allowed;
}

}  // namespace host_sim
