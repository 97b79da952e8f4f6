#include "host_sim/identification/estimate/free_parameter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/comparison/start_state.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"

namespace host_sim::identification {

double FreeParameter::value(double u) const { return logarithmic ? scale * std::exp(u) : centre + scale * u; }

double FreeParameter::coordinate(double v) const {
  return logarithmic ? std::log(std::max(v, 1e-300) / scale) : (v - centre) / scale;
}

void FreeParameter::put(Hypothesis& hypothesis, double u) const {
  if (role == Role::start) {
    hypothesis.starts[recording](state) = value(u);
  } else if (role == Role::fault) {
    hypothesis.faults[fault].values[number] = value(u);
  } else if (role == Role::law) {
    hypothesis.laws[law].value(number) = value(u);
    put_laws(hypothesis.laws, hypothesis.rig);
  } else if (double* const parameter = firmware::find_parameter(hypothesis.rig, path)) {
    *parameter = value(u);
  }
}

double FreeParameter::get(const Hypothesis& hypothesis) const {
  if (role == Role::start) return coordinate(hypothesis.starts[recording](state));
  if (role == Role::fault) return coordinate(hypothesis.faults[fault].values[number]);
  if (role == Role::law) return coordinate(hypothesis.laws[law].value(number));
  const double* const parameter = firmware::find_parameter(hypothesis.rig, path);
  return parameter != nullptr ? coordinate(*parameter) : 0.0;
}

bool FreeParameter::at_bound(const Hypothesis& hypothesis) const {
  const double u = get(hypothesis);
  return u <= lower + 1e-9 || u >= upper - 1e-9;
}

double FreeParameter::trust_radius(double u) const {
  if (role == Role::start) return thresholds::start_trust_radius;
  if (role == Role::tolerated || (sensor && !logarithmic)) return INFINITY;
  if ((role == Role::fault || role == Role::law) && is_linear) return INFINITY;
  return logarithmic ? thresholds::effect_trust_radius : std::max(thresholds::effect_trust_radius, std::abs(u));
}

FreeParameter::StepBounds FreeParameter::step_bounds(double u, double trust) const {
  const double far = trust * trust_radius(u);
  return {std::max(std::min(lower - u, 0.0), -far), std::min(std::max(upper - u, 0.0), far)};
}

std::vector<FreeParameter> tolerated_parameters(const firmware::RigDescription& description) {
  std::vector<FreeParameter> parameters;
  model::RigParameters<double> part = explained_part(description.rig);
  for (const auto& [path, bound] : description.tolerance) {
    const double* const value = firmware::find_parameter(part, path);
    if (value == nullptr || !(bound > 0.0) || *value == 0.0) continue;
    if (part.kind == model::RigKind::component_bench &&
        (path.starts_with("body") || path.starts_with("wheel") || path.starts_with("tyre"))) {
      continue;  // the virtual car is estimated on its own (virtual_car_estimate.hpp)
    }
    FreeParameter u{.role = FreeParameter::Role::tolerated,
                    .path = path,
                    .centre = *value,
                    .scale = *value * bound,
                    .lower = -1.0,
                    .upper = 1.0,
                    .difference = thresholds::tolerance_difference};
    if (bound >= 1.0) u.lower = (thresholds::least_share_of_value - 1.0) / bound;
    parameters.push_back(u);
  }
  return parameters;
}

std::vector<FreeParameter> suspect_parameters(const firmware::RigDescription& description) {
  return parameters_of_part(explained_part(description.rig));
}

std::vector<FreeParameter> parameters_of_part(const model::RigParameters<double>& explained) {
  std::vector<FreeParameter> parameters;
  model::RigParameters<double> part = explained;
  const bool has_car = part.kind != model::RigKind::component_bench;
  for (const firmware::ParameterPath& p : firmware::parameter_paths()) {
    const std::string path = std::string(p.table) + "." + std::string(p.key);
    const double* const value = firmware::find_parameter(part, path);
    if (value == nullptr || !(*value > 0.0) || p.table == "machine") continue;
    if (!has_car && p.table != "suspension" && p.table != "fdva" && p.table != "air_spring") continue;
    parameters.push_back({.role = FreeParameter::Role::tolerated,
                          .path = path,
                          .scale = *value,
                          .logarithmic = true,
                          .lower = -std::log(thresholds::parameter_range),
                          .upper = std::log(thresholds::parameter_range),
                          .difference = thresholds::effect_difference});
  }
  return parameters;
}

std::vector<FreeParameter> start_parameters(const firmware::RigDescription& description,
                                            const std::vector<PreparedRecording>& recordings) {
  std::vector<FreeParameter> parameters;
  const model::RigParameters<double> rig = explained_part(description.rig);
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    if (recordings[r].at_rest || recordings[r].fitted.size() == 0) continue;
    const double size = std::max(size_of_motion(rig, recordings[r].input, recordings[r].recording), 1e-6);
    for (const int state : free_states(rig, recordings[r].input, recordings[r].recording)) {
      parameters.push_back({.role = FreeParameter::Role::start,
                            .path = "",
                            .recording = r,
                            .state = state,
                            .scale = size * (state % 2 == 1 ? thresholds::start_rate : 1.0),
                            .lower = -thresholds::start_bound,
                            .upper = thresholds::start_bound,
                            .difference = thresholds::start_difference});
    }
  }
  return parameters;
}

