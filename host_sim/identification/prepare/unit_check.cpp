#include "host_sim/identification/prepare/unit_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/prepare/driving_input.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"
#include "host_sim/identification/prepare/recording_window.hpp"
#include "host_sim/identification/prepare/sampled_recording.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
using model::RigKind;

constexpr double gravity = 9.81;

/// How a unit is called, and how many of it an SI unit is.
struct Unit {
  double per_si;
  const char* name;
};

std::span<const Unit> units_of(Channel channel) {
  static constexpr std::array<Unit, 4> lengths{
      {{1e3, "millimetres"}, {1e2, "centimetres"}, {1e6, "micrometres"}, {1e-3, "kilometres"}}};
  static constexpr std::array<Unit, 3> accelerations{
      {{1.0 / gravity, "multiples of g"}, {1e3, "mm/s²"}, {1e-3, "km/s²"}}};
  static constexpr std::array<Unit, 2> forces{{{1e-3, "kilonewtons"}, {1e3, "millinewtons"}}};
  if (model::unit(channel) == "N") return forces;
  if (model::unit(channel) == "m") return lengths;
  return accelerations;
}

/// Whether a channel that is so many times its simulation counts as right.
bool is_right(double factor) {
  return factor > thresholds::lowest_right_factor && factor < thresholds::highest_right_factor;
}

/// The unit's or sign's factor nearest to one that was found; 1: none is near.
double nominal(Channel channel, double factor) {
  const double size = std::abs(factor), sign = factor < 0.0 ? -1.0 : 1.0;
  for (const Unit& unit : units_of(channel)) {
    if (std::abs(std::log(size / unit.per_si)) < thresholds::unit_factor_distance) return sign * unit.per_si;
  }
  return sign < 0.0 && is_right(size) ? -1.0 : 1.0;
}

struct Likeness {
  double factor = 0.0, correlation = 0.0;  // squared
};

/// measured ≈ factor × expected, means left out.
Likeness likeness(std::span<const double> measured, std::span<const double> expected) {
  double mean_m = 0.0, mean_e = 0.0, mm = 0.0, ee = 0.0, me = 0.0;
  const auto n = static_cast<double>(measured.size());
  for (std::size_t k = 0; k < measured.size(); ++k) {
    mean_m += measured[k] / n;
    mean_e += expected[k] / n;
  }
  for (std::size_t k = 0; k < measured.size(); ++k) {
    const double m = measured[k] - mean_m, e = expected[k] - mean_e;
    mm += m * m;
    ee += e * e;
    me += m * e;
  }
  if (!(mm > 0.0 && ee > 0.0 && std::isfinite(mm * ee))) return {};
  return {me / ee, me * me / (mm * ee)};
}

/// zdd_r against z_r [both as recorded], where both are.
Likeness acceleration_of_foot_point(const firmware::Recording& part) {
  const auto& z = part[Channel::z_r];
  const auto& a = part[Channel::zdd_r];
  const auto reach = static_cast<std::size_t>(std::lround(0.010 / part.sample_period));  // H
  if (z.empty() || a.empty() || reach == 0 || z.size() < 4 * reach) return {};
  std::vector<double> differences, means;
  const double h = part.sample_period * static_cast<double>(reach);
  for (std::size_t k = reach; k + reach < z.size(); k += reach) {
    differences.push_back((z[k + reach] - 2.0 * z[k] + z[k - reach]) / (h * h));
    double mean = 0.0, weights = 0.0;
    for (std::size_t i = 0; i <= 2 * reach; ++i) {
      const double weight = static_cast<double>(std::min(i, 2 * reach - i));
      mean += weight * a[k - reach + i];
      weights += weight;
    }
    means.push_back(mean / weights);
  }
  return likeness(means, differences);
}

/// Each channel compared with its simulation, when the recorded input is `factor` times SI.
using Likenesses = std::array<Likeness, model::channel_count>;
Likenesses likenesses(const model::RigParameters<double>& rig, firmware::Recording part, Channel input, double factor) {
  for (double& v : part[input]) v /= factor;
  Likenesses result;
  result[index(Channel::zdd_r)] = acceleration_of_foot_point(part);
  const SimulationInput simulated = driving_input(rig, part);
  const Response response = simulate(rig, simulated, resting(rig, simulated));
  const auto from = static_cast<std::size_t>(thresholds::unit_check_settling / part.sample_period);
  for (const Channel channel : response_channels(rig.kind, simulated)) {
    if (!part.has(channel)) continue;
    result[index(channel)] =
        likeness(std::span(part[channel]).subspan(from), std::span(response[index(channel)]).subspan(from));
  }
  return result;
}

