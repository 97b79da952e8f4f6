#include "firmware/loop/control_loop.hpp"

#include <limits>

#include "model/require.hpp"

namespace firmware {
namespace {

using model::Channel;
using model::CoreIndex;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

bool moving(Mode mode) { return mode == Mode::ready || mode == Mode::running; }

}  // namespace

std::string_view ControlLoop::check(const Settings& settings, const model::RigParameters<double>& parameters,
                                    const hal::Rig& rig, const ValvePlan& valves) {
  if (const std::string_view wrong = settings.check(); !wrong.empty()) return wrong;
  if (model::find_fault(parameters, settings.period.seconds(), VirtualCar::Line::longest)) {
    return "parameters: expected a rig without a fault";
  }
  if (parameters.kind == model::RigKind::hil && !rig.sensors.fitted(model::index(Channel::F))) {
    return "sensors: expected channel F, the measured force that moves the virtual car of a hil rig";
  }
  if (!valves.within(rig.valves.installed())) return "valve plan: expected only ducts that are installed";
  return {};
}

ControlLoop::ControlLoop(const Settings& settings, const model::RigParameters<double>& parameters, const hal::Rig& rig,
                         Reference& reference, const ValvePlan& valves, Journal& journal)
    : settings_(settings),
      period_(settings.period.seconds()),
      kind_(parameters.kind),
      rig_(rig),
      reference_(reference),
      valves_(valves),
      journal_(journal),
      samples_(settings.limits, settings.period, rig.sensors),
      estimator_(samples_, parameters.tyre.stiffness, settings.observers, period_),
      command_guard_(settings.limits, period_, settings.ramps.rest),
      energy_guard_(settings.limits, parameters.machine.virtual_damping, parameters.tyre.damping, period_,
                    settings.supervision.growth_time),
      motion_guard_(settings.limits, settings.supervision, parameters, period_),
      frozen_guard_(settings.supervision, parameters),
      lateness_guard_(settings.limits, settings.supervision, settings.period) {
  model::require(check(settings, parameters, rig, valves).empty(), "a control loop of parts that fit");
  if (hil()) car_.emplace(parameters, period_, model::ModelledPart::virtual_car);
}

void ControlLoop::step() {
  const hal::Time now = rig_.clock.now();
  keep_time(now);
  samples_.take(rig_.sensors.read(), now);
  estimator_.step(samples_);
  watch_motion();

  const unsigned requests = requests_.exchange(0);
  const bool acknowledged = (requests & acknowledge_request) != 0 && mode_ == Mode::safe && at_rest();
  if (acknowledged) rig_.stop_button.release();
  std::optional<Trip> hazard = find_hazard(now);
  if (!hazard && (requests & stop_request) != 0) {
    hazard = Trip{Reason::stop_requested, std::nullopt, 0.0, 0.0, now};
  }
  if (acknowledged && !hazard) mode_ = next(mode_, Event::acknowledge);
  if ((requests & start_request) != 0 && mode_ == Mode::idle) get_ready();
  if (mode_ == Mode::ready && !hazard && reference_begins_ && move_.arrived() && settling_left_ == 0) {
    mode_ = next(mode_, Event::in_position);
    sample_ = 0;
  }

  Record record;
  record.period = periods_++;
  record.sample = mode_ == Mode::running ? sample_ : 0;
  record.time = now;
  record.due = due_ - settings_.period;
  record.late = lateness_;
  record.mode = mode_;
  if (car_alive_) car_->receive_force(car_state_, samples_.value(Channel::F));
  note_values(record);

  if (hazard) trip(*hazard);
  compute(now);
  act(now);
  if (mode_ == Mode::running) ++sample_;

  counters_.missed_frames = samples_.missed_frames();
  counters_.bridged_samples = samples_.bridged_count();
  counters_.limited_commands = command_guard_.limited_count();
  record.trip = trip_;
  record.command = command_;
  record.openings = openings_;
  record.counters = counters_;
  journal_.push(record);
}

void ControlLoop::keep_time(hal::Time now) {
  if (due_ == hal::never) due_ = now;
  lateness_ = now - due_;
  if (lateness_guard_.follow(lateness_)) {
    ++counters_.late_periods;
    due_ = now;
  }
  due_ += settings_.period;
}

/// The guards follow the drive as long as it is commanded. In idle it stands still.
void ControlLoop::watch_motion() {
  motion_hazard_.reset();
  if (mode_ == Mode::idle) {
    motion_guard_.start(command_guard_.last().position);
    frozen_guard_.start();
    return;
  }
  motion_hazard_ = motion_guard_.follow(command_guard_.last(), samples_);
  const std::optional<Trip> frozen = frozen_guard_.follow(samples_, motion_guard_.expected(), command_guard_.last());
  if (!motion_hazard_) motion_hazard_ = frozen;
}

std::optional<Trip> ControlLoop::find_hazard(hal::Time now) {
  const hal::Result<bool> pressed = rig_.stop_button.pressed();
  if (!pressed) return Trip{Reason::stop_button_lost, std::nullopt, 0.0, 0.0, now};
  if (*pressed) {
    return Trip{Reason::stop_button, std::nullopt, (now - rig_.stop_button.pressed_at()).seconds(), 0.0, now};
  }
  if (samples_.hazard()) return samples_.hazard();
  for (const std::optional<Trip>& seen : {lateness_guard_.hazard(), motion_hazard_}) {
    if (!seen) continue;
    Trip hazard = *seen;
    hazard.time = now;
    return hazard;
  }
  return std::nullopt;
}

void ControlLoop::get_ready() {
  mode_ = next(mode_, Event::start);
  trip_ = {};
  const std::optional<Motion> begin = reference_.at(0);
  reference_begins_ = begin.has_value();
  if (!reference_begins_) return;
  if (hil()) {
    model::Column<double, 6> core;
    core << begin->position, 0.0, begin->position, 0.0, 0.0, 0.0;
    car_state_ = car_->start(core, *begin, {});
    car_alive_ = true;
    energy_guard_.start(0.0);
  }
  move_ = SmoothMove(command_guard_.last().position, hil() ? 0.0 : begin->position, settings_.ramps.rate, period_);
  settling_left_ = (hal::seconds(settings_.ramps.settling).ns + settings_.period.ns - 1) / settings_.period.ns;
}

/// The first reason counts; from here on the rig is on its way to rest.
void ControlLoop::trip(const Trip& trip) {
  if (!moving(mode_)) return;
  trip_ = trip;
  mode_ = next(mode_, Event::trip);
  car_alive_ = false;
  const double velocity = trip.reason == Reason::command_failed ? 0.0 : command_guard_.velocity();
  return_ =
      ReturnToRest(command_guard_.last().position, velocity, settings_.ramps, 0.5 * settings_.limits.stroke, period_);
}

void ControlLoop::compute(hal::Time now) {
  std::optional<hal::Command> wanted;
  energy_hazard_.reset();
  if (mode_ == Mode::ready && reference_begins_) {
    if (move_.arrived()) --settling_left_;
    wanted = move_.next();
    openings_ = valves_.at(hal::Time{});
  } else if (mode_ == Mode::running) {
    wanted = follow_reference();
    openings_ = valves_.at(settings_.period * static_cast<std::int64_t>(sample_));
  }
  if (moving(mode_)) {
    if (!wanted) {
      trip({Reason::reference_ended, std::nullopt, 0.0, 0.0, now});
    } else if (energy_hazard_) {
      energy_hazard_->time = now;
      trip(*energy_hazard_);
    } else {
      CommandGuard::Verdict verdict = command_guard_.judge(*wanted);
      command_ = verdict.command;
      if (verdict.hazard) {
        verdict.hazard->time = now;
        trip(*verdict.hazard);
      }
    }
  }
  if (mode_ == Mode::idle) command_ = command_guard_.last();
  if (mode_ == Mode::safe) command_ = return_.next();
  if (!moving(mode_)) openings_ = rig_.valves.safe_position();
}

std::optional<hal::Command> ControlLoop::follow_reference() {
  const std::optional<Motion> there = reference_.at(sample_ + 1);
  if (!there) return std::nullopt;
  if (hil()) return step_car(*there);
  return hal::Command{there->position, there->velocity, there->acceleration};
}

hal::Command ControlLoop::step_car(const Motion& foot_point) {
  VirtualCar::Input input;
  input.foot_point = foot_point;
  const double wheel = car_state_.core(CoreIndex::wheel_position);
  car_->step(car_state_, input);
  const auto deflection = car_->deflection(car_state_);
  energy_hazard_ = energy_guard_.follow(car_state_.received_force, deflection.position,
                                        car_state_.core(CoreIndex::wheel_position) - wheel);
  const auto signals = car_->signals(car_state_);
  return {deflection.position, deflection.velocity,
          signals[model::index(Channel::zdd_w)] - signals[model::index(Channel::zdd_b)]};
}

void ControlLoop::act(hal::Time now) {
  bool valves_stand = write_valves();
  if (!valves_stand && moving(mode_)) {
    trip({Reason::valves_failed, std::nullopt, 0.0, 0.0, now});
    command_ = return_.next();
    openings_ = rig_.valves.safe_position();
    valves_stand = write_valves();
  }

  if (mode_ != Mode::idle) {
    const hal::Result<void> written = rig_.command.write(command_);
    if (written) {
      command_guard_.passed(command_);
      failed_commands_in_a_row_ = 0;
    } else {
      ++counters_.failed_commands;
      if (failed_commands_in_a_row_ < settings_.limits.bridged_in_a_row) ++failed_commands_in_a_row_;
      if (moving(mode_) &&
          (written.fault() != hal::Fault::timeout || failed_commands_in_a_row_ >= settings_.limits.bridged_in_a_row)) {
        trip({Reason::command_failed, std::nullopt, static_cast<double>(failed_commands_in_a_row_),
              static_cast<double>(settings_.limits.bridged_in_a_row), now});
        openings_ = rig_.valves.safe_position();
        valves_stand = write_valves();
      } else if (mode_ == Mode::safe) {  // the drive has stayed where it was: begin again from there
        return_ =
            ReturnToRest(command_guard_.last().position, 0.0, settings_.ramps, 0.5 * settings_.limits.stroke, period_);
      }
    }
  }

  if (!valves_stand) return;  // valves lost: without beats the watchdog makes them safe
  if (!rig_.heartbeat.beat()) {
    ++counters_.failed_beats;
    if (moving(mode_)) {
      trip({Reason::heartbeat_failed, std::nullopt, 0.0, 0.0, now});
      openings_ = rig_.valves.safe_position();
      (void)write_valves();
    }
  }
}

bool ControlLoop::write_valves() {
  if (rig_.valves.write(openings_)) return true;
  ++counters_.failed_valves;
  return false;
}

void ControlLoop::note_values(Record& record) const {
  record.values.fill(unknown);
  record.taken.fill(hal::never);
  record.bridged = samples_.bridged();
  record.wheel_load = estimator_.wheel_load();
  record.velocities = estimator_.velocities();
  if (car_alive_) {
    record.values = car_->signals(car_state_);
    record.values[model::index(Channel::x_act)] = unknown;
    record.values[model::index(Channel::F_act)] = unknown;
    const double wheel = car_state_.core(CoreIndex::wheel_velocity), body = car_state_.core(CoreIndex::body_velocity);
    record.velocities = {car_state_.foot_point.velocity, wheel, body, wheel - body};
  }
  record.values[model::index(Channel::x_cmd)] =
      kind_ == model::RigKind::quarter_car ? unknown : command_guard_.last().position;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!samples_.fitted(model::channel_at(i))) continue;
    const hal::Reading& reading = samples_.frame().channels[i];
    record.values[i] = reading.quality == hal::Quality::missing ? unknown : reading.value;
    record.taken[i] = reading.taken;
  }
}

}  // namespace firmware
