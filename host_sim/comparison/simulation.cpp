#include "host_sim/comparison/simulation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/loop/area_control.hpp"
#include "host_sim/comparison/lane_simulation.hpp"
#include "host_sim/comparison/measured_motion.hpp"
#include "host_sim/comparison/simulation_loop.hpp"
#include "model/components/sensors.hpp"

namespace host_sim {
namespace {

using model::Channel;
using model::RigKind;
using Rig = model::RigParameters<double>;

/// What is known to have been reached needs no machine.
void leave_out_machine(Rig& rig) {
  rig.delay_variation = {};
  rig.effects.for_each([](auto& slot) {
    if (std::remove_cvref_t<decltype(slot.effect)>::card.subsystem == model::Subsystem::machine) slot.active = false;
  });
}

/// The area that the skyhook of the control loop has commanded, from the body's displacement.
std::vector<double> commanded_area(const Rig& rig, const std::vector<double>& body, double period) {
  const firmware::AreaControl<true> control(rig);
  if (!control.wanted() || body.size() < 5) return {};
  std::vector<double> area(body.size());
  for (std::size_t k = 0; k < body.size(); ++k) {
    const std::size_t c = std::clamp<std::size_t>(k, 2, body.size() - 3);  // at the ends that of the nearest sample
    const double velocity = (8.0 * (body[c + 1] - body[c - 1]) - (body[c + 2] - body[c - 2])) / (12.0 * period);
    area[k] = control.command(velocity);
  }
  return area;
}

/// On a wheel that moves as prescribed: a tyre so stiff that the wheel follows within (ω² m_w/k = 3e-5 at 40 Hz), at
/// critical damping, without effects of its own. F_w is then what it takes to move the wheel so.
void put_on_prescribed_wheel(Rig& rig) {
  constexpr double stiffness = 1e11;  // [N/m]
  rig.tyre.stiffness = stiffness;
  rig.tyre.damping = 2.0 * std::sqrt(stiffness * rig.wheel.mass);
  rig.effects.for_each([](auto& slot) {
    if (std::remove_cvref_t<decltype(slot.effect)>::card.subsystem == model::Subsystem::tyre) slot.active = false;
  });
}

/// What moves between load cell and component: add_load_cell() has its force.
void leave_out_load_cell(Rig& rig) {
  rig.effects.for_each([](auto& slot) {
    if constexpr (model::ActsOn<std::remove_cvref_t<decltype(slot.effect)>, model::LoadCell<double>>) {
      slot.active = false;
    }
  });
}

double moving_mass(const Rig& rig) {
  model::LoadCell<double> cell{};
  rig.effects.act_on(cell);
  return cell.moving_mass;
}

/// A rig without load cell and sensor of F, both of which act behind a simulation.
Rig without_measured_force(Rig rig) {
  leave_out_load_cell(rig);
  rig.effects.for_each_sensor([](auto& slot, Channel channel) {
    if (channel == Channel::F) slot.active = false;
  });
  return rig;
}

/// The sensor of F over a force that was simulated without it.
void pass_sensor_of_force(const Rig& rig, double period, std::vector<double>& force) {
  std::array<model::SensorPath<double>, model::channel_count> paths{};
  paths[index(Channel::F)] = rig.effects.sensor_paths()[index(Channel::F)];
  const model::Sensors<double> sensors(paths, period);
  if (!sensors.any()) return;
  model::Sensors<double>::State state;
  model::Signals<double> signals{};
  for (std::size_t k = 0; k < force.size(); ++k) {
    signals[index(Channel::F)] = force[k];
    if (k == 0) {
      sensors.start(state, signals, nullptr);
    } else {
      sensors.step(state, signals, nullptr);
    }
    force[k] = sensors.reading(state, Channel::F, force[k]);
  }
}

}  // namespace

firmware::FootPointMotion motion_between(bool deflection_reached, const std::vector<double>& samples, double rate) {
  return deflection_reached ? measured_motion(samples, rate) : firmware::through_samples(samples, rate);
}

void add_load_cell(const Rig& rig, const SimulationInput& input, const RigVariation& variation, Response& response) {
  auto& force = response[index(Channel::F)];
  if (!input.deflection_reached || force.empty()) return;
  double mass = moving_mass(variation.every > 0 ? variation.at(0) : rig);
  if (!(mass > 0.0)) return;
  for (std::size_t k = 0; k < force.size(); ++k) {
    if (variation.every > 0 && k % variation.every == 0) mass = moving_mass(variation.at(k));
    force[k] += mass * input.motion[k].acceleration;
  }
}

Rig answering(const Rig& rig, const SimulationInput& input) {
  Rig answers = rig;
  if (input.deflection_reached) {
    leave_out_machine(answers);
    leave_out_load_cell(answers);
  }
  if (input.wheel_prescribed) put_on_prescribed_wheel(answers);
  return answers;
}

SimulationInput simulation_input(const Rig& rig, const firmware::Recording& recording) {
  SimulationInput input;
  input.period = recording.sample_period;
  const double rate = 1.0 / input.period;
  if (rig.kind == RigKind::component_bench) {
    input.deflection_reached = recording.has(Channel::x_act) && !recording.has(Channel::x_cmd);
    input.channel = input.deflection_reached ? Channel::x_act : Channel::x_cmd;
    const std::vector<double>& driving =
        recording.required(input.channel, "drives the simulation of a component_bench");
    input.motion = motion_between(input.deflection_reached, driving, rate);
    input.area = commanded_area(rig, recording[Channel::z_b], input.period);
  } else if (rig.kind == RigKind::driven_mass) {
    input.channel = Channel::F;
    input.motion = firmware::through_samples(recording.required(Channel::F, "drives the mass"), rate);
  } else {
    const bool car = rig.kind == RigKind::quarter_car;
    const bool commanded = car && recording.has(Channel::z_cmd);
    input.deflection_reached = car && !commanded;
    input.channel = commanded ? Channel::z_cmd : Channel::z_r;
    input.motion = firmware::through_samples(recording.required(input.channel, "drives the simulation"), rate);
    if (recording.has(Channel::zdd_r) && !commanded) {
      for (std::size_t k = 0; k < input.size(); ++k) input.motion[k].acceleration = recording[Channel::zdd_r][k];
    }
    if (recording.has(Channel::F_act)) input.actuator_force = recording[Channel::F_act];
  }
  if (rig.has_fdva) {
    bool recorded = false;
    std::vector<model::OpenDucts> ducts(recording.size(), model::first_ducts(rig.fdva.open_ducts));
    for (std::size_t j = 0; j < firmware::recorded_ducts; ++j) {
      const auto& column = recording.ducts[j];
      if (column.empty()) continue;
      recorded = true;
      for (std::size_t k = 0; k < column.size(); ++k) {
        const auto bit = static_cast<model::OpenDucts>(1U << j);
        ducts[k] = static_cast<model::OpenDucts>(column[k] > 0.5 ? ducts[k] | bit : ducts[k] & ~bit);
        if ((ducts[k] >> rig.fdva.ducts) != 0) {
          throw firmware::InputError(recording.source, 0, "duct_" + std::to_string(j + 1) + " is open",
                                     "at most the " + std::to_string(rig.fdva.ducts) + " ducts of the rig description");
        }
      }
    }
    if (recorded) input.ducts = std::move(ducts);
  }
  return input;
}

double size_of_motion(const Rig& rig, const SimulationInput& input, const firmware::Recording& recording) {
  double size = 0.0;
  if (!input.is_force()) {
    for (const auto& m : input.motion) size = std::max(size, std::abs(m.position));
    return size;
  }
  for (const double x : recording[Channel::x_act]) size = std::max(size, std::abs(x));
  if (size > 0.0) return size;
  double force = 0.0;
  for (const auto& m : input.motion) force = std::max(force, std::abs(m.position));
  constexpr double slow = 6.283185307179586 * 6.283185307179586;  // (2π · 1 Hz)²
  return force / std::max(rig.suspension.stiffness, slow * rig.body.mass);
}

std::vector<Channel> response_channels(RigKind kind, const SimulationInput& input) {
  switch (kind) {
    case RigKind::quarter_car:
      if (input.wheel_prescribed) return {Channel::z_b, Channel::zdd_b, Channel::dz_b, Channel::F_w};
      if (input.channel == Channel::z_cmd) {
        return {Channel::z_r,   Channel::z_w,  Channel::z_b,  Channel::zdd_r, Channel::zdd_w,
                Channel::zdd_b, Channel::dz_w, Channel::dz_b, Channel::F_w};
      }
      return {Channel::z_w, Channel::z_b, Channel::zdd_w, Channel::zdd_b, Channel::dz_w, Channel::dz_b, Channel::F_w};
    case RigKind::hil:
      return {Channel::z_w,  Channel::z_b, Channel::zdd_w, Channel::zdd_b, Channel::dz_w,
              Channel::dz_b, Channel::F_w, Channel::x_cmd, Channel::x_act, Channel::F};
    case RigKind::driven_mass:
      return {Channel::x_act, Channel::zdd_b};
    case RigKind::component_bench:
      break;
  }
  if (input.deflection_reached) return {Channel::F};
  return {Channel::x_act, Channel::F};
}

InitialState resting(const Rig& rig, const SimulationInput& input) {
  InitialState start = InitialState::Zero();
  const double first = input.motion.empty() ? 0.0 : input.motion.front().position;
  if (rig.kind == RigKind::driven_mass) return start;
  if (rig.kind == RigKind::component_bench) {
    start(4) = first;
  } else {
    start(0) = start(2) = first;
    if (input.wheel_prescribed && !input.motion.empty()) start(1) = start(3) = input.motion.front().velocity;
  }
  return start;
}

namespace {

/// simulate() with a model that has room for what the rig has.
template <class Model>
Response simulated(const Rig& rig, const SimulationInput& input, const InitialState& start, std::size_t samples,
                   int substeps, const std::vector<Channel>& channels, const RigVariation& variation) {
  SimulationLoop<Model> loop(substeps);
  loop.become(answering(variation.every > 0 ? variation.at(0) : rig, input), input.period);
  const std::size_t count = samples == 0 ? input.size() : std::min(samples, input.size());
  Response response;
  for (const Channel channel : channels) response[index(channel)].resize(count);
  if (count == 0) return response;
  loop.start(input, start);
  for (std::size_t k = 0;; ++k) {
    const auto measured = loop.measured();
    for (const Channel channel : channels) response[index(channel)][k] = measured[index(channel)];
    if (k + 1 == count) return response;
    if (k > 0 && variation.every > 0 && k % variation.every == 0) {
      loop.become(answering(variation.at(k), input), input.period);
    }
    loop.advance(input, k);
  }
}

}  // namespace

Response simulate(const Rig& rig, const SimulationInput& input, const InitialState& start, std::size_t samples,
                  int substeps, const RigVariation& variation) {
  return simulate(rig, input, start, samples, substeps, response_channels(rig.kind, input), variation);
}

Response simulate(const Rig& rig, const SimulationInput& input, const InitialState& start, std::size_t samples,
                  int substeps, const std::vector<Channel>& channels, const RigVariation& variation) {
  if (input.deflection_reached && moving_mass(rig) > 0.0) {
    // Its force is that of the measured acceleration, which the model's step, knowing the past alone, has less exactly.
    const Rig bare = without_measured_force(rig);
    RigVariation varied = variation;
    if (variation.every > 0) {
      varied.at = [&](std::size_t k) { return without_measured_force(variation.at(k)); };
    }
    Response response = simulate(bare, input, start, samples, substeps, channels, varied);
    add_load_cell(rig, input, variation, response);
    pass_sensor_of_force(rig, input.period, response[index(Channel::F)]);
    return response;
  }
  if (rig.laws.any() || rig.has_extensions()) {
    return simulated<model::RigModel<>>(rig, input, start, samples, substeps, channels, variation);
  }
  return simulated<PlainModel>(rig, input, start, samples, substeps, channels, variation);
}

}  // namespace host_sim