/// How many channels follow their simulation with the right unit and sign.
int right_ones(const Likenesses& all) {
  int count = 0;
  for (std::size_t c = 0; c < all.size(); ++c) {
    const Likeness& one = all[c];
    if (one.correlation > thresholds::unit_check_correlation && is_right(one.factor)) ++count;
  }
  return count;
}

void add_unit_errors(const model::RigParameters<double>& rig, const firmware::Recording& part,
                     std::vector<UnitError>& found) {
  const auto known = [&](Channel channel) {
    return std::any_of(found.begin(), found.end(), [&](const UnitError& s) { return s.channel == channel; });
  };
  const Channel input = driving_input(rig, part).channel;
  Likenesses best = likenesses(rig, part, input, 1.0);
  double input_factor = 1.0;
  if (!known(input)) {
    std::vector<double> factors{-1.0};
    for (const Unit& unit : units_of(input)) {
      factors.push_back(unit.per_si);
      factors.push_back(-unit.per_si);
    }
    for (const double factor : factors) {
      const Likenesses other = likenesses(rig, part, input, factor);
      // One channel against another cannot say which of the two is wrong: the input is believed.
      if (right_ones(other) <= std::max(right_ones(best), 1)) continue;
      best = other;
      input_factor = factor;
    }
  }
  const std::size_t known_before = found.size();
  if (input_factor != 1.0) found.push_back({input, input_factor});
  bool description_fits = true;
  for (std::size_t c = 0; c < best.size(); ++c) {
    const Channel channel = model::channel_at(c);
    if (!(best[c].correlation > thresholds::unit_check_correlation) || known(channel)) continue;
    const double factor = nominal(channel, best[c].factor);
    description_fits = description_fits && (factor != 1.0 || is_right(best[c].factor));
    const bool exact = std::abs(std::log(best[c].factor / factor)) < thresholds::unit_factor_certain;
    if (factor != 1.0) found.push_back({channel, factor, factor < 0.0 || exact});
  }
  for (std::size_t i = known_before; i < found.size(); ++i) {
    found[i].certain = found[i].certain && (description_fits || found[i].factor < 0.0);
  }
}

std::string unit_error_text(const UnitError& slip) {
  std::string text(model::name(slip.channel));
  const char* unit = nullptr;
  for (const Unit& u : units_of(slip.channel)) {
    if (u.per_si == std::abs(slip.factor)) unit = u.name;
  }
  if (unit == nullptr) return text + " looks as if its sign were swapped";
  return text + " looks like " + unit + (slip.factor < 0.0 ? " with the sign swapped" : "");
}

}  // namespace

std::vector<UnitError> unit_errors(const firmware::RigDescription& description, const firmware::Recording& recording) {
  const auto n = static_cast<std::size_t>(thresholds::unit_check_length / recording.sample_period);
  const std::size_t count = std::min(recording.size(), n), from = (recording.size() - count) / 2;
  std::vector<UnitError> found;
  if (static_cast<double>(count) * recording.sample_period <= thresholds::unit_check_settling) return found;
  firmware::Recording part = at_simulated_rate(cut(recording, {from, from + count}));
  tare(static_values(description.rig, part), part);
  add_unit_errors(explained_part(description.rig), part, found);
  if (description.rig.kind == RigKind::hil) add_unit_errors(description.rig, part, found);
  return found;
}

std::vector<std::string> check_units(const firmware::RigDescription& description,
                                     const firmware::Recording& recording) {
  std::vector<std::string> remarks;
  std::string wrong, entries;
  for (const UnitError& slip : unit_errors(description, recording)) {
    const std::string channel(model::name(slip.channel));
    const auto entry = description.channels.find(channel);
    const firmware::ColumnSource source =
        entry == description.channels.end() ? firmware::ColumnSource{channel} : entry->second;
    if (source.scale) {
      remarks.push_back(recording.source + ": " + unit_error_text(slip) + "; kept as [channels] says");
      continue;
    }
    if (!slip.certain) {
      remarks.push_back(recording.source + ": " + unit_error_text(slip) + ", or the rig description is far off");
      continue;
    }
    char scale[32];
    std::snprintf(scale, sizeof scale, "%.4g", 1.0 / slip.factor);
    wrong += (wrong.empty() ? "" : "; ") + unit_error_text(slip);
    entries += (entries.empty() ? "" : " and ") + channel + " = { column = \"" + source.column +
               "\", scale = " + scale + (source.offset == 0.0 ? "" : ", offset = …") + " }";
  }
  if (wrong.empty()) return remarks;
  throw firmware::InputError(recording.source, 0, wrong,
                             "SI units and the signs that rigtwin channels lists, or in the rig description under "
                             "[channels]: " +
                                 entries + "; a scale that is written there is kept");
}

}  // namespace host_sim::identification
