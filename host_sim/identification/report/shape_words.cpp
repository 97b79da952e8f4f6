#include "host_sim/identification/report/shape_words.hpp"

#include <cmath>

#include "host_sim/report/report.hpp"

namespace host_sim::identification {

std::string shape_words(const firmware::PlacedEffect& effect, const model::RigParameters<double>& rig) {
  using report::figure_text;
  const std::string_view name = effect.entry->name;
  const std::vector<double>& v = effect.values;
  constexpr double milli = 1e3, per_cent = 100.0;
  if (name == "asymmetric_damper") {
    const double b = rig.suspension.damping, push = b + 0.5 * v[0], pull = b - 0.5 * v[0];
    if (!(push > 0.0)) return "";
    const double more = per_cent * (pull / push - 1.0);
    return "rebound " + figure_text(std::abs(more), 2) + " % " + (more > 0.0 ? "harder" : "softer") +
           " than compression";
  }
  if (name == "stribeck_friction") {
    return "breaks away at " + figure_text(v[0] * (1.0 + v[1]), 3) + " N, falls to " + figure_text(v[0], 3) + " N by " +
           figure_text(2.0 * milli * v[2], 2) + " mm/s (Stribeck)";
  }
  if (name == "position_ripple") {
    return "ripples every " + figure_text(milli * v[0], 3) + " mm by " + figure_text(std::hypot(v[1], v[2]), 2) +
           " N (cogging)";
  }
  if (name == "bouc_wen") return "hysteresis of " + figure_text(v[1], 3) + " N independent of frequency";
  if (name == "hardening_hysteresis") {
    return "hysteresis independent of frequency, twice as stiff under " + figure_text(v[1], 3) + " N";
  }
  if (name == "relaxation") return "relaxes within " + figure_text(milli * v[1], 2) + " ms";
  if (name == "bump_stop") return "stiffens from " + figure_text(milli * v[0], 3) + " mm on";
  if (name == "progressive_spring" || name == "progressive_tyre")
    return v[0] > 0.0 ? "stiffens with |x|^3" : "softens with |x|^3";
  if (name == "quadratic_damping") return "grows with |v|^2";
  if (name == "coulomb_friction") return "dry friction of " + figure_text(v[0], 3) + " N";
  return "";
}

}  // namespace host_sim::identification
