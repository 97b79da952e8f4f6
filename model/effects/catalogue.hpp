// The one list of effects. Everything that knows effects by name reads it here.
#pragma once

#include <cstddef>
#include <tuple>
#include <utility>

#include "model/effects/actuator_delay.hpp"
#include "model/effects/coulomb_friction.hpp"
#include "model/effects/force_sensor_inertia.hpp"
#include "model/effects/tyre_lift_off.hpp"

namespace model {

/// An effect that may be part of a rig.
template <class Effect>
struct Slot {
  bool active = false;
  Effect effect{};
};

/// All effects of the catalogue, none active by default. Order matters where laws act on each other's result: tyre
/// laws act in the order of this list.
template <class S>
struct Effects {
  std::tuple<Slot<ActuatorDelay<S>>,       //
             Slot<CoulombFriction<S>>,     //
             Slot<ForceSensorInertia<S>>,  //
             Slot<TyreLiftOff<S>>>
      slots;

  template <template <class> class Effect>
  [[nodiscard]] constexpr Slot<Effect<S>>& get() {
    return std::get<Slot<Effect<S>>>(slots);
  }
  template <template <class> class Effect>
  [[nodiscard]] constexpr const Slot<Effect<S>>& get() const {
    return std::get<Slot<Effect<S>>>(slots);
  }

  /// Puts an effect into the rig.
  template <template <class> class Effect>
  constexpr void add(const Effect<S>& effect) {
    get<Effect>() = {true, effect};
  }

  /// visit(slot) for each effect of the list, active or not.
  template <class Visitor>
  constexpr void for_each(Visitor&& visit) {
    std::apply([&](auto&... slot) { (visit(slot), ...); }, slots);
  }
  template <class Visitor>
  constexpr void for_each(Visitor&& visit) const {
    std::apply([&](const auto&... slot) { (visit(slot), ...); }, slots);
  }

  /// act_on(place) of every active effect that acts there.
  template <class PlaceOfRig>
  constexpr void act_on(PlaceOfRig& place) const {
    for_each([&](const auto& slot) {
      if constexpr (requires { slot.effect.act_on(place); }) {
        if (slot.active) slot.effect.act_on(place);
      }
    });
  }
};

}  // namespace model
