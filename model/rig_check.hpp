// What makes numbers a rig (included by rig_model.hpp).
#pragma once

#include "model/rig_model.hpp"

namespace model {

/// Whether a channel of this kind of rig has a sensor whose reading can differ from the true value: in a hil rig body,
/// wheel and road are numbers.
[[nodiscard]] constexpr bool has_sensor(RigKind kind, Channel channel) {
  const bool machine = channel == Channel::F || channel == Channel::x_act;
  return kind == RigKind::quarter_car ? !machine && channel != Channel::x_cmd && channel != Channel::F_act : machine;
}

template <class S>
std::optional<RigFault> find_fault(const RigParameters<S>& rig, S period, std::size_t longest_delay) {
  std::optional<RigFault> fault;
  const auto demand = [&fault](bool holds, std::string_view table, std::string_view key, std::string_view expected) {
    if (!holds && !fault) fault = RigFault{table, key, expected};
  };
  const auto finite = [](S value) { return value - value == S(0); };
  const auto positive = [&](S value, std::string_view table, std::string_view key) {
    demand(finite(value) && value > S(0), table, key, "a finite number > 0");
  };
  const auto not_negative = [&](S value, std::string_view table, std::string_view key) {
    demand(finite(value) && value >= S(0), table, key, "a finite number >= 0");
  };

  demand(finite(period) && period > S(0), "", "sample_rate", "a finite rate > 0 Hz");
  if (rig.kind != RigKind::component_bench) {
    positive(rig.body.mass, "body", "mass");
    positive(rig.wheel.mass, "wheel", "mass");
    positive(rig.tyre.stiffness, "tyre", "stiffness");
    not_negative(rig.tyre.damping, "tyre", "damping");
  }
  not_negative(rig.suspension.stiffness, "suspension", "stiffness");
  not_negative(rig.suspension.damping, "suspension", "damping");
  not_negative(rig.machine.virtual_damping, "machine", "virtual_damping");
  demand(rig.machine.virtual_damping == S(0) || rig.kind == RigKind::hil, "machine", "virtual_damping",
         "0: only a hil rig has virtual damping");
  if (rig.has_fdva) {
    const auto& f = rig.fdva;
    positive(f.piston_area, "fdva", "piston_area");
    positive(f.duct_diameter, "fdva", "duct_diameter");
    positive(f.duct_length, "fdva", "duct_length");
    positive(f.oil_density, "fdva", "oil_density");
    not_negative(f.oil_viscosity, "fdva", "oil_viscosity");
    not_negative(f.minor_loss, "fdva", "minor_loss");
    positive(f.coupling_stiffness, "fdva", "coupling_stiffness");
    demand(f.ducts >= 1 && f.ducts <= static_cast<int>(duct_capacity), "fdva", "ducts", "a whole number from 1 to 6");
    demand(f.open_ducts >= 0 && f.open_ducts <= f.ducts, "fdva", "open_ducts", "a whole number from 0 to ducts");
  }

  const auto check_effect = [&](const auto& effect, std::optional<Channel> channel) {
    using Effect = std::remove_cvref_t<decltype(effect)>;
    const bool sound = !fault;
    demand(Effect::card.rigs.contains(rig.kind), Effect::card.name, "", "absent: this kind of rig has no such place");
    demand(!Effect::card.needs_fdva || rig.has_fdva, Effect::card.name, "", "absent: the rig has no FDVA");
    for (std::size_t i = 0; i < Effect::card.parameters.size(); ++i) {
      const auto& parameter = Effect::card.parameters[i];
      const S value = effect.*Effect::values[i];
      if (fault || (finite(value) && value >= S(parameter.lower) && value <= S(parameter.upper))) continue;
      fault = RigFault{Effect::card.name, parameter.name, "a number within the physical bounds of the effect"};
      fault->bounds = {parameter.lower, parameter.upper};
    }
    if (sound && fault) fault->channel = channel;
  };
  rig.effects.for_each([&](const auto& slot) {
    if (slot.active) check_effect(slot.effect, std::nullopt);
  });
  rig.effects.for_each_sensor([&](const auto& slot, Channel channel) {
    if (!slot.active || fault) return;
    check_effect(slot.effect, channel);
    if (!has_sensor(rig.kind, channel)) {
      fault = RigFault{std::remove_cvref_t<decltype(slot.effect)>::card.name, "",
                       "absent: this kind of rig has no sensor of that channel", channel};
    }
  });

  MachinePath<S> machine{};
  rig.effects.act_on(machine);
  if (!fault) {
    demand(machine.delay <= S(longest_delay) * period, "actuator_delay", "delay",
           "a delay within the capacity of the delay line at this sample rate");
  }
  std::size_t delayed = 0;
  rig.effects.for_each_sensor([&](const auto& slot, Channel channel) {
    if constexpr (requires { slot.effect.delay; }) {
      if (!slot.active || fault) return;
      if (++delayed > delayed_sensors) {
        fault = RigFault{"sensor_delay", "", "absent: at most two sensors of a rig may have a delay", channel};
      } else if (slot.effect.delay > S(sensor_delay_capacity - 4) * period) {
        fault = RigFault{"sensor_delay", "delay", "a delay within the capacity of the delay line at this sample rate",
                         channel};
      }
    }
  });
  return fault;
}

}  // namespace model