std::vector<FreeParameter> fault_parameters(const std::vector<PlacedFault>& faults) {
  std::vector<FreeParameter> parameters;
  for (std::size_t f = 0; f < faults.size(); ++f) {
    const PlacedFault& fault = faults[f];
    for (std::size_t v = 0; v < fault.values.size(); ++v) {
      if (!fault.fitted[v]) continue;
      FreeParameter u{.role = FreeParameter::Role::fault, .path = ""};
      u.fault = f;
      u.number = v;
      u.readings = fault.channels;
      u.difference = thresholds::fault_difference;
      const auto range = [&u](double centre, double scale, double bound) {
        u.centre = centre;
        u.scale = scale;
        u.lower = -bound / scale;
        u.upper = bound / scale;
      };
      switch (fault.kind) {
        case FaultKind::clock:
          range(0.0, v == 0 ? thresholds::offset_scale : thresholds::rate_scale,
                v == 0 ? thresholds::largest_offset : thresholds::largest_rate);
          break;
        case FaultKind::common_filter:
          u.scale = 1.0;
          u.logarithmic = true;
          u.lower = std::log(thresholds::lowest_corner);
          u.upper = std::log(thresholds::highest_corner);
          break;
        case FaultKind::mains_hum:
          if (v == 0) {
            range(fault.values[0], thresholds::hum_scale, thresholds::hum_range);
          } else {
            const double size = std::hypot(fault.values[2 * ((v - 1) / 2) + 1], fault.values[2 * ((v - 1) / 2) + 2]);
            range(0.0, std::max(size, 1e-12), 1e3 * std::max(size, 1e-12));
            u.is_linear = true;
            u.readings = {fault.channels[(v - 1) / 2]};
          }
          break;
        case FaultKind::drift:
          range(0.0, v == 0 ? thresholds::drift_scale : 1.0,
                v == 0 ? thresholds::largest_drift : thresholds::largest_curvature);
          break;
      }
      parameters.push_back(std::move(u));
    }
  }
  return parameters;
}

std::vector<FreeParameter> law_parameters(const std::vector<PlacedLaw>& laws) {
  std::vector<FreeParameter> parameters;
  for (std::size_t l = 0; l < laws.size(); ++l) {
    const PlacedLaw& law = laws[l];
    for (std::size_t v = 0; v < law.values.size(); ++v) {
      if (law.family == LawFamily::points && law.at[v] == 0.0) continue;
      FreeParameter u{.role = FreeParameter::Role::law, .path = ""};
      u.law = l;
      u.number = v;
      u.difference = thresholds::law_difference;
      const LawValue::Kind kind = has_grid(law.family) ? LawValue::Kind::force : values_of(law.family)[v].kind;
      if (kind == LawValue::Kind::force) {
        u.scale = law.size;
        u.lower = has_memory(law.family) ? 0.0 : -thresholds::largest_law_force;
        u.upper = thresholds::largest_law_force;
        u.is_linear = has_grid(law.family);
      } else {
        const LawValue& value = values_of(law.family)[v];
        const double unit = kind == LawValue::Kind::width ? law.unit_of_width() : 1.0;
        u.logarithmic = true;
        u.scale = std::max(law.values[v], 1e-12);
        u.lower = std::log(value.lower * unit / u.scale);
        u.upper = std::log(value.upper * unit / u.scale);
      }
      parameters.push_back(u);
    }
    if (law.gap > 0.0) {
      FreeParameter u{.role = FreeParameter::Role::law, .path = ""};
      u.law = l;
      u.number = law.values.size();
      u.difference = thresholds::law_difference;
      u.logarithmic = true;
      u.scale = law.gap;
      u.lower = std::log(thresholds::narrowest_gap * law.largest / law.gap);
      u.upper = std::log(law.largest / law.gap);
      parameters.push_back(u);
    }
  }
  return parameters;
}

