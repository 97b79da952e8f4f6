#include "host_sim/diagnose/candidates.hpp"

#include <algorithm>
#include <cmath>

namespace host_sim::diagnose {
namespace {

using model::Channel;
using Starts = std::vector<Start>;

struct Size {
  double rms = 0.0, peak = 0.0;
};

Size size_of(const std::vector<double>& values) {
  Size size;
  double mean = 0.0;
  for (const double v : values) mean += v;
  mean /= static_cast<double>(std::max<std::size_t>(values.size(), 1));
  for (const double v : values) {
    size.rms += (v - mean) * (v - mean);
    size.peak = std::max(size.peak, std::abs(v));
  }
  size.rms = std::sqrt(size.rms / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
  return size;
}

Starts times(double unit, std::initializer_list<double> factors) {
  Starts starts;
  for (const double factor : factors) starts.push_back({{factor * unit}});
  return starts;
}

Starts product(const Starts& first, const Starts& second) {
  Starts starts;
  for (const auto& a : first) {
    for (const auto& b : second) starts.push_back({{a.values[0], b.values[0]}});
  }
  return starts;
}

/// The value at which a channel is cut off: its extreme, where that is repeated exactly.
std::optional<double> repeated_extreme(const std::vector<double>& data) {
  double highest = 0.0;
  for (const double v : data) highest = std::max(highest, std::abs(v));
  const auto count =
      std::count_if(data.begin(), data.end(), [&](double v) { return std::abs(v) >= highest * (1.0 - 1e-9); });
  if (count < 4 || highest == 0.0) return std::nullopt;
  return highest;
}

Starts sensor_starts(std::string_view name, const Case& all, Channel channel, const Scales& scales) {
  const auto c = index(channel);
  const double size = scales.rms[c];
  if (name == "sensor_lag" || name == "sensor_delay") return times(1e-3, {0.3, 1.0, 3.0, 10.0, 30.0});
  if (name == "sensor_gain") return {{{1.02}}, {{0.98}}};
  if (name == "sensor_offset") return {{{0.05 * size}}, {{-0.05 * size}}};
  if (name == "sensor_saturation") {
    Starts starts;
    for (const Evidence& e : all.evidence) {
      if (!e.recording.has(channel)) continue;
      if (const auto limit = repeated_extreme(e.recording[channel])) starts.push_back({{*limit}});
    }
    return starts;  // a limit shows by an extreme that is repeated, or it is not there
  }
  Starts starts;
  if (const auto held = hold_period(all.evidence, channel)) {
    starts.push_back({{held->value}});
    const bool regular = std::all_of(all.evidence.begin(), all.evidence.end(), [channel](const Evidence& e) {
      const auto& renewals = e.renewals[index(channel)];
      return !renewals || renewals->regular;
    });
    // By a clock of its own; where between two samples its values are taken the search finds.
    if (regular) starts.push_back({{held->value}, {true, 0.0}});
  }
  return starts;  // a hold shows by repeated values, or it is not there
}

Starts starts_of(const CatalogueEntry& entry, const Scales& s) {
  const std::string_view name = entry.name;
  const double stiffness = s.force / std::max(s.deflection, 1e-12), damping = s.force / std::max(s.velocity, 1e-12);
  const auto forces = [&] { return times(s.force, {0.01, 0.03, 0.1, 0.3}); };
  if (name == "actuator_delay" || name == "actuator_lag") return times(1e-3, {0.3, 1.0, 3.0, 10.0, 30.0});
  if (name == "actuator_resonance") return product(times(1.0, {6.0, 12.0, 25.0, 50.0}), times(1.0, {0.1, 0.4, 0.8}));
  if (name == "actuator_rate_limit") return times(s.velocity_peak, {0.9, 0.7, 0.5, 0.3});
  if (name == "coulomb_friction" || name == "seal_friction") return forces();
  if (name == "body_guide_friction" || name == "wheel_guide_friction") return forces();
  if (name == "viscous_damping") return times(damping, {0.01, 0.1});
  if (name == "body_guide_damping" || name == "wheel_guide_damping") return times(damping, {0.01, 0.1});
  if (name == "quadratic_damping") return times(damping / std::max(s.velocity, 1e-12), {0.03, 0.3});
  if (name == "progressive_spring") return times(stiffness / (s.deflection * s.deflection), {0.03, -0.03});
  if (name == "progressive_tyre") {
    return times(s.tyre_force / std::pow(std::max(s.tyre_deflection, 1e-12), 3), {0.03, -0.03});
  }
  if (name == "bump_stop")
    return product(times(s.deflection_peak, {0.3, 0.5, 0.7, 0.85}), times(stiffness, {0.3, 3.0}));
  if (name == "backlash") return times(s.deflection, {0.03, 0.1, 0.3, 1.0});
  if (name == "top_mount") return times(stiffness, {3.0, 10.0, 30.0, 100.0});
  if (name == "relaxation") return product(times(stiffness, {0.05, 0.3}), times(1e-3, {2.0, 10.0, 50.0, 250.0}));
  if (name == "force_sensor_inertia") {
    return times(s.tyre_force / std::max(s.foot_acceleration, 1e-12), {0.01, 0.1});
  }
  if (name == "tyre_lift_off") return {{{}}};
  // An effect that is new in the catalogue: the middle of its bounds.
  std::vector<double> middle;
  for (const model::EffectParameter& p : entry.parameters) {
    middle.push_back(p.lower > 0.0 ? std::sqrt(p.lower * p.upper) : 1e-3 * p.upper);
  }
  return {{middle}};
}

}  // namespace

Scales scales_of(const Case& all, const Hypothesis& hypothesis, const std::vector<Response>& responses) {
  Scales s;
  const auto enlarge = [](double& to, double value) { to = std::max(to, value); };
  for (std::size_t r = 0; r < all.evidence.size(); ++r) {
    const Evidence& e = all.evidence[r];
    for (const Channel channel : e.channels) {
      const Size size = size_of(e.recording[channel]);
      enlarge(s.rms[index(channel)], size.rms);
      enlarge(s.peak[index(channel)], size.peak);
    }
    const bool bench = hypothesis.rig.kind == model::RigKind::component_bench;
    std::vector<double> deflection;
    if (bench) {
      for (const auto& m : e.drive.motion) deflection.push_back(m.position);
    } else {
      deflection = responses[r][index(Channel::dz_b)];
      enlarge(s.tyre_force, size_of(responses[r][index(Channel::F_w)]).rms);
      enlarge(s.tyre_deflection, size_of(responses[r][index(Channel::dz_w)]).rms);
      double squares = 0.0;
      for (const auto& m : e.drive.motion) squares += m.acceleration * m.acceleration;
      enlarge(s.foot_acceleration, std::sqrt(squares / static_cast<double>(e.drive.size())));
    }
    std::vector<double> velocity(deflection.size());
    for (std::size_t k = 1; k < deflection.size(); ++k)
      velocity[k] = (deflection[k] - deflection[k - 1]) / e.drive.period;
    const Size d = size_of(deflection), v = size_of(velocity);
    enlarge(s.deflection, d.rms);
    enlarge(s.deflection_peak, d.peak);
    enlarge(s.velocity, v.rms);
    enlarge(s.velocity_peak, v.peak);
    if (bench) {
      enlarge(s.force, size_of(responses[r][index(Channel::F)]).rms);
    } else {
      enlarge(s.force, hypothesis.rig.body.mass * size_of(responses[r][index(Channel::zdd_b)]).rms);
    }
  }
  return s;
}

std::vector<Candidate> candidates(const Case& all, const Hypothesis& hypothesis, const Scales& scales) {
  const auto present = effects_of(hypothesis.rig);
  const auto is_present = [&](const CatalogueEntry& entry, std::optional<Channel> channel) {
    return std::any_of(present.begin(), present.end(),
                       [&](const PlacedEffect& p) { return p.entry == &entry && p.channel == channel; });
  };
  const Evidence& first = all.evidence.front();
  std::vector<Candidate> list;
  for (const CatalogueEntry& entry : catalogue()) {
    if (entry.of_channel) {
      for (const Channel channel : first.channels) {
        if (!has_place(hypothesis.rig, entry, channel) || is_present(entry, channel)) continue;
        Starts starts = sensor_starts(entry.name, all, channel, scales);
        if (!starts.empty()) list.push_back({&entry, channel, std::move(starts)});
      }
      continue;
    }
    if (!has_place(hypothesis.rig, entry, std::nullopt) || is_present(entry, std::nullopt)) continue;
    if (entry.place == model::Place::machine && first.drive.deflection_reached) continue;
    list.push_back({&entry, std::nullopt, starts_of(entry, scales)});
  }
  return list;
}

}  // namespace host_sim::diagnose
