#include "host_sim/diagnose/hypothesis.hpp"

#include <algorithm>
#include <cmath>

namespace host_sim::diagnose {

double Unknown::value(double u) const { return logarithmic ? scale * std::exp(u) : centre + scale * u; }

double Unknown::coordinate(double v) const {
  return logarithmic ? std::log(std::max(v, 1e-300) / scale) : (v - centre) / scale;
}

void Unknown::put(Hypothesis& hypothesis, double u) const {
  if (role == Role::start) {
    hypothesis.starts[recording](state) = value(u);
  } else if (double* const parameter = find_parameter(hypothesis.rig, path)) {
    *parameter = value(u);
  }
}

double Unknown::get(const Hypothesis& hypothesis) const {
  if (role == Role::start) return coordinate(hypothesis.starts[recording](state));
  model::RigParameters<double> rig = hypothesis.rig;
  const double* const parameter = find_parameter(rig, path);
  return parameter != nullptr ? coordinate(*parameter) : 0.0;
}

bool Unknown::at_bound(const Hypothesis& hypothesis) const {
  const double u = get(hypothesis);
  return u <= lower + 1e-9 || u >= upper - 1e-9;
}

double Unknown::reach(double u) const {
  if (role == Role::start) return 3.0;
  if (role == Role::tolerated || (sensor && !logarithmic)) return INFINITY;
  return logarithmic ? 1.0 : std::max(1.0, std::abs(u));
}

Unknown::Room Unknown::room(double u, double trust) const {
  const double far = trust * reach(u);
  return {std::max(std::min(lower - u, 0.0), -far), std::min(std::max(upper - u, 0.0), far)};
}

std::vector<Unknown> tolerated_unknowns(const RigDescription& description) {
  std::vector<Unknown> unknowns;
  model::RigParameters<double> part = explained_part(description.rig);
  for (const auto& [path, bound] : description.tolerance) {
    const double* const value = find_parameter(part, path);
    if (value == nullptr || !(bound > 0.0) || *value == 0.0) continue;
    if (part.kind == model::RigKind::component_bench &&
        (path.starts_with("body") || path.starts_with("wheel") || path.starts_with("tyre"))) {
      continue;  // of a car that is a number
    }
    Unknown u{Unknown::Role::tolerated, path, 0, 0, {}, *value, *value * bound, false, -1.0, 1.0, 1e-2};
    if (bound >= 1.0) u.lower = -0.999 / bound;  // parameters do not change their sign
    unknowns.push_back(u);
  }
  return unknowns;
}

std::vector<Unknown> start_unknowns(const RigDescription& description, const std::vector<Evidence>& evidence) {
  std::vector<Unknown> unknowns;
  const model::RigParameters<double> rig = explained_part(description.rig);
  for (std::size_t r = 0; r < evidence.size(); ++r) {
    if (evidence[r].at_rest || evidence[r].fit.size() == 0) continue;
    double size = 0.0;
    for (const auto& m : evidence[r].drive.motion) size = std::max(size, std::abs(m.position));
    size = std::max(size, 1e-6);
    for (int state = 0; state < 6; ++state) {
      if (state < 4 && rig.kind == model::RigKind::component_bench) continue;
      if (state >= 4 && !(rig.has_fdva && rig.fdva.open_ducts > 0)) continue;
      const double scale = size * (state % 2 == 1 ? 20.0 : 1.0);
      unknowns.push_back({Unknown::Role::start, "", r, state, {}, 0.0, scale, false, -10.0, 10.0, 1e-3});
    }
  }
  return unknowns;
}

std::vector<Unknown> effect_unknowns(const PlacedEffect& effect) {
  std::vector<Unknown> unknowns;
  if (is_hold(*effect.entry)) return unknowns;
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const model::EffectParameter& card = effect.entry->parameters[i];
    const bool is_gain = effect.entry->name == "sensor_gain";
    Unknown u{Unknown::Role::effect, effect_path(effect, i), 0, 0, effect.channel, 0.0, 0.0, false, 0.0, 0.0, 1e-3};
    if (card.lower < 0.0 || is_gain) {
      u.centre = is_gain ? 1.0 : 0.0;
      u.scale = std::max(std::abs(effect.values[i] - u.centre), 1e-12);
      u.lower = std::max((card.lower - u.centre) / u.scale, -1e6);
      u.upper = std::min((card.upper - u.centre) / u.scale, 1e6);
    } else {
      u.logarithmic = true;
      u.scale = std::max(effect.values[i], 1e-12);
      u.lower = card.lower > 0.0 ? std::log(card.lower / u.scale) : -12.0;
      u.upper = std::log(card.upper / u.scale);
    }
    unknowns.push_back(u);
  }
  return unknowns;
}

}  // namespace host_sim::diagnose
