// The one list of effects. Everything that knows effects by name reads it here.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include "model/channel.hpp"
#include "model/effects/actuator_delay.hpp"
#include "model/effects/actuator_lag.hpp"
#include "model/effects/actuator_rate_limit.hpp"
#include "model/effects/actuator_resonance.hpp"
#include "model/effects/backlash.hpp"
#include "model/effects/body_guide_damping.hpp"
#include "model/effects/body_guide_friction.hpp"
#include "model/effects/bump_stop.hpp"
#include "model/effects/coulomb_friction.hpp"
#include "model/effects/force_sensor_inertia.hpp"
#include "model/effects/progressive_spring.hpp"
#include "model/effects/progressive_tyre.hpp"
#include "model/effects/quadratic_damping.hpp"
#include "model/effects/relaxation.hpp"
#include "model/effects/seal_friction.hpp"
#include "model/effects/sensor_delay.hpp"
#include "model/effects/sensor_gain.hpp"
#include "model/effects/sensor_hold.hpp"
#include "model/effects/sensor_lag.hpp"
#include "model/effects/sensor_offset.hpp"
#include "model/effects/sensor_saturation.hpp"
#include "model/effects/top_mount.hpp"
#include "model/effects/tyre_lift_off.hpp"
#include "model/effects/viscous_damping.hpp"
#include "model/effects/wheel_guide_damping.hpp"
#include "model/effects/wheel_guide_friction.hpp"
#include "model/places.hpp"

namespace model {

/// An effect that may be part of a rig.
template <class Effect>
struct Slot {
  bool active = false;
  Effect effect{};
};

/// A sensor effect, which may be part of each channel.
template <class Effect>
struct ChannelSlots {
  std::array<Slot<Effect>, channel_count> channels{};
};

/// All effects of the catalogue, none active by default. Order matters where laws act on each other's result: tyre
/// laws act in the order of this list.
template <class S>
struct Effects {
  std::tuple<Slot<ActuatorDelay<S>>,       //
             Slot<ActuatorLag<S>>,         //
             Slot<ActuatorResonance<S>>,   //
             Slot<ActuatorRateLimit<S>>,   //
             Slot<CoulombFriction<S>>,     //
             Slot<ViscousDamping<S>>,      //
             Slot<QuadraticDamping<S>>,    //
             Slot<ProgressiveSpring<S>>,   //
             Slot<BumpStop<S>>,            //
             Slot<Backlash<S>>,            //
             Slot<TopMount<S>>,            //
             Slot<Relaxation<S>>,          //
             Slot<SealFriction<S>>,        //
             Slot<BodyGuideFriction<S>>,   //
             Slot<WheelGuideFriction<S>>,  //
             Slot<BodyGuideDamping<S>>,    //
             Slot<WheelGuideDamping<S>>,   //
             Slot<ProgressiveTyre<S>>,     //
             Slot<TyreLiftOff<S>>,         //
             Slot<ForceSensorInertia<S>>>
      slots;
  std::tuple<ChannelSlots<SensorLag<S>>,         //
             ChannelSlots<SensorDelay<S>>,       //
             ChannelSlots<SensorGain<S>>,        //
             ChannelSlots<SensorOffset<S>>,      //
             ChannelSlots<SensorSaturation<S>>,  //
             ChannelSlots<SensorHold<S>>>
      sensors;

  template <template <class> class Effect>
  [[nodiscard]] constexpr Slot<Effect<S>>& get() {
    return std::get<Slot<Effect<S>>>(slots);
  }
  template <template <class> class Effect>
  [[nodiscard]] constexpr const Slot<Effect<S>>& get() const {
    return std::get<Slot<Effect<S>>>(slots);
  }
  template <template <class> class Effect>
  [[nodiscard]] constexpr Slot<Effect<S>>& get(Channel channel) {
    return std::get<ChannelSlots<Effect<S>>>(sensors).channels[index(channel)];
  }

  /// Puts an effect into the rig.
  template <template <class> class Effect>
  constexpr void add(const Effect<S>& effect) {
    get<Effect>() = {true, effect};
  }
  /// Puts an effect into the sensor of a channel.
  template <template <class> class Effect>
  constexpr void add(Channel channel, const Effect<S>& effect) {
    get<Effect>(channel) = {true, effect};
  }

  /// visit(slot) for each effect of the list but those of sensors, active or not.
  template <class Visitor>
  constexpr void for_each(Visitor&& visit) {
    std::apply([&](auto&... slot) { (visit(slot), ...); }, slots);
  }
  template <class Visitor>
  constexpr void for_each(Visitor&& visit) const {
    std::apply([&](const auto&... slot) { (visit(slot), ...); }, slots);
  }

  /// visit(slot, channel) for each sensor effect of the list and each channel, active or not.
  template <class Visitor>
  constexpr void for_each_sensor(Visitor&& visit) {
    std::apply([&](auto&... effect) { (visit_channels(effect, visit), ...); }, sensors);
  }
  template <class Visitor>
  constexpr void for_each_sensor(Visitor&& visit) const {
    std::apply([&](const auto&... effect) { (visit_channels(effect, visit), ...); }, sensors);
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

  /// The sensor of each channel with every active effect that acts there.
  [[nodiscard]] constexpr std::array<SensorPath<S>, channel_count> sensor_paths() const {
    std::array<SensorPath<S>, channel_count> paths{};
    for_each_sensor([&](const auto& slot, Channel channel) {
      if (slot.active) slot.effect.act_on(paths[index(channel)]);
    });
    return paths;
  }

 private:
  template <class ByChannel, class Visitor>
  static constexpr void visit_channels(ByChannel& effect, Visitor& visit) {
    for (std::size_t c = 0; c < channel_count; ++c) visit(effect.channels[c], channel_at(c));
  }
};

}  // namespace model
