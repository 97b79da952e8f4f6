// Validates the parameters of a rig (included by rig_model.hpp).
#pragma once

#include "model/rig/rig_model.hpp"

namespace model {

/// Whether a channel of this kind of rig has a sensor, whose reading can differ from the true value. In a hil rig body,
/// wheel and road are computed, hence exact.
[[nodiscard]] constexpr bool has_sensor(RigKind kind, Channel channel) {
  const bool machine = channel == Channel::F || channel == Channel::x_act;
  const bool told = channel == Channel::x_cmd || channel == Channel::z_cmd || channel == Channel::F_act;
  if (kind == RigKind::driven_mass) return machine || channel == Channel::zdd_b;
  return kind == RigKind::quarter_car ? !machine && !told : machine;
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
      if (machine.delay + rig.delay_variation.farthest() > S(longest_delay) * period) {
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

/// true: the first `count` numbers nowhere fall.
template <class Numbers>
[[nodiscard]] bool rises(const Numbers& value, std::size_t count) {
  for (std::size_t i = 1; i < count; ++i) {
    if (!(value[i] >= value[i - 1])) return false;
  }
  return true;
}

/// Whether this kind of rig has the place of a law.
[[nodiscard]] constexpr bool has_place(RigKind kind, bool has_fdva, LawPlace place, Channel channel) {
  switch (place) {
    case LawPlace::suspension:
      return true;
    case LawPlace::tyre:
      return kind == RigKind::quarter_car || kind == RigKind::hil;
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
      demand(finite(curve.behind) && curve.behind >= S(0) &&
                 (!(curve.behind > S(0)) || (curve.place != LawPlace::sensor && rises(curve.value, curve.count))),
             "behind", "a stiffness > 0, of a force that nowhere falls");
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

/// The first number of an air spring, a lever or a delay that varies which is none.
template <class S, LawCapacity capacity>
std::optional<RigFault> find_extension_fault(const RigParameters<S, capacity>& rig, S period,
                                             std::size_t longest_delay) {
  std::optional<RigFault> fault;
  if constexpr (capacity.extensions) {
    const auto demand = [&fault](bool holds, std::string_view table, std::string_view key, std::string_view expected) {
      if (!holds && !fault) fault = RigFault{table, key, expected};
    };
    const auto& a = rig.air_spring;
    const auto within = [&](S value, double lower, double upper, std::string_view key, std::string_view expected) {
      demand(value >= S(lower) && value <= S(upper), "air_spring", key, expected);
    };
    if (a.fitted) {
      within(a.pressure, 1e4, 5e6, "pressure", "the gauge pressure at rest, 1e4 to 5e6 Pa");
      within(a.ambient_pressure, 0.0, 2e5, "ambient_pressure", "0 to 2e5 Pa");
      within(a.area, 1e-5, 1.0, "area", "1e-5 to 1 m^2");
      within(a.volume, 1e-6, 1.0, "volume", "1e-6 to 1 m^3");
      within(a.area_per_stroke, -1.0, 1.0, "area_per_stroke", "-1 to 1 m");
      within(a.volume_per_area, -1.0, 1.0, "volume_per_area", "-1 to 1 m^3");
      within(a.polytropic_exponent, 1.0, 1.67, "polytropic_exponent", "1 (isothermal) to 1.67 (monatomic gas)");
      within(a.heat_time, 1e-3, 1e6, "heat_time", "1e-3 to 1e6 s");
      within(a.counter_pressure, 0.0, 5e6, "counter_pressure", "0 to 5e6 Pa");
      within(a.counter_area, 0.0, 1.0, "counter_area", "0 (single bellows) to 1 m^2");
      demand(!(a.counter_area > S(0)) || (a.counter_volume >= S(1e-6) && a.counter_volume <= S(1)), "air_spring",
             "counter_volume", "1e-6 to 1 m^3, where there is a second bellows");
      within(a.actuator_frequency, 0.01, 1e3, "actuator_frequency", "0.01 to 1000 Hz");
      within(a.actuator_damping, 0.0, 20.0, "actuator_damping", "0 (first order) to 20");
      within(a.actuator_rate, 0.0, 1e3, "actuator_rate", "0 (none) to 1000 1/s");
      within(a.actuator_stroke, 0.0, 0.5, "actuator_stroke", "a relative change of the area, 0 to 0.5");
      within(a.skyhook, 0.0, 1e6, "skyhook", "0 to 1e6 N s/m");
      within(a.levelling_rate, 0.0, 1.0, "levelling_rate", "0 (none) to 1 1/s");
      within(a.levelling_band, 1e-5, 1.0, "levelling_band", "1e-5 to 1 m");
      within(a.levelling_time, 1e-3, 1e4, "levelling_time", "1e-3 to 1e4 s");
      const AirSpringCondition<S> condition = condition_of_air_spring(rig);
      demand(AirSpring<S>::stiffness(a, S(1)) > S(0), "air_spring", "area_per_stroke",
             "a spring whose stiffness at rest is above 0");
      demand(!(a.skyhook > S(0)) || AirSpring<S>::force_per_area(a, condition.polytropic_exponent) > S(0), "air_spring",
             "volume_per_area", "a force that grows with the area: at rest its volume takes more than its area gives");
    }
    const auto& lever = rig.lever;
    if (lever.any()) {
      demand(rig.kind == RigKind::quarter_car || rig.kind == RigKind::hil, "lever", "",
             "absent: a component_bench has no axle");
      demand(lever.count >= 2 && lever.count <= lever_points && ascends(lever.at, lever.count), "lever", "at",
             "2 to 9 ascending numbers");
      for (std::size_t i = 0; i < lever.count && !fault; ++i) {
        demand(lever.ratio[i] >= S(0.1) && lever.ratio[i] <= S(10), "lever", "ratio", "0.1 to 10");
      }
      if (rig.kind == RigKind::quarter_car) {
        SuspensionComponent<S> component{};
        rig.effects.act_on(component);
        bool law_at_suspension = false;
        for (std::size_t i = 0; i < rig.laws.curve_count; ++i) {
          law_at_suspension = law_at_suspension || rig.laws.curves[i].place == LawPlace::suspension;
        }
        for (std::size_t i = 0; i < rig.laws.surface_count; ++i) {
          law_at_suspension = law_at_suspension || rig.laws.surfaces[i].place == LawPlace::suspension;
        }
        for (std::size_t i = 0; i < rig.laws.branch_count; ++i) {
          law_at_suspension = law_at_suspension || rig.laws.branches[i].place == LawPlace::suspension;
        }
        demand(!law_at_suspension && !(component.dry_friction > S(0)) && !(component.mount_stiffness > S(0)) &&
                   !(component.free_play > S(0)),
               "lever", "", "absent, beside dry friction, a top mount, backlash or a law of the suspension");
      }
    }
    const auto& v = rig.delay_variation;
    if (v.any() || v.swing != S(0) || v.jitter != S(0)) {
      demand(rig.kind == RigKind::hil || rig.kind == RigKind::component_bench, "machine", "delay_swing",
             "absent: the machine of a quarter_car has a steady delay, and a force that drives a mass has none");
      demand(v.swing >= S(0) && v.swing <= S(0.1), "machine", "delay_swing", "0 to 0.1 s");
      demand(v.time >= S(0.01) && v.time <= S(1e6), "machine", "delay_swing_time", "0.01 to 1e6 s");
      demand(v.jitter >= S(0) && v.jitter <= S(0.1), "machine", "delay_jitter", "0 to 0.1 s");
      demand(v.farthest() <= S(longest_delay) * period, "machine", "delay_swing",
             "a delay within the capacity of the delay line at this sample rate");
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
  if (rig.kind != RigKind::component_bench) positive(rig.body.mass, "body", "mass");
  if (rig.kind == RigKind::driven_mass) {
    demand(rig.wheel.mass == S(0) && rig.tyre.stiffness == S(0) && rig.tyre.damping == S(0), "wheel", "mass",
           "absent: a mass that a force drives has no wheel and no tyre");
  } else if (rig.kind != RigKind::component_bench) {
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
    demand(!Effect::card.needs_air_spring || rig.air_spring.fitted, Effect::card.name, "",
           "absent: the rig has no air spring");
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
  if (!fault) fault = find_extension_fault(rig, period, longest_delay);
  if (!fault) fault = find_long_delay(rig, period, longest_delay);
  return fault;
}

}  // namespace model
