// The list of effects. Rig descriptions, simulation, identification and firmware know an effect because it is listed
// here.
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <utility>

#include "model/components/channel.hpp"
#include "model/components/subsystems.hpp"
#include "model/effects/actuator_delay.hpp"
#include "model/effects/actuator_lag.hpp"
#include "model/effects/actuator_rate_limit.hpp"
#include "model/effects/actuator_resonance.hpp"
#include "model/effects/air_leak.hpp"
#include "model/effects/asymmetric_damper.hpp"
#include "model/effects/backlash.hpp"
#include "model/effects/body_guide_damping.hpp"
#include "model/effects/body_guide_friction.hpp"
#include "model/effects/bouc_wen.hpp"
#include "model/effects/bump_stop.hpp"
#include "model/effects/coulomb_friction.hpp"
#include "model/effects/force_sensor_inertia.hpp"
#include "model/effects/gas_exponent.hpp"
#include "model/effects/hardening_hysteresis.hpp"
#include "model/effects/moving_mass.hpp"
#include "model/effects/position_ripple.hpp"
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
#include "model/effects/stribeck_friction.hpp"
#include "model/effects/stuck_area.hpp"
#include "model/effects/top_mount.hpp"
#include "model/effects/tyre_lift_off.hpp"
#include "model/effects/viscous_damping.hpp"
#include "model/effects/wheel_guide_damping.hpp"
#include "model/effects/wheel_guide_friction.hpp"

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

template <class... Effect>
using Slots = std::tuple<Slot<Effect>...>;
template <class... Effect>
using SensorSlots = std::tuple<ChannelSlots<Effect>...>;

/// The effects of rigs without an air spring. Laws of the tyre act on each other's result, in this order.
template <class S>
using UsualEffects = Slots<ActuatorDelay<S>,        //
                           ActuatorLag<S>,          //
                           ActuatorResonance<S>,    //
                           ActuatorRateLimit<S>,    //
                           CoulombFriction<S>,      //
                           StribeckFriction<S>,     //
                           ViscousDamping<S>,       //
                           QuadraticDamping<S>,     //
                           AsymmetricDamper<S>,     //
                           ProgressiveSpring<S>,    //
                           BoucWen<S>,              //
                           HardeningHysteresis<S>,  //
                           PositionRipple<S>,       //
                           BumpStop<S>,             //
                           Backlash<S>,             //
                           TopMount<S>,             //
                           Relaxation<S>,           //
                           SealFriction<S>,         //
                           BodyGuideFriction<S>,    //
                           WheelGuideFriction<S>,   //
                           BodyGuideDamping<S>,     //
                           WheelGuideDamping<S>,    //
                           ProgressiveTyre<S>,      //
                           TyreLiftOff<S>,          //
                           ForceSensorInertia<S>,   //
                           MovingMass<S>>;

/// The effects of air springs. A microcontroller's programs have no air spring.
#if defined(RIGTWIN_WITHOUT_LAWS)
template <class S>
using AirSpringEffects = Slots<>;
#else
template <class S>
using AirSpringEffects = Slots<AirLeak<S>,    //
                               StuckArea<S>,  //
                               GasExponent<S>>;
#endif

/// The effects of a rig, in this order.
template <class S>
using RigEffects = decltype(std::tuple_cat(UsualEffects<S>{}, AirSpringEffects<S>{}));

/// The effects of a channel's sensor.
template <class S>
using SensorEffects = SensorSlots<SensorLag<S>,         //
                                  SensorDelay<S>,       //
                                  SensorGain<S>,        //
                                  SensorOffset<S>,      //
                                  SensorSaturation<S>,  //
                                  SensorHold<S>>;

/// All effects of the catalogue, none active by default.
template <class S>
struct Effects {
  RigEffects<S> slots;
  SensorEffects<S> sensors;

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

  /// act_on(part) of every active effect that acts there.
  template <class PartOfRig>
  constexpr void act_on(PartOfRig& part) const {
    for_each([&](const auto& slot) {
      if constexpr (requires { slot.effect.act_on(part); }) {
        if (slot.active) slot.effect.act_on(part);
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

/// Whether an effect is a law that adds a force (RigModel asks it every step), and not values of a subsystem.
template <class Effect>
concept SuspensionLaw = requires(const Effect& effect) {
  effect.suspension_force(0.0, 0.0);
};
/// Whether an effect is a law with memory: its force depends on how the deflection went.
template <class Effect>
concept HistoryLaw = requires(const Effect& effect) {
  effect.force_after(0.0, 0.0);
};
template <class Effect>
concept TyreLaw = requires(const Effect& effect) {
  effect.tyre_force(0.0, 0.0, 0.0);
};
template <class Effect>
concept HasTangent = requires(const Effect& effect) {
  effect.tangent();
};
template <class Effect, class Part>
concept ActsOn = requires(const Effect& effect, Part& part) {
  effect.act_on(part);
};
template <class Effect>
concept ActsOnRig = ActsOn<Effect, MachinePath<double>> || ActsOn<Effect, SuspensionComponent<double>> ||
    ActsOn<Effect, Piston<double>> || ActsOn<Effect, Guides<double>> || ActsOn<Effect, WheelLoadSensor<double>> ||
    ActsOn<Effect, LoadCell<double>> || ActsOn<Effect, AirSpringCondition<double>>;

template <class Effect>
[[nodiscard]] consteval bool is_complete() {
  return find_gap(Effect::card).empty() && Effect::values.size() == Effect::card.parameters.size() &&
         HasTangent<Effect> == (Effect::card.linearisation == Linearisation::tangent);
}

/// An effect can be listed when its card says everything and something of the model asks it to act. The linearised loop
/// is made from the subsystems: a law is not in it.
template <class Effect>
concept RigEffect = is_complete<Effect>() &&
    (ActsOnRig<Effect> || ((SuspensionLaw<Effect> || HistoryLaw<Effect> ||
                            TyreLaw<Effect>)&&Effect::card.linearisation != Linearisation::exact));
template <class Effect>
concept SensorEffect = is_complete<Effect>() && ActsOn<Effect, SensorPath<double>>;

/// How many effects of the list are laws with memory.
template <class... Effect>
constexpr std::size_t history_laws_of(const Slots<Effect...>* /*list*/) {
  return (std::size_t{HistoryLaw<Effect>} + ... + 0U);
}
inline constexpr std::size_t history_laws = history_laws_of(static_cast<RigEffects<double>*>(nullptr));

template <RigEffect... Effect>
constexpr bool all_rig_effects(const Slots<Effect...>* /*list*/) {
  return true;
}
template <SensorEffect... Effect>
constexpr bool all_sensor_effects(const SensorSlots<Effect...>* /*list*/) {
  return true;
}
static_assert(all_rig_effects(static_cast<RigEffects<double>*>(nullptr)));
static_assert(all_sensor_effects(static_cast<SensorEffects<double>*>(nullptr)));

}  // namespace model
