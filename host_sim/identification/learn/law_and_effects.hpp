// A law that is an effect of the catalogue, and an effect that is a law's limit.
#pragma once

#include <optional>

#include "host_sim/identification/learn/law_beside.hpp"

namespace host_sim::identification {

/// The effect of the catalogue that a law is, as far as its family and its place tell: a power of three over the
/// deflection is a progressive spring, friction that falls from the friction beside it Stribeck's. Its values are such
/// as its card allows. nullopt: none.
[[nodiscard]] std::optional<firmware::PlacedEffect> effect_like(const PlacedLaw& law, const EffectsBeside& beside);

/// True if a curve replaces dry friction: `all` holds one, `kept` none, and the curve steps at rest by half of it or
/// more. No curve of points can draw such a step.
[[nodiscard]] bool draws_friction(const PlacedLaw& law, const EffectsBeside& all, const EffectsBeside& kept);

/// Whether a family holds an effect whose place it takes as its limit: one more number for the same law.
[[nodiscard]] bool refines(const PlacedLaw& law, const EffectsBeside& all, const EffectsBeside& kept);

/// The force at x of those effects of `all` that are not among `kept` and act at a place without memory: what a curve
/// begins with that takes their place.
class ForceOfEffects {
 public:
  ForceOfEffects(const EffectsBeside& all, const EffectsBeside& kept, CurvePlace place, CurveOver over);

  [[nodiscard]] double operator()(double x) const;

 private:
  CurvePlace place_;
  CurveOver over_;
  model::RigParameters<double> rig_{};
};

}  // namespace host_sim::identification
