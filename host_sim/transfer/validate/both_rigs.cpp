#include "host_sim/transfer/validate/both_rigs.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/suspect_parameters.hpp"
#include "host_sim/transfer/common/statistics.hpp"
#include "host_sim/transfer/common/thresholds.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"

namespace host_sim::transfer {
namespace {

using identification::FreeParameter;

OwnedEffect owned(const identification::NamedEffect& named) {
  OwnedEffect own{std::string(named.effect.entry->name),
                  named.effect.channel ? std::string(model::name(*named.effect.channel)) : "",
                  identification::words(named.effect), named.effect};
  for (std::size_t p = 0; p < named.parameters.size(); ++p) {
    const auto& card = named.effect.entry->parameters[p];
    own.parameters.push_back({std::string(card.name), std::string(card.unit), named.parameters[p].value,
                              named.parameters[p].lower, named.parameters[p].upper, travels(*named.effect.entry)});
  }
  return own;
}

OwnedEffect owned(const identification::ParameterOff& off) {
  return {off.path,
          "",
          off.path + " outside of its tolerance",
          {},
          {{"value", "", off.value.value, off.value.lower, off.value.upper, travels(off.path)}}};
}

OwnedEffect owned(const identification::DescribedLaw& law) {
  const bool own = law.law.place == identification::CurvePlace::suspension;
  OwnedEffect effect{"law",
                     "",
                     "a law at the " + std::string(identification::name(law.law.place)) + ", " + law.shape +
                         (law.words.empty() ? "" : ": " + law.words),
                     {}};
  for (const identification::LawNumber& n : law.numbers) {
    effect.parameters.push_back({n.name, "", n.value, n.lower, n.upper, own});
  }
  return effect;
}

bool is_positive(const FreeParameter& parameter) {
  return parameter.logarithmic || parameter.role == FreeParameter::Role::tolerated;
}

Estimate estimate_of(const ComponentModel& model, std::size_t i, bool logarithm) {
  const auto k = static_cast<Eigen::Index>(i);
  const FreeParameter& p = model.parameters[i];
  const double u = model.mode(k), sigma = std::sqrt(model.covariance(k, k));
  const double value = p.value(u), slope = p.logarithmic ? value : p.scale;
  if (!logarithm) return {value, std::abs(slope) * sigma};
  return {std::log(std::max(value, 1e-300)), std::abs(slope) * sigma / std::max(std::abs(value), 1e-300)};
}

LearnedValue in_words(const std::string& path, const std::string& unit, Estimate e, bool logarithm) {
  const auto back = [&](double x) { return logarithm ? std::exp(x) : x; };
  return {path, unit, back(e.value), back(e.value - 1.96 * e.deviation), back(e.value + 1.96 * e.deviation), true};
}

bool holds(const std::vector<OwnedEffect>& list, const std::string& name) {
  return std::any_of(list.begin(), list.end(), [&](const OwnedEffect& e) { return e.name == name; });
}

}  // namespace

SharedValue shared_value(const std::string& path, const std::string& unit, Estimate first, Estimate second,
                         bool logarithm) {
  const double a = 1.0 / std::max(first.deviation * first.deviation, 1e-300),
               b = 1.0 / std::max(second.deviation * second.deviation, 1e-300);
  SharedValue shared;
  shared.path = path;
  shared.unit = unit;
  shared.first = in_words(path, unit, first, logarithm);
  shared.second = in_words(path, unit, second, logarithm);
  shared.pooled =
      in_words(path, unit, {(a * first.value + b * second.value) / (a + b), 1.0 / std::sqrt(a + b)}, logarithm);
  shared.z = (first.value - second.value) / std::sqrt(1.0 / a + 1.0 / b);
  shared.equal = std::abs(shared.z) < thresholds::equal_within;
  return shared;
}

BothRigs sort_effects(const identification::Identified& first, const Posterior& posterior) {
  BothRigs both;
  for (const identification::NamedEffect& named : first.diagnosis.effects) {
    (travels(*named.effect.entry) ? both.travels : both.stays).push_back(owned(named));
  }
  for (const identification::ParameterOff& off : first.diagnosis.parameters_off) {
    (travels(off.path) ? both.travels : both.stays).push_back(owned(off));
  }
  for (const identification::DescribedLaw& law : first.diagnosis.laws) {
    const bool own = law.law.place == identification::CurvePlace::suspension;
    (own ? both.travels : both.stays).push_back(owned(law));
  }
  for (OwnedEffect& effect : both.travels) {  // as the draws have them
    for (LearnedValue& value : effect.parameters) {
      for (const LearnedValue& learned : posterior.learned) {
        const bool same = learned.path == "effects." + effect.name + "." + value.path ||
                          (effect.effect.entry == nullptr && learned.path == effect.name);
        if (!same) continue;
        value.value = learned.value;
        value.lower = learned.lower;
        value.upper = learned.upper;
      }
    }
  }
  return both;
}

void compare_with_second(const identification::Identified& second, const Posterior& posterior, BothRigs& both) {
  both.second_unexplained = second.diagnosis.unexplained;
  for (const identification::NamedEffect& named : second.diagnosis.effects) {
    OwnedEffect own = owned(named);
    if (!travels(*named.effect.entry)) {
      both.second_only.push_back(std::move(own));
    } else if (!holds(both.travels, own.name)) {
      both.component_on_second_only.push_back(std::move(own));
    }
  }
  for (const identification::ParameterOff& off : second.diagnosis.parameters_off) {
    (travels(off.path) ? both.component_on_second_only : both.second_only).push_back(owned(off));
  }
  for (const OwnedEffect& effect : both.travels) {
    if (effect.effect.entry == nullptr) continue;
    const auto& named = second.diagnosis.effects;
    if (std::none_of(named.begin(), named.end(),
                     [&](const auto& e) { return e.effect.entry == effect.effect.entry; })) {
      both.not_seen_on_second.push_back(effect.words);
    }
  }
  const auto& fit = second.found.best.fit;
  if (fit.parameters.empty()) return;
  const ComponentModel& a = posterior.diagnosed();
  const ComponentModel b = laplace_model(second.problem, identification::untied(second.space, second.found.freed),
                                         identification::fit(second.problem, fit.hypothesis, fit.parameters),
                                         identification::temper_of(fit));
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    if (!travels(a.parameters[i], a.hypothesis) || a.parameters[i].path.empty()) continue;
    for (std::size_t j = 0; j < b.parameters.size(); ++j) {
      if (b.parameters[j].path != a.parameters[i].path || a.parameters[i].path == "suspension.damping") continue;
      const bool logarithm = is_positive(a.parameters[i]);
      const Estimate x = estimate_of(a, i, logarithm), y = estimate_of(b, j, logarithm);
      std::string unit;
      for (const LearnedValue& learned : posterior.learned) {
        if (learned.path == a.parameters[i].path) unit = learned.unit;
      }
      both.shared.push_back(shared_value(a.parameters[i].path, unit, x, y, logarithm));
    }
  }
}

firmware::RigDescription with_own_effects(const firmware::RigDescription& to, const identification::Diagnosis& second) {
  firmware::RigDescription rig = to;
  for (const identification::NamedEffect& named : second.effects) {
    if (!travels(*named.effect.entry)) firmware::put_effect(rig.rig, named.effect);
  }
  for (const auto& [path, value] : second.parameters) {
    if (travels(path)) continue;
    double* const target = firmware::find_parameter(rig.rig, path);
    if (target == nullptr || !(std::abs(value.value) > 0.0)) continue;
    *target = value.value;
    // What the second rig's records leave of its own parameter, as a uniform width of the same variance.
    const double relative = 0.5 * (value.upper - value.lower) / 1.96 * std::sqrt(3.0) / std::abs(value.value);
    const auto bound = rig.tolerance.find(path);
    if (bound != rig.tolerance.end()) bound->second = std::min(bound->second, relative);
  }
  return rig;
}

}  // namespace host_sim::transfer
