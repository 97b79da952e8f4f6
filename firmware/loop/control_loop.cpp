#include "firmware/loop/control_loop.hpp"

#include <array>
#include <bit>
#include <limits>

#include "model/require.hpp"

namespace firmware {
namespace {

using model::Channel;
using model::CoreIndex;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

constexpr double follow_time = 0.02;  ///< smoothing of the position that the command follows without power [s]

/// What arming may expect of the rig that is described.
ArmingChecks::Expected expected_of(const model::RigParameters<double>& parameters) {
  ArmingChecks::Expected expected;
  expected.force_answers = parameters.kind == model::RigKind::hil;
  expected.returns = parameters.kind != model::RigKind::quarter_car;
  expected.lowest_stiffness = model::spring_stiffness(parameters, true);
  expected.highest_stiffness =
      model::spring_stiffness(parameters) + (parameters.has_fdva ? parameters.fdva.coupling_stiffness : 0.0);
  if (parameters.kind == model::RigKind::quarter_car) expected.position = Channel::z_r;
  return expected;
}

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
  if (AreaControl<has_area>(parameters).wanted() && rig.area == nullptr) {
    return "area: expected an output for the area of the air spring, which the skyhook commands";
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
      valves_(valves),
      journal_(journal),
      samples_(settings.limits, settings.period, rig.sensors),
      estimator_(samples_, parameters.tyre.stiffness, settings.observers, period_),
      command_guard_(settings.limits, period_, settings.ramps.rest),
      energy_guard_(settings.limits, parameters.machine.virtual_damping, parameters.tyre.damping, period_,
                    settings.supervision.growth_time),
      motion_guard_(settings.limits, settings.supervision, parameters, period_),
      frozen_guard_(settings.supervision, parameters),
      lateness_guard_(settings.limits, settings.supervision, settings.period),
      area_control_(parameters),
      arming_(settings, expected_of(parameters)),
      player_(reference, period_) {
  model::require(check(settings, parameters, rig, valves).empty(), "a control loop of parts that fit");
  if (hil()) car_.emplace(parameters, period_, model::ModelledPart::virtual_car);
}

void ControlLoop::step() {
  const hal::Time now = rig_.clock.now();
  keep_time(now);
  samples_.take(rig_.sensors.read(), now);
  estimator_.step(samples_);
  if (Companion* companion = companion_.get()) companion->follow(samples_, now);
  watch_motion();

  const unsigned requests = requests_.exchange(0);
  if ((requests & level_request) != 0) player_.level(static_cast<double>(wanted_level_.load()) / 1e6);
  const bool stands = mode_ == Mode::safe && at_rest();
  if (stands && (requests & (acknowledge_request | rest_request)) != 0) rig_.stop_button.release();
  std::optional<Trip> hazard = find_hazard(now);
  if (!hazard && (requests & stop_request) != 0 && mode_ != Mode::safe) {
    hazard = Trip{.reason = Reason::stop_requested, .time = now};
  }
  if (stands && !hazard) {
    if ((requests & acknowledge_request) != 0) {
      mode_ = next(mode_, Event::acknowledge);
    } else if ((requests & rest_request) != 0 && !loses_power(trip_.reason) && !loses_power(second_.reason)) {
      return_ =
          ReturnToRest(command_guard_.last().position, 0.0, settings_.ramps, 0.5 * settings_.limits.stroke, period_);
      held_ = false;
      expects_trip_ = false;
    }
  }
  if ((requests & arm_request) != 0 && mode_ == Mode::idle) begin_arming(now);
  if (mode_ == Mode::arming && !hazard) hazard = look_at_arming(now);
  take_up(requests, hazard.has_value());

  Record record;
  record.period = periods_++;
  record.sample = in_run(mode_) ? sample_ : 0;
  record.time = now;
  record.due = due_ - settings_.period;
  record.late = lateness_;
  record.mode = mode_;
  if (car_alive_) car_->receive_force(car_state_, entering_force());
  note_values(record);

  const bool runs = in_run(mode_);
  if (hazard && matters(*hazard)) trip(*hazard);
  command_area(now);
  compute(now);
  act(now);
  if (Companion* companion = companion_.get()) companion->opened(openings_);
  if (runs && in_run(mode_)) ++sample_;

  counters_.missed_frames = samples_.missed_frames();
  counters_.bridged_samples = samples_.bridged_count();
  counters_.limited_commands = command_guard_.limited_count();
  record.trip = trip_;
  record.second = second_.reason;
  record.enabled = enabled_;
  record.level = player_.level();
  record.tare = tare();
  record.energy_fed = energy_guard_.fed();
  record.energy_taken = energy_guard_.taken();
  record.command = command_;
  record.openings = openings_;
  if (const Companion* companion = companion_.get()) record.openings = companion->standing();
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

/// While the drive has power it must go where it is told, in every state. Without power it may stand or be moved.
/// Arming has checks of its own for sensors that do not answer.
void ControlLoop::watch_motion() {
  motion_hazard_.reset();
  if (!enabled_) {
    motion_guard_.start(command_guard_.last().position);
    frozen_guard_.start();
    return;
  }
  motion_hazard_ = motion_guard_.follow(command_guard_.last(), samples_);
  if (mode_ == Mode::arming) {
    frozen_guard_.start();
    return;
  }
  const std::optional<Trip> frozen = frozen_guard_.follow(samples_, motion_guard_.expected(), command_guard_.last());
  if (!motion_hazard_) motion_hazard_ = frozen;
}

bool ControlLoop::level(double wanted) {
  if (!(wanted >= 0.0 && wanted <= ReferencePlayer::highest_level)) return false;
  wanted_level_.store(static_cast<std::uint32_t>(wanted * 2e6 + 1.0) / 2);
  requests_.fetch_or(level_request);
  return true;
}

std::optional<Trip> ControlLoop::find_hazard(hal::Time now) {
  std::optional<Trip> late = lateness_guard_.hazard();
  for (std::optional<Trip>* hazard : {&late, &motion_hazard_}) {
    if (*hazard) (*hazard)->time = now;
  }
  // The first that matters; one that lasts from the trip must not hide another.
  const std::array<std::optional<Trip>, 6> all{
      find_stop(now), find_open_interlock(now), samples_.hazard(), samples_.limit_hazard(), late, motion_hazard_};
  const std::optional<Trip>* first = nullptr;
  for (const std::optional<Trip>& hazard : all) {
    if (!hazard) continue;
    if (matters(*hazard)) return hazard;
    if (first == nullptr) first = &hazard;
  }
  return first != nullptr ? *first : std::nullopt;
}

std::optional<Trip> ControlLoop::find_stop(hal::Time now) {
  const hal::Result<bool> pressed = rig_.stop_button.pressed();
  if (!pressed) {
    const bool contradiction = pressed.fault() == hal::Fault::refused;
    return Trip{.reason = contradiction ? Reason::stop_channels : Reason::stop_button_lost, .time = now};
  }
  if (!*pressed) return std::nullopt;
  return Trip{.reason = Reason::stop_button, .value = (now - rig_.stop_button.pressed_at()).seconds(), .time = now};
}

std::optional<Trip> ControlLoop::find_open_interlock(hal::Time now) {
  const hal::Result<std::uint32_t> open = rig_.interlocks.open();
  if (!open) return Trip{.reason = Reason::interlocks_lost, .time = now};
  if (*open == 0) return std::nullopt;
  std::int8_t first = 0;
  while ((*open >> static_cast<unsigned>(first) & 1U) == 0) ++first;
  return Trip{.reason = Reason::interlock, .time = now, .interlock = first};
}

/// Without power and motion only a stop acts. On the way to rest the hazard that led there may last; any other acts.
bool ControlLoop::matters(const Trip& hazard) const {
  if (leads_drive(mode_)) return true;
  if (mode_ == Mode::idle) return is_stop(hazard.reason) || hazard.reason == Reason::stop_requested;
  if (expects_trip_ && hazard.reason == trip_.reason && hazard.channel == trip_.channel) return false;
  return is_stop(hazard.reason) || !standing() || enabled_;
}

void ControlLoop::take_up(unsigned requests, bool hazard) {
  const auto asked = [requests](unsigned request) { return (requests & request) != 0; };
  if (asked(disarm_request) && mode_ == Mode::armed) mode_ = next(mode_, Event::disarm);
  if (asked(start_request) && mode_ == Mode::armed) get_ready();
  if (mode_ == Mode::ready && !hazard && reference_begins_ && move_.arrived() && settling_left_ == 0) {
    mode_ = next(mode_, Event::in_position);
    sample_ = 0;
  }
  if (asked(hold_request) && mode_ == Mode::running) {
    mode_ = next(mode_, Event::hold);
    player_.hold();
  } else if (asked(resume_request) && mode_ == Mode::holding) {
    mode_ = next(mode_, Event::resume);
    player_.resume();
  }
}

void ControlLoop::begin_arming(hal::Time now) {
  mode_ = next(mode_, Event::arm);
  trip_ = {};
  second_ = {};
  samples_.tare(Channel::F, 0.0);
  double home = command_guard_.last().position;
  if (settings_.arming.position_tolerance > 0.0 && !rig_.drive_enable.fitted()) {
    const hal::Result<double> shown = rig_.command.read_back();  // the drive has power: there it is told to be
    if (shown) home = *shown;
  }
  command_guard_.passed({home, 0.0, 0.0});
  command_guard_.passed({home, 0.0, 0.0});  // at rest
  arming_.begin(home, now);
}

std::optional<Trip> ControlLoop::look_at_arming(hal::Time now) {
  ArmingChecks::Seen seen{.now = now, .command = command_guard_.last().position};
  if (settings_.arming.position_tolerance > 0.0) {
    const hal::Result<double> shown = rig_.command.read_back();
    if (shown) seen.read_back = *shown;
    if (!shown && shown.fault() == hal::Fault::disconnected) return Trip{.reason = Reason::command_failed, .time = now};
    if (samples_.fitted(position_channel())) seen.position = samples_.value(position_channel());
  }
  if (samples_.fitted(Channel::F)) seen.force = samples_.value(Channel::F);
  const std::optional<Trip> hazard = arming_.look(seen);
  if (!hazard && arming_.done()) {
    samples_.tare(Channel::F, arming_.tare());
    mode_ = next(mode_, Event::checked);
  }
  return hazard;
}

void ControlLoop::get_ready() {
  mode_ = next(mode_, Event::start);
  trip_ = {};
  second_ = {};
  const std::optional<Motion> begin = player_.start();
  reference_begins_ = begin.has_value();
  if (!reference_begins_) return;
  if (hil()) {
    model::Column<double, 6> core;
    core << begin->position, 0.0, begin->position, 0.0, 0.0, 0.0;
    car_state_ = car_->start(core, *begin, {});
    car_alive_ = true;
    energy_guard_.start(0.0);
  }
  if (Compensation* compensation = compensation_.get(); compensation != nullptr && hil()) compensation->start(0.0);
  compensation_.note_force(0.0);
  move_ = SmoothMove(command_guard_.last().position, hil() ? 0.0 : begin->position, settings_.ramps.rate, period_);
  settling_left_ = (hal::seconds(settings_.ramps.settling).ns + settings_.period.ns - 1) / settings_.period.ns;
}

/// The first reason counts; what follows it in safe is kept beside it.
void ControlLoop::trip(const Trip& trip) {
  const double velocity = trip.reason == Reason::command_failed || !enabled_ ? 0.0 : command_guard_.velocity();
  if (mode_ == Mode::safe) {
    if (second_.reason == Reason::none) second_ = trip;
    if (!held_ && !standing()) brake_and_hold(velocity);
    return;
  }
  const bool stays = takes_power(trip.reason) || mode_ == Mode::idle;
  trip_ = trip;
  second_ = {};
  mode_ = next(mode_, Event::trip);
  car_alive_ = false;
  held_ = false;
  expects_trip_ = true;
  if (stays) {
    brake_and_hold(velocity);
  } else {
    return_ =
        ReturnToRest(command_guard_.last().position, velocity, settings_.ramps, 0.5 * settings_.limits.stroke, period_);
  }
}

void ControlLoop::brake_and_hold(double velocity) {
  held_ = true;
  return_ = ReturnToRest::brake_and_hold(command_guard_.last().position, velocity, settings_.ramps,
                                         0.5 * settings_.limits.stroke, period_);
}

/// Without power the drive may be moved, or creep: the command goes with it, so that power finds no difference.
void ControlLoop::follow_rig() {
  command_ = {command_guard_.last().position, 0.0, 0.0};
  const Channel channel = position_channel();
  const bool measured = settings_.arming.position_tolerance > 0.0 && rig_.drive_enable.fitted() &&
                        samples_.fitted(channel) && samples_.seen(channel) &&
                        (samples_.bridged() >> model::index(channel) & 1U) == 0;
  if (!measured) {
    follows_ = false;
    return;
  }
  const double position = samples_.value(channel), share = period_ < follow_time ? period_ / follow_time : 1.0;
  followed_ = follows_ ? followed_ + share * (position - followed_) : position;
  follows_ = true;
  const double half_stroke = 0.5 * settings_.limits.stroke;
  command_.position = followed_ > half_stroke ? half_stroke : followed_ < -half_stroke ? -half_stroke : followed_;
}

/// hil: the measured force, with what the compensation adds in a run, enters the car by a smoothstep over force_ramp
/// from the beginning of a run.
double ControlLoop::entering_force() {
  const double measured = samples_.value(Channel::F);
  double force = measured;
  if (Compensation* compensation = compensation_.get(); compensation != nullptr && in_run(mode_)) {
    force = compensation->force(measured);
  }
  const double elapsed = in_run(mode_) ? static_cast<double>(sample_) * period_ : 0.0;
  if (elapsed >= settings_.arming.force_ramp) {
    compensation_.note_force(force - measured);
    return force;
  }
  const double s = elapsed / settings_.arming.force_ramp;
  const double share = s * s * (3.0 - 2.0 * s);
  compensation_.note_force((force - measured) * share);
  return force * share;
}

/// The area of an air spring for the period that begins: by the skyhook in a run, else as it is at rest.
void ControlLoop::command_area(hal::Time now) {
  if constexpr (has_area) {
    if (!area_control_.wanted()) return;
    const double velocity = car_alive_ ? car_state_.core(CoreIndex::body_velocity) : estimator_.velocities().body;
    const double area = in_run(mode_) ? area_control_.command(velocity) : 0.0;
    if (rig_.area->write(area) || !leads_drive(mode_)) return;
    trip({.reason = Reason::command_failed, .time = now});
  } else {
    static_cast<void>(now);
  }
}

void ControlLoop::compute(hal::Time now) {
  std::optional<hal::Command> wanted;
  loop_hazard_.reset();
  if (mode_ == Mode::arming) {
    wanted = arming_.next();
  } else if (mode_ == Mode::armed) {
    wanted = hal::Command{command_guard_.last().position, 0.0, 0.0};
  } else if (mode_ == Mode::ready && reference_begins_) {
    if (move_.arrived()) --settling_left_;
    wanted = move_.next();
    openings_ = valves_.at(hal::Time{});
  } else if (in_run(mode_)) {
    const std::uint64_t sample = player_.sample();
    openings_ = valves_.at(settings_.period * static_cast<std::int64_t>(sample));
    wanted = follow_reference();
    if (Companion* companion = companion_.get()) openings_ = companion->choose(openings_);
  }
  if (leads_drive(mode_)) {
    if (!wanted) {
      trip({.reason = Reason::reference_ended, .time = now});
    } else if (loop_hazard_) {
      loop_hazard_->time = now;
      trip(*loop_hazard_);
    } else {
      CommandGuard::Verdict verdict = command_guard_.judge(*wanted);
      command_ = verdict.command;
      if (verdict.hazard) {
        verdict.hazard->time = now;
        trip(*verdict.hazard);
      }
    }
  }
  // In safe the enable goes one period after the last command of the way to rest, so that the drive gets there.
  wants_power_ = (leads_drive(mode_) && (mode_ != Mode::arming || arming_.powered())) ||
                 (mode_ == Mode::safe && !held_ && !standing());
  if (mode_ == Mode::idle || (mode_ == Mode::safe && standing() && !enabled_)) {
    follow_rig();
  } else {
    follows_ = false;
    if (mode_ == Mode::safe) command_ = return_.next();
  }
  if (mode_ != Mode::ready && !in_run(mode_)) openings_ = rig_.valves.safe_position();
}

std::optional<hal::Command> ControlLoop::follow_reference() {
  const std::optional<Motion> there = player_.next();
  if (!there) return std::nullopt;
  if (hil()) return step_car(*there);
  return hal::Command{there->position, there->velocity, there->acceleration};
}

hal::Command ControlLoop::step_car(const Motion& foot_point) {
  VirtualCar::Input input;
  input.foot_point = foot_point;
  const double wheel = car_state_.core(CoreIndex::wheel_position);
  car_->step(car_state_, input);
  const auto suspension = car_->deflection(car_state_);
  const auto deflection = car_->component_stroke(suspension);
  if (static_cast<double>(sample_) * period_ < settings_.arming.force_ramp) {
    energy_guard_.start(deflection.position);  // a force that is faded in feeds energy by itself
  }
  loop_hazard_ = energy_guard_.follow(car_state_.received_force, deflection.position,
                                      car_state_.core(CoreIndex::wheel_position) - wheel);
  const auto signals = car_->signals(car_state_);
  const model::Motion<double> wanted{
      deflection.position, deflection.velocity,
      car_->component_acceleration(suspension,
                                   signals[model::index(Channel::zdd_w)] - signals[model::index(Channel::zdd_b)])};
  if (Compensation* compensation = compensation_.get()) return compensated(*compensation, wanted);
  return {wanted.position, wanted.velocity, wanted.acceleration};
}

/// A command that leads the wanted deflection, so that the machine is there in time.
hal::Command ControlLoop::compensated(Compensation& compensation, const model::Motion<double>& wanted) {
  Compensation::Instant instant;
  instant.wanted = wanted;
  instant.commanded = command_guard_.last().position;
  instant.measured = samples_.fitted(Channel::x_act) && samples_.seen(Channel::x_act) &&
                     (samples_.bridged() >> model::index(Channel::x_act) & 1U) == 0;
  if (instant.measured) instant.reached = samples_.value(Channel::x_act);
  instant.open_ducts = std::popcount(openings_.bits());
  const Compensation::Answer answer = compensation.command(instant);
  if (answer.excess && !loop_hazard_) {
    loop_hazard_ = Trip{Reason::compensation, answer.excess->of_force ? Channel::F : Channel::x_cmd,
                        answer.excess->value, answer.excess->limit, hal::never};
  }
  return answer.command;
}

void ControlLoop::act(hal::Time now) {
  if (!wants_power_) write_enable(now);  // off first, on last
  bool valves_stand = write_valves();
  if (!valves_stand && (leads_drive(mode_) || wants_power_)) {
    lose_power({.reason = Reason::valves_failed, .time = now});
    command_ = return_.next();
    write_enable(now);
    valves_stand = write_valves();
  }

  if (mode_ != Mode::idle || follows_) {
    const hal::Result<void> written = rig_.command.write(command_);
    if (written) {
      command_guard_.passed(command_);
      failed_commands_in_a_row_ = 0;
    } else {
      ++counters_.failed_commands;
      if (failed_commands_in_a_row_ < settings_.limits.bridged_in_a_row) ++failed_commands_in_a_row_;
      const bool lost =
          written.fault() != hal::Fault::timeout || failed_commands_in_a_row_ >= settings_.limits.bridged_in_a_row;
      if (lost && (leads_drive(mode_) || (mode_ == Mode::safe && !held_ && !standing()))) {
        lose_power({Reason::command_failed, std::nullopt, static_cast<double>(failed_commands_in_a_row_),
                    static_cast<double>(settings_.limits.bridged_in_a_row), now});
        valves_stand = write_valves();
      } else if (mode_ == Mode::safe && held_) {  // the drive has stayed where it was: begin again from there
        brake_and_hold(0.0);
      } else if (mode_ == Mode::safe && enabled_) {
        return_ =
            ReturnToRest(command_guard_.last().position, 0.0, settings_.ramps, 0.5 * settings_.limits.stroke, period_);
      }
    }
  }
  write_enable(now);

  if (!valves_stand || !enable_stands_) return;  // without beats the watchdog makes them safe and takes the power
  if (rig_.heartbeat.beat()) return;
  ++counters_.failed_beats;
  if (!leads_drive(mode_) && !wants_power_) return;
  lose_power({.reason = Reason::heartbeat_failed, .time = now});
  (void)write_valves();
  write_enable(now);
}

/// The watchdog takes the power, or has taken it, or nobody knows. The next beat, or a line that takes writes again,
/// would give it back wherever the command is by then: so it is withdrawn here too.
void ControlLoop::lose_power(const Trip& cause) {
  trip(cause);
  openings_ = rig_.valves.safe_position();
  wants_power_ = false;
}

/// At a change, and again after a fault.
void ControlLoop::write_enable(hal::Time now) {
  if (enable_stands_ && enabled_ == wants_power_) return;
  enable_stands_ = static_cast<bool>(rig_.drive_enable.write(wants_power_));
  if (enable_stands_) {
    enabled_ = wants_power_;
    return;
  }
  ++counters_.failed_enables;
  if (!leads_drive(mode_) && !wants_power_) return;
  lose_power({.reason = Reason::enable_failed, .time = now});
  (void)write_valves();
  enable_stands_ = static_cast<bool>(rig_.drive_enable.write(false));
  if (enable_stands_) enabled_ = false;
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
  if (const Companion* companion = companion_.get()) {
    record.wheel_load = companion->wheel_load();
    record.velocities = companion->velocities();
  }
  if (car_alive_) {
    record.values = car_->signals(car_state_);
    record.values[model::index(Channel::x_act)] = unknown;
    record.values[model::index(Channel::F_act)] = unknown;
    const double wheel = car_state_.core(CoreIndex::wheel_velocity), body = car_state_.core(CoreIndex::body_velocity);
    record.velocities = {car_state_.foot_point.velocity, wheel, body, wheel - body};
  }
  if (compensation_.get() != nullptr && car_alive_ && in_run(mode_)) {
    record.added.set(command_guard_.last().position - car_->component_stroke(car_->deflection(car_state_)).position,
                     compensation_.added_force());
  }
  record.values[model::index(Channel::x_cmd)] =
      kind_ == model::RigKind::quarter_car ? unknown : command_guard_.last().position;
  record.values[model::index(Channel::z_cmd)] =
      kind_ == model::RigKind::quarter_car ? command_guard_.last().position : unknown;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!samples_.fitted(model::channel_at(i))) continue;
    const hal::Reading& reading = samples_.frame().channels[i];
    record.values[i] = reading.quality == hal::Quality::missing ? unknown : reading.value;
    record.taken[i] = reading.taken;
  }
}

}  // namespace firmware
