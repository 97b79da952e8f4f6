#include "firmware/loop/hil_interface.hpp"

#include <bit>
#include <limits>

namespace firmware {

using model::Channel;
using model::CoreIndex;

HilInterface::HilInterface(const Settings& settings, const model::RigParameters<double>& parameters, double period)
    : period_(period),
      force_ramp_(settings.arming.force_ramp),
      energy_guard_(settings.limits, parameters.machine.virtual_damping, parameters.tyre.damping, period,
                    settings.supervision.growth_time) {
  if (parameters.kind == model::RigKind::hil) car_.emplace(parameters, period, model::ModelledPart::virtual_car);
}

void HilInterface::start(const Motion& begin) {
  if (car_) {
    model::Column<double, 6> core;
    core << begin.position, 0.0, begin.position, 0.0, 0.0, 0.0;
    state_ = car_->start(core, begin, {});
    alive_ = true;
    energy_guard_.start(0.0);
    if (Compensation* compensation = compensation_.get(); compensation != nullptr) compensation->start(0.0);
  }
  compensation_.note_force(0.0);
}

void HilInterface::receive(double measured, bool in_run, std::uint64_t sample) {
  double force = measured;
  if (Compensation* compensation = compensation_.get(); compensation != nullptr && in_run) {
    force = compensation->force(measured);
  }
  const double elapsed = in_run ? static_cast<double>(sample) * period_ : 0.0;
  double share = 1.0;
  if (elapsed < force_ramp_) {
    const double s = elapsed / force_ramp_;
    share = s * s * (3.0 - 2.0 * s);
  }
  whole_force_ = force;
  compensation_.note_force((force - measured) * share);
  car_->receive_force(state_, force * share);
}

hal::Command HilInterface::step(const Motion& foot_point, const Instant& instant, const SampleGuard& samples) {
  VirtualCar::Input input;
  input.foot_point = foot_point;
  const double wheel = state_.core(CoreIndex::wheel_position);
  car_->step(state_, input);
  const auto suspension = car_->deflection(state_);
  const auto deflection = car_->component_stroke(suspension);
  // A force that is faded in feeds energy by itself: the guard sees the whole force, from the rest before the run on.
  const std::optional<Trip> fed = energy_guard_.follow(whole_force_, deflection.position,
                                                       state_.core(CoreIndex::wheel_position) - wheel, instant.now);
  if (fading_in(instant.sample)) {
    energy_guard_.begin_judging();
  } else {
    hazard_ = fed;
  }
  const auto signals = car_->signals(state_);
  const model::Motion<double> wanted{
      deflection.position, deflection.velocity,
      car_->component_acceleration(suspension,
                                   signals[model::index(Channel::zdd_w)] - signals[model::index(Channel::zdd_b)])};
  if (Compensation* compensation = compensation_.get()) return compensated(*compensation, wanted, instant, samples);
  return {wanted.position, wanted.velocity, wanted.acceleration};
}

/// A command that leads the wanted deflection, so that the machine is there in time.
hal::Command HilInterface::compensated(Compensation& compensation, const model::Motion<double>& wanted,
                                       const Instant& instant, const SampleGuard& samples) {
  Compensation::Instant at;
  at.wanted = wanted;
  at.commanded = instant.commanded;
  at.measured = samples.good(Channel::x_act);
  if (at.measured) at.reached = samples.value(Channel::x_act);
  at.open_ducts = std::popcount(instant.openings.bits());
  const Compensation::Answer answer = compensation.command(at);
  if (answer.excess && !hazard_) {
    hazard_ = Trip{Reason::compensation, answer.excess->of_force ? Channel::F : Channel::x_cmd, answer.excess->value,
                   answer.excess->limit, instant.now};
  }
  return answer.command;
}

void HilInterface::note(Record& record, double commanded, bool in_run) const {
  if (!alive_) return;
  constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();
  record.values = car_->signals(state_);
  record.values[model::index(Channel::x_act)] = not_measured;
  record.values[model::index(Channel::F_act)] = not_measured;
  const double wheel = state_.core(CoreIndex::wheel_velocity), body = state_.core(CoreIndex::body_velocity);
  record.velocities = {state_.foot_point.velocity, wheel, body, wheel - body};
  if (compensation_.get() != nullptr && in_run) {
    record.added.set(commanded - car_->component_stroke(car_->deflection(state_)).position,
                     compensation_.added_force());
  }
}

}  // namespace firmware
