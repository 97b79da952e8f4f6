// One period of virtual car, compensation and simulated machine, in the order of ControlLoop.
#pragma once

#include "firmware/loop/area_control.hpp"
#include "firmware/loop/compensation/compensation.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

/// A hil rig with a compensation between car and machine; without one the machine is told the car's deflection.
struct CompensatedParts {
  const model::VirtualCar<double>& car;
  model::VirtualCar<double>::State& car_state;
  const model::RigModel<>& hardware;  ///< test machine and component
  model::RigModel<>::State& hardware_state;
  const AreaControl<true>& area;  ///< of an active air spring
  Compensation* compensation = nullptr;
};

struct CompensatedPeriod {
  double measured{};              ///< force at t_k, times the factor [N]
  Compensation::Answer answer{};  ///< the command for t_{k+1}
};

/// From t_k to t_{k+1}.
/// \param road          foot point at t_{k+1}
/// \param force_factor  of the measured force, before the compensation
inline CompensatedPeriod step_compensated(const CompensatedParts& loop, const model::Motion<double>& road,
                                          int open_ducts, double force_factor = 1.0) {
  if (loop.area.wanted()) {
    const double velocity = loop.car_state.core(model::CoreIndex::body_velocity);
    loop.hardware.command_area(loop.hardware_state, loop.area.command(velocity));
  }
  const auto shown = loop.hardware.measured(loop.hardware_state);
  CompensatedPeriod period;
  period.measured = force_factor * shown[model::index(model::Channel::F)];
  loop.car.receive_force(loop.car_state,
                         loop.compensation != nullptr ? loop.compensation->force(period.measured) : period.measured);
  loop.car.step(loop.car_state, {.foot_point = road});
  const auto deflection = loop.car.deflection(loop.car_state);
  const auto wanted = loop.car.component_stroke(deflection);
  const auto signals = loop.car.signals(loop.car_state);
  const double acceleration = loop.car.component_acceleration(
      deflection, signals[model::index(model::Channel::zdd_w)] - signals[model::index(model::Channel::zdd_b)]);
  auto& command = period.answer.command;
  command = {wanted.position, wanted.velocity, acceleration};
  if (loop.compensation != nullptr) {
    period.answer = loop.compensation->command({.wanted = {wanted.position, wanted.velocity, acceleration},
                                                .commanded = loop.hardware_state.command.position,
                                                .reached = shown[model::index(model::Channel::x_act)],
                                                .measured = true,
                                                .open_ducts = open_ducts});
  }
  loop.hardware.step(loop.hardware_state, {.command = {command.position, command.velocity}});
  return period;
}

}  // namespace firmware
