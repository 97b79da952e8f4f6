#include "host_sim/replicate/motion_inverse.hpp"

#include <cstddef>
#include <type_traits>
#include <utility>

#include "firmware/simulation/road.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::replicate {
namespace {

using model::Channel;
using Rig = model::RigParameters<double>;

/// True values: without the effects of sensors, and without the mass beyond the one of F_w.
Rig without_sensors(Rig rig) {
  rig.effects.for_each_sensor([](auto& slot, Channel) { slot.active = false; });
  rig.effects.for_each([](auto& slot) {
    if constexpr (model::ActsOn<std::remove_cvref_t<decltype(slot.effect)>, model::WheelLoadSensor<double>>)
      slot.active = false;
  });
  return rig;
}

}  // namespace

bool MotionInverse::possible(const DriveModel& model) { return model.rig().kind == model::RigKind::quarter_car; }

MotionInverse::MotionInverse(const DriveModel& model, const BandInverse& inverse) : model_(model), inverse_(inverse) {
  const DriveModel truth(without_sensors(model.rig()), model.period(),
                         {Channel::z_w, Channel::z_r, Channel::dz_w, Channel::F_w});
  auto responses = truth.linear_response(inverse.transform().length());
  const Bins &reached = responses[1], &deflection = responses[2], &force = responses[3];
  wheel_ = std::move(responses[0]);
  of_wheel_.assign(wheel_.size(), 0.0);
  of_load_ = of_wheel_;
  for (std::size_t k = 1; k < wheel_.size(); ++k) {
    const double share = inverse.share(k), omega = full_turn * inverse.frequency_step() * static_cast<double>(k);
    if (!(share > 0.0) || force[k] == 0.0 || reached[k] == 0.0) continue;
    const std::complex<double> compliance = deflection[k] / force[k];
    of_wheel_[k] = (1.0 - model.rig().wheel.mass * omega * omega * compliance) / reached[k];
    of_load_[k] = share * compliance / reached[k];
  }
}

std::vector<double> MotionInverse::load(const Rig& bare, const std::vector<double>& wheel) const {
  SimulationInput input;
  input.period = model_.period();
  input.motion = firmware::through_samples(wheel, 1.0 / input.period);
  input.deflection_reached = input.wheel_prescribed = true;
  Response response = simulate(bare, input, resting(bare, input), 0, 1, {Channel::F_w, Channel::zdd_w});
  std::vector<double> load = std::move(response[index(Channel::F_w)]);
  const std::vector<double>& acceleration = response[index(Channel::zdd_w)];
  for (std::size_t k = 0; k < load.size(); ++k) load[k] -= bare.wheel.mass * acceleration[k];
  return load;
}

std::vector<double> MotionInverse::drive(const Rig& rig, const std::vector<double>& from,
                                         const std::vector<std::vector<double>>& errors) const {
  RealTransform& transform = inverse_.transform();
  const Rig bare = without_sensors(rig);
  const auto linear = transform(inverse_.drive(errors));
  Bins change(linear.begin(), linear.end());
  for (std::size_t k = 0; k < change.size(); ++k) change[k] *= wheel_[k];
  const std::vector<double> moved = transform.inverse(change);
  Response response = model_.response(bare, from, {Channel::z_w});
  std::vector<double>& wheel = response[index(Channel::z_w)];
  std::vector<double> before = load(bare, wheel);
  for (std::size_t k = 0; k < wheel.size(); ++k) wheel[k] += moved[k];
  std::vector<double> more = load(bare, wheel);
  for (std::size_t k = 0; k < more.size(); ++k) more[k] -= before[k];
  const auto loads = transform(more);
  for (std::size_t k = 0; k < change.size(); ++k) change[k] = of_wheel_[k] * change[k] + of_load_[k] * loads[k];
  std::vector<double> drive = transform.inverse(change);
  drive.resize(from.size());
  inverse_.end_at_rest(drive);
  return drive;
}

}  // namespace host_sim::replicate
