#include "host_sim/compensation/compensated_stability.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "host_sim/compensation/arrived_series.hpp"
#include "host_sim/report/formatted.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/roots/eigenvalues.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "host_sim/stability/roots/sides_of_rest.hpp"

namespace host_sim::compensation {
namespace {

constexpr std::size_t most_roots = 12;
constexpr double widest_gain = 100.0;
constexpr double gain_step = 1.1;  ///< of the search for a border of the gain, then bisected
constexpr int gain_bisections = 40;
constexpr std::size_t assumed_points = 21, actual_points = 31;  ///< of the map

/// The coefficients that a time series begins with, as they stand.
Settings at_the_start(Settings settings) {
  if (settings.kind != Kind::adaptive_time_series) return settings;
  settings.given = settings.assumed();
  keep_within_bounds(settings);
  settings.gain = 1.0;
  settings.kind = Kind::inverse;
  return settings;
}

/// The linear rig with the delays outside its machine at its machine, where they commute with everything.
Rig late_rig(const firmware::RigDescription& description, double delay_outside) {
  return with_delay_change(stability::sampled_part(description.rig), delay_outside);
}

/// Of `loop`, that of `rig` with `settings`, and of the same with the coefficients that a time series begins with.
double larger_radius(const CompensatedLoop& loop, const Rig& rig, const Settings& settings) {
  double radius = loop.spectral_radius();
  if (settings.kind == Kind::adaptive_time_series) {
    const Settings start = at_the_start(settings);
    radius = std::max(radius, compensated_loop(rig, loop.period, &start).spectral_radius());
  }
  return radius;
}

std::vector<Complex> roots_of(const CompensatedLoop& loop) {
  std::vector<Complex> roots;
  for (const Complex& value : stability::eigenvalues(loop.a)) {
    if (value.imag() >= 0.0 && std::abs(value) > 1e-6) roots.push_back(std::log(value) / loop.period);
  }
  std::sort(roots.begin(), roots.end(), [](Complex a, Complex b) { return a.real() > b.real(); });
  if (roots.size() > most_roots) roots.resize(most_roots);
  return roots;
}

/// The factor of the measured force, searched from 1 by factors of `step`, at which stability ends.
std::optional<double> gain_border(const Rig& rig, double period, const Settings& settings, double step) {
  const auto stable_with = [&](double factor) {
    return compensated_loop(rig, period, &settings, factor).spectral_radius() < 1.0;
  };
  double stable = 1.0;
  for (;;) {
    double unstable = stable * step;
    if (unstable > widest_gain || unstable < 1.0 / widest_gain) return std::nullopt;
    if (stable_with(unstable)) {
      stable = unstable;
      continue;
    }
    for (int i = 0; i < gain_bisections; ++i) {
      const double middle = std::sqrt(stable * unstable);
      (stable_with(middle) ? stable : unstable) = middle;
    }
    return std::sqrt(stable * unstable);
  }
}

/// The description with another assumed delay; coefficients that were given do not say what they assume.
firmware::RigDescription assuming(const firmware::RigDescription& description, double delay) {
  firmware::RigDescription other = description;
  other.compensation->numbers["delay"] = delay;
  other.compensation->lists.erase("coefficients");
  return other;
}

}  // namespace

std::set<int> duct_counts(const firmware::RigDescription& description) {
  std::set<int> counts{description.rig.fdva.open_ducts};
  for (const auto& entry : description.controller.valve_plan) {
    counts.insert(std::popcount(static_cast<unsigned>(entry.open)));
  }
  return counts;
}

namespace {

CompensatedStability smooth_stability(const firmware::RigDescription& description, double delay_outside) {
  CompensatedStability result;
  const double period = description.period();
  result.settings = *firmware::compensation_settings(description);
  result.kind = result.settings.kind;
  result.assumed_delay = result.settings.delay();
  const Rig rig = late_rig(description, delay_outside);
  result.delay = machine_delay(rig);
  result.pure_delay = pure_delay(rig);
  const CompensatedLoop loop = compensated_loop(rig, period, &result.settings);
  result.spectral_radius = larger_radius(loop, rig, result.settings);
  result.stable = result.spectral_radius < 1.0;
  result.roots = roots_of(loop);
  result.mismatch = delay_mismatch(rig, period, &result.settings);
  if (result.stable) {
    result.upper_gain = gain_border(rig, period, result.settings, gain_step);
    result.lower_gain = gain_border(rig, period, result.settings, 1.0 / gain_step);
  }
  return result;
}

/// The description as it is on each side of a rest that is a kink.
std::vector<firmware::RigDescription> sides_of(const firmware::RigDescription& description) {
  std::vector<firmware::RigDescription> sides;
  for (const stability::SideOfRest& side : stability::sides_of_rest(description.rig)) {
    sides.push_back(description);
    sides.back().rig = side.rig;
  }
  return sides;
}

}  // namespace

CompensatedStability compensated_stability(const firmware::RigDescription& description, double delay_outside) {
  std::optional<CompensatedStability> worst;
  for (const firmware::RigDescription& side : sides_of(description)) {
    CompensatedStability found = smooth_stability(side, delay_outside);
    if (!worst || found.spectral_radius > worst->spectral_radius) worst = std::move(found);
  }
  return *std::move(worst);
}

std::string in_words(const CompensatedStability& s) {
  if (s.stable) {
    const auto side = [](const std::optional<double>& change, const char* word) {
      return change ? formatted("%.3g ms %s", 1e3 * std::abs(*change), word) : formatted("any amount %s", word);
    };
    return "stable; the machine's delay may be " + side(s.mismatch.later, "longer") + " or " +
           side(s.mismatch.earlier, "shorter") + " than described";
  }
  std::string text = "unstable";
  if (!s.roots.empty() && s.roots.front().real() > 0.0) {
    text += formatted(" at %.3g Hz, doubling every %.3g s", s.roots.front().imag() / full_turn,
                      std::numbers::ln2 / s.roots.front().real());
  } else if (s.kind == Kind::adaptive_time_series) {
    text += " with the coefficients that it begins with";
  }
  text += formatted(" (spectral radius %.5g)", s.spectral_radius);
  if (s.mismatch.nearest_stable) {
    text += formatted(", stable with a machine that is %.3g ms %s", 1e3 * std::abs(*s.mismatch.nearest_stable),
                      *s.mismatch.nearest_stable < 0.0 ? "earlier" : "later");
  } else {
    text += ", stable with no delay of the machine that was tried";
  }
  return text;
}

double compensated_radius(const firmware::RigDescription& description, double delay_outside) {
  double radius = 0.0;
  for (const firmware::RigDescription& side : sides_of(description)) {
    const Rig rig = late_rig(side, delay_outside);
    const Settings settings = *firmware::compensation_settings(side);
    radius = std::max(radius, larger_radius(compensated_loop(rig, side.period(), &settings), rig, settings));
  }
  return radius;
}

void refuse_unstable_compensation(const firmware::RigDescription& description) {
  if (!description.compensation) return;
  for (const int open : duct_counts(description)) {
    firmware::RigDescription with = description;
    with.rig.fdva.open_ducts = open;
    if (compensated_radius(with, 0.0) < 1.0) continue;
    const CompensatedStability unstable = compensated_stability(with, 0.0);
    const std::string ducts = with.rig.has_fdva ? " and " + std::to_string(open) + " open ducts" : "";
    throw firmware::InputError(
        description.source, description.line_of("compensation"),
        "the loop with compensation " + std::string(name(unstable.kind)) + ducts + " is " + in_words(unstable),
        "a compensation that fits the machine: " +
            formatted("it assumes %.4g ms of %.4g ms of delay", 1e3 * unstable.assumed_delay, 1e3 * unstable.delay));
  }
}

MismatchMap mismatch_map(const firmware::RigDescription& description, double delay_outside,
                         const std::function<void(double)>& progress) {
  MismatchMap map;
  const double period = description.period();
  const Rig rig = stability::sampled_part(description.rig);
  const Settings described = *firmware::compensation_settings(description);
  const double described_delay = pure_delay(rig) + delay_outside;
  const double farthest = 2.0 * std::max({described.machine.delay, described_delay, period});
  const double reach = 250.0 * period / std::max(1, described.order);  // of the lines
  const double last = std::min(farthest, reach);
  for (std::size_t i = 0; i < assumed_points; ++i) {
    map.assumed.push_back(last * static_cast<double>(i) / (assumed_points - 1));
  }
  for (std::size_t i = 0; i < actual_points; ++i) {
    map.actual.push_back(last * static_cast<double>(i) / (actual_points - 1));
  }
  std::vector<Settings> settings;
  for (const double delay : map.assumed) {
    settings.push_back(firmware::compensation_settings(assuming(description, delay), described.kind));
  }
  const bool adapts = described.kind == Kind::adaptive_time_series;
  for (const double delay : map.actual) {
    const Rig at = with_delay_change(rig, delay - pure_delay(rig));
    std::optional<double> same;
    for (const Settings& s : settings) {
      const double growth =
          adapts && same ? *same : std::log(compensated_loop(at, period, &s).spectral_radius()) / period;
      same = growth;
      map.growth.push_back(growth);
    }
    if (progress) progress(static_cast<double>(map.growth.size()) / (assumed_points * actual_points));
  }
  return map;
}

}  // namespace host_sim::compensation
