#include <array>
#include <cmath>

#include "firmware/description/rig_description.hpp"

namespace firmware {
namespace {

using Rig = model::RigParameters<double>;

constexpr std::array<ParameterPath, 25> paths{{
    {"body", "mass", "kg", [](Rig& r) -> double& { return r.body.mass; }},
    {"wheel", "mass", "kg", [](Rig& r) -> double& { return r.wheel.mass; }},
    {"tyre", "stiffness", "N/m", [](Rig& r) -> double& { return r.tyre.stiffness; }},
    {"tyre", "damping", "N s/m", [](Rig& r) -> double& { return r.tyre.damping; }},
    {"suspension", "stiffness", "N/m", [](Rig& r) -> double& { return r.suspension.stiffness; }},
    {"suspension", "damping", "N s/m", [](Rig& r) -> double& { return r.suspension.damping; }},
    {"machine", "virtual_damping", "N s/m", [](Rig& r) -> double& { return r.machine.virtual_damping; }},
    {"air_spring", "pressure", "Pa", [](Rig& r) -> double& { return r.air_spring.pressure; }},
    {"air_spring", "area", "m²", [](Rig& r) -> double& { return r.air_spring.area; }},
    {"air_spring", "volume", "m³", [](Rig& r) -> double& { return r.air_spring.volume; }},
    {"air_spring", "area_per_stroke", "m", [](Rig& r) -> double& { return r.air_spring.area_per_stroke; }},
    {"air_spring", "volume_per_area", "m³", [](Rig& r) -> double& { return r.air_spring.volume_per_area; }},
    {"air_spring", "polytropic_exponent", "1", [](Rig& r) -> double& { return r.air_spring.polytropic_exponent; }},
    {"air_spring", "heat_time", "s", [](Rig& r) -> double& { return r.air_spring.heat_time; }},
    {"air_spring", "counter_pressure", "Pa", [](Rig& r) -> double& { return r.air_spring.counter_pressure; }},
    {"air_spring", "counter_area", "m²", [](Rig& r) -> double& { return r.air_spring.counter_area; }},
    {"air_spring", "counter_volume", "m³", [](Rig& r) -> double& { return r.air_spring.counter_volume; }},
    {"air_spring", "actuator_frequency", "Hz", [](Rig& r) -> double& { return r.air_spring.actuator_frequency; }},
    {"fdva", "piston_area", "m²", [](Rig& r) -> double& { return r.fdva.piston_area; }},
    {"fdva", "duct_diameter", "m", [](Rig& r) -> double& { return r.fdva.duct_diameter; }},
    {"fdva", "duct_length", "m", [](Rig& r) -> double& { return r.fdva.duct_length; }},
    {"fdva", "oil_density", "kg/m³", [](Rig& r) -> double& { return r.fdva.oil_density; }},
    {"fdva", "oil_viscosity", "m²/s", [](Rig& r) -> double& { return r.fdva.oil_viscosity; }},
    {"fdva", "minor_loss", "1", [](Rig& r) -> double& { return r.fdva.minor_loss; }},
    {"fdva", "coupling_stiffness", "N/m", [](Rig& r) -> double& { return r.fdva.coupling_stiffness; }},
}};

/// Takes "table." from the beginning of a path, if that is there.
bool take(std::string_view& path, std::string_view table) {
  if (!path.starts_with(table) || path.size() <= table.size() || path[table.size()] != '.') return false;
  path.remove_prefix(table.size() + 1);
  return true;
}

}  // namespace

std::span<const ParameterPath> parameter_paths() { return paths; }

bool has_part(const Rig& rig, std::string_view table) {
  if (table == "fdva") return rig.has_fdva;
  if (table == "air_spring") return rig.air_spring.fitted;
  if (table == "machine") return rig.kind == model::RigKind::hil;
  if (rig.kind == model::RigKind::driven_mass) return table == "suspension" || table == "body";
  return table == "suspension" || rig.kind != model::RigKind::component_bench;
}

double* find_parameter(model::RigParameters<double>& rig, std::string_view path) {
  for (const auto& p : paths) {
    std::string_view key = path;
    if (take(key, p.table) && key == p.key) return has_part(rig, p.table) ? &p.value(rig) : nullptr;
  }
  if (!take(path, "effects")) return nullptr;
  double* found = nullptr;
  const auto look = [&found](auto& slot, std::string_view key) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    for (std::size_t i = 0; i < Effect::card.parameters.size(); ++i) {
      if (key == Effect::card.parameters[i].name) found = &(slot.effect.*Effect::values[i]);
    }
  };
  rig.effects.for_each([&](auto& slot) {
    std::string_view key = path;
    if (slot.active && take(key, slot.effect.card.name)) look(slot, key);
  });
  rig.effects.for_each_sensor([&](auto& slot, model::Channel channel) {
    std::string_view key = path;
    if (slot.active && take(key, slot.effect.card.name) && take(key, model::name(channel))) look(slot, key);
  });
  return found;
}

