#include "host_sim/identification/learn/law_and_effects.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host_sim/identification/learn/thresholds.hpp"

namespace host_sim::identification {
namespace {

std::optional<firmware::PlacedEffect> named_like(const PlacedLaw& law, double friction) {
  const auto effect = [&](const auto& has_form, std::vector<double> values) -> std::optional<firmware::PlacedEffect> {
    const auto* const entry = firmware::find_effect_that(
        [&](const auto& e) { return !e.of_channel && e.subsystem == subsystem_of(law.place) && has_form(e.force); });
    if (entry == nullptr) return std::nullopt;
    return firmware::PlacedEffect{entry, std::nullopt, std::move(values)};
  };
  const auto form = [](model::Form wanted) {
    return [wanted](const model::ForceForm& force) { return force.form == wanted; };
  };
  const bool damper = law.place == CurvePlace::suspension && law.over == CurveOver::velocity;
  const auto stribeck = [&](double fall, double velocity) {
    const double sliding = friction - fall;
    return effect(form(model::Form::falling), {sliding, fall / sliding, velocity});
  };
  if (damper && law.family == LawFamily::falling && friction > law.values[0])
    return stribeck(law.values[0], law.values[1]);
  if (damper && law.family == LawFamily::knee) {
    // A fall up to the knee, and nothing beyond: a knee of 1.7 v_s is nearest to Stribeck's law.
    const double fall = -law.values[0] * law.values[2] / law.rms;
    const bool ends = std::abs(law.values[1]) < thresholds::flat_beyond_knee * std::abs(law.values[0]);
    if (fall > 0.0 && fall < friction && ends) return stribeck(fall, law.values[2] / 1.7);
  }
  if (damper && law.family == LawFamily::two_slopes)
    return effect(form(model::Form::two_slopes), {(law.values[0] - law.values[1]) / law.rms});
  const bool two = law.family == LawFamily::two_powers;
  if (!two && law.family != LawFamily::power) return std::nullopt;
  const double force = two ? 0.5 * (law.values[0] + law.values[1]) : law.values[0], exponent = law.values.back();
  for (const double whole : {2.0, 3.0}) {
    if (std::abs(exponent - whole) > thresholds::exponent_of_effect) continue;
    const auto is_power = [&](const model::ForceForm& f) { return f.is_power(variable_of(law.over), whole); };
    if (auto same = effect(is_power, {force / std::pow(law.rms, whole)})) return same;
  }
  return std::nullopt;
}

/// True if every value lies within the bounds of its effect's card.
bool is_allowed(const firmware::PlacedEffect& effect) {
  for (std::size_t i = 0; i < effect.values.size(); ++i) {
    const model::EffectParameter& card = effect.entry->parameters[i];
    if (!(effect.values[i] >= card.lower && effect.values[i] <= card.upper)) return false;
  }
  return true;
}

}  // namespace

std::optional<firmware::PlacedEffect> effect_like(const PlacedLaw& law, const EffectsBeside& beside) {
  const auto friction = std::find_if(beside.begin(), beside.end(), is_friction);
  auto effect = named_like(law, friction != beside.end() ? friction->values.front() : 0.0);
  return effect && is_allowed(*effect) ? effect : std::nullopt;
}

bool draws_friction(const PlacedLaw& law, const EffectsBeside& all, const EffectsBeside& kept) {
  if (has_memory(law.family) || is_surface(law.family)) return false;
  if (std::any_of(kept.begin(), kept.end(), is_friction)) return false;
  const auto removed = std::find_if(all.begin(), all.end(), is_friction);
  if (removed == all.end()) return false;
  const double step = law.force(thresholds::innermost_point * law.rms);
  return step > thresholds::steps_like_friction * removed->values.front();
}

bool refines(const PlacedLaw& law, const EffectsBeside& all, const EffectsBeside& kept) {
  constexpr std::array<std::pair<LawFamily, double>, 8> limits{{{LawFamily::soft_sign, 0.0},
                                                                {LawFamily::falling, 0.0},
                                                                {LawFamily::levelling, 0.0},
                                                                {LawFamily::levelling, 1.0},
                                                                {LawFamily::power, 1.0},
                                                                {LawFamily::power, 2.0},
                                                                {LawFamily::two_powers, 2.0},
                                                                {LawFamily::two_slopes, 1.0}}};
  if (law.place != CurvePlace::suspension || law.over != CurveOver::velocity) return false;
  return std::any_of(all.begin(), all.end(), [&](const auto& effect) {
    const bool stays = std::any_of(kept.begin(), kept.end(), [&](const auto& k) { return k.entry == effect.entry; });
    return (!stays || law.family == LawFamily::falling) && !effect.channel &&
           effect.entry->subsystem == model::Subsystem::suspension &&
           std::any_of(limits.begin(), limits.end(), [&](const auto& limit) {
             return limit.first == law.family && effect.entry->force.is_power(model::Over::velocity, limit.second);
           });
  });
}

ForceOfEffects::ForceOfEffects(const EffectsBeside& all, const EffectsBeside& kept, CurvePlace place, CurveOver over)
    : place_(place), over_(over) {
  for (const firmware::PlacedEffect& effect : all) {
    if (std::none_of(kept.begin(), kept.end(),
                     [&](const auto& k) { return k.entry == effect.entry && k.channel == effect.channel; })) {
      firmware::put_effect(rig_, effect);
    }
  }
}

double ForceOfEffects::operator()(double x) const {
  const double deflection = over_ == CurveOver::deflection ? x : 0.0, velocity = over_ == CurveOver::velocity ? x : 0.0;
  double force = 0.0;
  model::SuspensionComponent<double> part{};
  rig_.effects.for_each([&](const auto& slot) {
    if (!slot.active) return;
    if constexpr (requires { slot.effect.suspension_force(deflection, velocity); }) {
      if (place_ == CurvePlace::suspension) force += slot.effect.suspension_force(deflection, velocity);
    }
    if constexpr (requires { slot.effect.act_on(part); }) {
      if (place_ == CurvePlace::suspension) slot.effect.act_on(part);
    } else if constexpr (requires { slot.effect.tyre_force(force, deflection, 0.0); }) {
      if (place_ == CurvePlace::tyre && slot.effect.card.subsystem == model::Subsystem::tyre &&
          slot.effect.values.size() > 0) {
        force += slot.effect.tyre_force(0.0, deflection, 0.0);
      }
    }
  });
  return force + part.damping * velocity + part.dry_friction * (velocity > 0.0 ? 1.0 : velocity < 0.0 ? -1.0 : 0.0);
}

}  // namespace host_sim::identification
