// The values of a state that one step of the model reads, and the derivatives of that step at rest.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "model/rig/rig_model.hpp"

namespace host_sim::stability {

/// The step is not linear, but has derivatives at rest.
[[nodiscard]] inline bool is_nonlinear(const model::RigParameters<double>& rig) {
  return rig.lever.any() || rig.air_spring.fitted;
}

/// d response/d unit at 0. `response`: a vector of a value moved by `unit` from rest. A linear one moves by `whole`; a
/// nonlinear one by ± 1e-6 [m, m/s, N, 1]: the third order leaves 1e-10 of a slope, rounding beside a pressure of 1 as
/// much.
template <class Response>
[[nodiscard]] Eigen::VectorXd slope(const model::RigParameters<double>& rig, const Response& response,
                                    double whole = 1.0) {
  constexpr double small = 1e-6;
  if (!is_nonlinear(rig)) return response(whole) / whole;
  const Eigen::VectorXd up = response(small), down = response(-small);
  return (up - down) / (2.0 * small);
}

/// Number of samples of a delay line that later steps still read: a step pushes one sample, then reads the samples at
/// the whole part of the delay and one before it.
[[nodiscard]] inline std::size_t samples_read(double delay, double period) {
  return delay > 0.0 ? static_cast<std::size_t>(delay / period + 1e-9) + 1 : 0;
}

/// Calls visit(value, is_force) for every value of machine, component laws and sensor of F that a step reads, except
/// the core and the machine's delay line. The sensor of F is the only one left in a linear rig.
template <class Visit>
void for_each_behind_the_car(const model::RigModel<>& model, model::RigModel<>::State& x, const Visit& visit) {
  for (Eigen::Index i = 0; i < x.machine.size(); ++i) visit(x.machine(i), false);
  for (model::Stroke<double>* stroke : {&x.delayed, &x.reached}) {
    visit(stroke->position, false);
    visit(stroke->velocity, false);
  }
  auto& sensor = x.sensors.channels[model::index(model::Channel::F)];
  for (double* value : {&x.received_force, &sensor.lagged, &sensor.held}) visit(*value, true);
  for (double& value : sensor.input) visit(value, true);
  // Its line is read by the four samples around the delay.
  const double delay = model.parameters().effects.sensor_paths()[model::index(model::Channel::F)].delay;
  const std::size_t samples = delay > 0.0 ? samples_read(delay, model.period()) + 2 : 0;
  for (std::size_t i = 0; i < samples; ++i) visit(x.sensors.lines[0].ago(i), true);
  if (!model.parameters().air_spring.fitted) return;
  auto& a = x.air_spring;
  for (double* value : {&a.first.excess, &a.first.target, &a.second.excess, &a.second.target, &a.area, &a.rate}) {
    visit(*value, false);
  }
  auto& load = x.suspension_load;
  for (double* value : {&load.now, &load.before, &load.earlier}) visit(*value, true);
}

}  // namespace host_sim::stability
