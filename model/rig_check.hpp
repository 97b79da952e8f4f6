// Validates the parameters of a rig (included by rig_model.hpp).
#pragma once

#include "model/rig_model.hpp"

namespace model {

/// Whether a channel of this kind of rig has a sensor, whose reading can differ from the true value. In a hil rig body,
/// wheel and road are computed, hence exact.
[[nodiscard]] constexpr bool has_sensor(RigKind kind, Channel channel) {
  const bool machine = channel == Channel::F || channel == Channel::x_act;
  return kind == RigKind::quarter_car ? !machine && channel != Channel::x_cmd && channel != Channel::F_act : machine;
}

/// What find_fault() reads of a card: a board's program carries no more of it.
struct ParameterBounds {
  std::string_view name;
  double lower, upper;
};
template <class Effect>
inline constexpr auto parameter_bounds = [] {
  std::array<ParameterBounds, Effect::values.size()> bounds{};
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const EffectParameter& parameter = Effect::card.parameters[i];
    bounds[i] = {parameter.name, parameter.lower, parameter.upper};
  }
  return bounds;
}();

/// The parameter of an effect that has this value.
template <class Effect, class S>
[[nodiscard]] std::string_view name_of_value(const Effect& effect, S value) {
  for (std::size_t i = 0; i < Effect::values.size(); ++i) {
    if (effect.*Effect::values[i] == value) return parameter_bounds<Effect>[i].name;
  }
  return {};
}

/// The first effect whose delay does not fit into the delay lines of machine and sensors.
template <class S, LawCapacity laws>
std::optional<RigFault> find_long_delay(const RigParameters<S, laws>& rig, S period, std::size_t longest_delay) {
  constexpr std::string_view expected = "a delay within the capacity of the delay line at this sample rate";
  std::optional<RigFault> fault;
  rig.effects.for_each([&](const auto& slot) {
    MachinePath<S> machine{};
    if constexpr (requires { slot.effect.act_on(machine); }) {
      if (!slot.active || fault) return;
      slot.effect.act_on(machine);
      if (machine.delay > S(longest_delay) * period) {
        fault = RigFault{slot.effect.card.name, name_of_value(slot.effect, machine.delay), expected};
      }
    }
  });
  std::size_t delayed = 0;
  rig.effects.for_each_sensor([&](const auto& slot, Channel channel) {
    if (!slot.active || fault) return;
    SensorPath<S> sensor{};
    slot.effect.act_on(sensor);
    if (!(sensor.delay > S(0))) return;
    if (++delayed > delayed_sensors) {
      fault = RigFault{slot.effect.card.name, "", "absent: at most two sensors of a rig may have a delay", channel};
    } else if (sensor.delay > S(sensor_delay_capacity - 4) * period) {
      fault = RigFault{slot.effect.card.name, name_of_value(slot.effect, sensor.delay), expected, channel};
    }
  });
  return fault;
}

/// Whether the first `count` of these numbers are finite and ascend.
template <class Numbers>
[[nodiscard]] bool ascends(const Numbers& at, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!(at[i] - at[i] == 0) || (i > 0 && !(at[i] > at[i - 1]))) return false;
  }
  return true;
}

/// Whether this kind of rig has the place of a law.
[[nodiscard]] constexpr bool has_place(RigKind kind, bool has_fdva, LawPlace place, Channel channel) {
  switch (place) {
    case LawPlace::suspension:
      return true;
    case LawPlace::tyre:
      return kind != RigKind::component_bench;
    case LawPlace::piston:
      return has_fdva;
    case LawPlace::body_guide:
    case LawPlace::wheel_guide:
      return kind == RigKind::quarter_car;
    case LawPlace::sensor:
      return has_sensor(kind, channel);
  }
  return false;
}

/// The first law that is none.
template <class S, LawCapacity capacity>
std::optional<RigFault> find_law_fault(const RigParameters<S, capacity>& rig) {
  std::optional<RigFault> fault;
  if constexpr (capacity.any()) {
    const auto demand = [&fault](bool holds, std::string_view key, std::string_view expected) {
      if (!holds && !fault) fault = RigFault{"laws", key, expected};
    };
    const auto finite = [](S value) { return value - value == S(0); };
    const auto place = [&](LawPlace p, Channel channel = {}) {
      demand(has_place(rig.kind, rig.has_fdva, p, channel), "place", "a place that this kind of rig has");
    };
    const auto& laws = rig.laws;
    demand(laws.curve_count <= capacity.curves && laws.surface_count <= capacity.surfaces &&
               laws.branch_count <= capacity.branches,
           "", "at most as many laws as there is room for");
    for (std::size_t i = 0; i < laws.curve_count && !fault; ++i) {
      const CurveTable<S>& curve = laws.curves[i];
      place(curve.place, curve.channel);
      demand(curve.count >= 2 && curve.count <= curve_points && ascends(curve.at, curve.count), "at",
             "2 to 33 ascending numbers");
      for (std::size_t j = 0; j < curve.count && !fault; ++j) demand(finite(curve.value[j]), "value", "finite numbers");
    }
    for (std::size_t i = 0; i < laws.surface_count && !fault; ++i) {
      const SurfaceTable<S>& surface = laws.surfaces[i];
      place(surface.place);
      demand(surface.place != LawPlace::sensor, "place", "a place where a force acts");
      demand(surface.rows >= 2 && surface.rows <= surface_points && ascends(surface.deflection, surface.rows), "at",
             "2 to 17 ascending numbers");
      demand(surface.columns >= 2 && surface.columns <= surface_points && ascends(surface.velocity, surface.columns),
             "at_2", "2 to 17 ascending numbers");
      for (std::size_t j = 0; j < surface.rows && !fault; ++j) {
        for (std::size_t k = 0; k < surface.columns; ++k)
          demand(finite(surface.value[j][k]), "value", "finite numbers");
      }
    }
    for (std::size_t i = 0; i < laws.branch_count && !fault; ++i) {
      const BranchNumbers<S>& branch = laws.branches[i];
      place(branch.place);
      demand(branch.place != LawPlace::sensor, "place", "a place where a force acts");
      demand(finite(branch.stiffness) && branch.stiffness > S(0), "stiffness", "a finite number > 0");
      demand(finite(branch.time_constant) && finite(branch.slip_force) &&
                 (branch.time_constant > S(0)) != (branch.slip_force > S(0)),
             "time_constant", "either time_constant or slip_force > 0");
      demand(finite(branch.gap) && (branch.slip_force > S(0) ? branch.gap >= S(0) : !(branch.gap != S(0))), "gap",
             "0 or more, of a slider");
    }
  }
  return fault;
}

template <class S, LawCapacity laws>
std::optional<RigFault> find_fault(const RigParameters<S, laws>& rig, S period, std::size_t longest_delay) {
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
    for (std::size_t i = 0; i < Effect::values.size(); ++i) {
      const ParameterBounds& bounds = parameter_bounds<Effect>[i];
      const S value = effect.*Effect::values[i];
      if (fault || (finite(value) && value >= S(bounds.lower) && value <= S(bounds.upper))) continue;
      fault = RigFault{Effect::card.name, bounds.name, "a number within the physical bounds of the effect"};
      fault->bounds = {bounds.lower, bounds.upper};
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

  if (!fault) fault = find_law_fault(rig);
  if (!fault) fault = find_long_delay(rig, period, longest_delay);
  return fault;
}

}  // namespace model