bool is_hold(const firmware::CatalogueEntry& entry) {
  return std::any_of(entry.parameters.begin(), entry.parameters.end(), [](const model::EffectParameter& p) {
    return p.starts.read == model::Reading::renewal_period && !p.fitted;
  });
}

namespace {

/// A number of few units, whose effect is not proportional to it.
bool is_shape(const model::EffectParameter& card) {
  return card.unit == "1" && card.upper - card.lower <= thresholds::range_of_shape;
}

/// Unit of the coordinate of a parameter of either sign: its size. A value that passes through neutral goes on: beside
/// others of the same unit it is at least a third of theirs, of a shape (a number of few units) a share of its range.
double size_of(const firmware::PlacedEffect& effect, std::size_t parameter) {
  const auto& cards = effect.entry->parameters;
  const auto size = [&](std::size_t i) { return std::abs(effect.values[i] - cards[i].neutral); };
  double largest = size(parameter);
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const bool alike = cards[i].lower < 0.0 && cards[i].unit == cards[parameter].unit;
    if (alike) largest = std::max(largest, size(i) / 3.0);
  }
  const double range = cards[parameter].upper - cards[parameter].lower;
  return std::max(largest, is_shape(cards[parameter]) ? thresholds::shape_scale * range : 1e-12);
}

}  // namespace

bool is_proportional(const model::EffectParameter& card) { return card.lower < 0.0 && !is_shape(card); }

FitRange fit_range(const model::EffectParameter& card) {
  if (!is_proportional(card) || card.neutral == 0.0) return {card.lower, card.upper};
  return {std::max(card.lower, card.neutral / thresholds::largest_factor),
          std::min(card.upper, card.neutral * thresholds::largest_factor)};
}

std::vector<FreeParameter> effect_parameters(const firmware::PlacedEffect& effect) {
  std::vector<FreeParameter> parameters;
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const model::EffectParameter& card = effect.entry->parameters[i];
    if (!card.fitted) continue;
    FreeParameter u{.role = FreeParameter::Role::effect,
                    .path = firmware::effect_path(effect, i),
                    .sensor = effect.channel,
                    .difference = thresholds::effect_difference};
    if (card.lower < 0.0) {
      u.centre = card.neutral;
      u.scale = size_of(effect, i);
      const FitRange range = fit_range(card);
      u.lower = std::max((range.lower - u.centre) / u.scale, -1e6);
      u.upper = std::min((range.upper - u.centre) / u.scale, 1e6);
    } else {
      u.logarithmic = true;
      u.scale = std::max(effect.values[i], 1e-12);
      u.lower = card.lower > 0.0 ? std::log(card.lower / u.scale) : thresholds::lowest_logarithm;
      u.upper = std::log(card.upper / u.scale);
      if (card.kept_within > 0.0) {
        u.lower = std::max(u.lower, std::log(1.0 - card.kept_within));
        u.upper = std::min(u.upper, std::log(1.0 + card.kept_within));
      }
    }
    parameters.push_back(u);
  }
  return parameters;
}

SearchSpace search_space(const firmware::RigDescription& description, const std::vector<PreparedRecording>& recordings,
                         Hypothesis given) {
  SearchSpace space{std::move(given), tolerated_parameters(description), {}, suspect_parameters(description)};
  const auto unseen = [&](const FreeParameter& p) { return !recordings.front().shows(p.path); };
  std::erase_if(space.tolerated, unseen);
  std::erase_if(space.suspects, unseen);
  space.common = space.tolerated;
  for (FreeParameter& start : start_parameters(description, recordings)) space.common.push_back(std::move(start));
  return space;
}

}  // namespace host_sim::identification