const double* find_parameter(const Rig& rig, std::string_view path) {
  // Nothing is written to it. NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast)
  return find_parameter(const_cast<Rig&>(rig), path);
}

std::optional<model::RigFault> find_rig_fault(const model::RigParameters<double>& rig, double period) {
  if (const auto fault = model::find_fault(rig, period, model::RigModel<>::Line::longest)) return fault;
  // A time constant that no sample could show, but whose inverse the same exact step would have to bear.
  constexpr double shortest = 1e-9;  // [s]
  std::optional<model::RigFault> too_short;
  const auto check = [&too_short](const auto& slot, std::optional<model::Channel> channel) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    for (std::size_t i = 0; slot.active && i < Effect::values.size(); ++i) {
      const auto& card = Effect::card.parameters[i];
      const double value = slot.effect.*Effect::values[i];
      if (card.unit == "s" && value > 0.0 && value < shortest) {
        too_short = model::RigFault{Effect::card.name, card.name, "0, or at least 1e-9 s", channel};
      }
    }
  };
  rig.effects.for_each([&check](const auto& slot) { check(slot, std::nullopt); });
  rig.effects.for_each_sensor([&check](const auto& slot, model::Channel channel) { check(slot, channel); });
  if (too_short) return too_short;
  // What one unit of anything changes in a period. Beyond this limit the matrices of an exact step have no digit left.
  constexpr double largest = 1e8;
  using Equations = model::RigEquations<double>;
  const Equations equations(rig);
  bool resolved = true;
  const auto take = [&resolved, period](const auto& rates) {
    for (Eigen::Index i = 0; i < rates.size(); ++i) resolved = resolved && std::abs(rates(i)) * period <= largest;
  };
  for (int open = 0; open <= (rig.has_fdva ? rig.fdva.ducts : 0); ++open) {
    if (rig.kind == model::RigKind::component_bench) {
      using State = Equations::ComponentState;
      for (int j = 0; j < State::RowsAtCompileTime; ++j) take(equations.component(State::Unit(j), {}, open));
      take(equations.component(State::Zero(), {.minor_losses = 1e-4}, open));  // a duct's flow is below 10 l/s
    } else {
      using State = Equations::JoinedState;
      for (int j = 0; j < State::RowsAtCompileTime; ++j) take(equations.joined(State::Unit(j), {}, open));
      take(equations.joined(State::Zero(), {.minor_losses = 1e-4}, open));
    }
  }
  if (resolved) return std::nullopt;
  return model::RigFault{"", "", "stiffnesses, dampings and masses that a step of this length can resolve"};
}

model::RigParameters<double> on_its_car(const model::RigParameters<double>& component_bench) {
  model::RigParameters<double> car = component_bench;
  car.kind = model::RigKind::quarter_car;
  if (car.body.mass == 0.0) car.body.mass = 290.0;
  if (car.wheel.mass == 0.0) car.wheel.mass = 40.0;
  if (car.tyre.stiffness == 0.0) {
    car.tyre.stiffness = 200e3;
    car.tyre.damping = 100.0;
  }
  car.suspension.damping += 1140.0;
  car.effects = {};
  car.delay_variation = {};
  return car;
}

}  // namespace firmware
