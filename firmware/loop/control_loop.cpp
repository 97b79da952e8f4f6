#include "firmware/loop/control_loop.hpp"

#include <array>
#include <limits>

#include "model/numerics/require.hpp"

namespace firmware {
namespace {

using model::Channel;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// What arming may expect of the rig that is described.
ArmingChecks::Expected expected_of(const model::RigParameters<double>& parameters) {
  ArmingChecks::Expected expected;
  expected.force_answers = parameters.kind == model::RigKind::hil;
  expected.returns = parameters.kind != model::RigKind::quarter_car;
  expected.lowest_stiffness = model::spring_stiffness(parameters, true);
  expected.highest_stiffness =
      model::spring_stiffness(parameters) + (parameters.has_fdva ? parameters.fdva.coupling_stiffness : 0.0);
  if (parameters.kind == model::RigKind::quarter_car) {
    expected.position = Channel::z_r;
    expected.force = Channel::F_w;
  }
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
      hil_(settings, parameters, period_),
      power_(rig.drive_enable, settings.supervision, period_,
             kind_ == model::RigKind::quarter_car ? Channel::z_r : Channel::x_act, rig.high_pressure),
      motion_guard_(settings.limits, settings.supervision, parameters, period_, settings.highest_low_speed()),
      frozen_guard_(settings.supervision, parameters, period_),
      force_guard_(settings.supervision, parameters, period_),
      lateness_guard_(settings.limits, settings.supervision, settings.period),
      area_control_(parameters),
      arming_(settings, expected_of(parameters)),
      player_(reference, period_) {
  model::require(check(settings, parameters, rig, valves).empty(), "a control loop of parts that fit");
}

void ControlLoop::step() {
  const hal::Time now = rig_.clock.now();
  keep_time(now);
  set_low_limits();
  samples_.take(rig_.sensors.read(), now);
  estimate(now);
  watch_motion(now);
  if (Companion* companion = companion_.get()) {
    const std::optional<Trip> implausible = companion->look(in_run(mode_), now);
    if (!motion_hazard_) motion_hazard_ = implausible;
  }

  const unsigned requests = requests_.exchange(0);
  if ((requests & level_request) != 0) player_.level(static_cast<double>(wanted_level_.load()) / 1e6);
  const bool stands = mode_ == Mode::safe && at_rest();
  if (stands && (requests & (bit(Request::acknowledge) | bit(Request::rest))) != 0) rig_.stop_button.release();
  hand_wanted_ = wants_hold_to_run(requests);
  std::optional<Trip> hazard = find_hazard(now);
  if (!hazard && (requests & (bit(Request::stop) | bit(Request::end))) != 0 && mode_ != Mode::safe) {
    hazard = Trip{.reason = Reason::stop_requested, .time = now};
  }
  constexpr std::array before_arming{Request::stop, Request::acknowledge, Request::rest, Request::arm};
  constexpr std::array after_arming{Request::disarm, Request::start, Request::hold, Request::resume};
  for (const Request request : before_arming) take_up(request, requests, hazard, now);
  if (mode_ == Mode::arming) hazard = look_at_arming(now, hazard);
  for (const Request request : after_arming) take_up(request, requests, hazard, now);
  if (mode_ == Mode::ready && !hazard && reference_begins_ && move_.arrived() && settling_left_ == 0) {
    follow(Event::in_position);
    sample_ = 0;
  }

  Record record;
  record.period = periods_++;
  record.sample = in_run(mode_) ? sample_ : 0;
  record.time = now;
  record.due = due_ - settings_.period;
  record.late = lateness_;
  record.mode = mode_;
  if (hil_.alive()) hil_.receive(samples_.value(Channel::F), in_run(mode_), sample_);
  note_values(record);

  const bool runs = in_run(mode_);
  if (hazard && matters(*hazard)) trip(*hazard);
  // Power that nobody gave is said in any case: a press that lasts does not hide it.
  if (power_hazard_ && !(hazard && hazard->reason == power_hazard_->reason)) trip(*power_hazard_);
  command_area(now);
  compute(now);
  act(now);
  if (Companion* companion = companion_.get()) companion->opened(openings_);
  if (runs && in_run(mode_)) ++sample_;

  counters_.failed_enables = power_.failures();
  counters_.missed_frames = samples_.missed_frames();
  counters_.bridged_samples = samples_.bridged_count();
  counters_.limited_commands = command_guard_.limited_count();
  record.trip = trip_;
  record.second = second_.reason;
  record.enabled = power_.on();
  record.level = player_.level();
  record.tare = tare();
  record.energy_fed = hil_.energy().fed();
  record.energy_taken = hil_.energy().taken();
  record.command = command_;
  record.openings = openings_;
  if (const Companion* companion = companion_.get()) record.openings = companion->standing();
  record.counters = counters_;
  journal_.push(record);
}

void ControlLoop::estimate(hal::Time now) {
  estimator_.step(samples_);
  if (Companion* companion = companion_.get()) companion->follow(samples_, now);
}

void ControlLoop::keep_time(hal::Time now) {
  if (due_ == hal::never) due_ = now;
  lateness_ = now - due_;
  if (lateness_guard_.follow(lateness_, rig_.clock.suspended())) {
    ++counters_.late_periods;
    due_ = now;
  }
  due_ += settings_.period;
}

/// A slow motion is slow, and meets less force than a run; one that leads back from a force may have it for as long as it falls.
void ControlLoop::set_low_limits() {
  const bool returns = moves_in_safe();
  const bool slow = returns || (leads_drive(mode_) && !in_run(mode_));
  samples_.judge_force(slow ? settings_.limits.highest_low_force() : settings_.limits.force, returns);
  motion_guard_.move_slowly(slow && !(returns && return_.braking()));
  if (returns && return_.braking()) samples_.begin_growth();  // until it stands nothing can be done but brake
}

/// While the drive has power it must go where it is told, in every state; without power it must stand. Arming has
/// checks of its own for sensors that do not answer.
void ControlLoop::watch_motion(hal::Time now) {
  motion_hazard_.reset();
  const Channel channel = position_channel();
  std::optional<double> position;
  if (samples_.good(channel)) position = samples_.value(channel);
  power_hazard_ = power_.watch(position, now);
  if (!power_.on()) {
    motion_guard_.start(command_guard_.last().position);
    frozen_guard_.start();
    force_guard_.start();
    return;
  }
  motion_hazard_ = motion_guard_.follow(command_guard_.last(), samples_, now, mode_ == Mode::arming);
  if (mode_ == Mode::arming) {
    frozen_guard_.start();
    return;
  }
  std::optional<Channel> known;
  if (expects_trip_ && trip_.reason == Reason::sensor_frozen) known = trip_.channel;
  const std::optional<Trip> frozen =
      frozen_guard_.follow(samples_, motion_guard_.expected(), command_guard_.last(), now, known);
  if (!motion_hazard_) motion_hazard_ = frozen;
  if (!in_run(mode_)) {
    force_guard_.start();
    return;
  }
  const std::optional<Trip> implausible = force_guard_.follow(samples_, now);
  if (!motion_hazard_) motion_hazard_ = implausible;
}

bool ControlLoop::level(double wanted) {
  if (!(wanted >= 0.0 && wanted <= ReferencePlayer::highest_level)) return false;
  wanted_level_.store(static_cast<std::uint32_t>(wanted * 2e6 + 1.0) / 2);
  requests_.fetch_or(level_request);
  return true;
}

std::optional<Trip> ControlLoop::find_hazard(hal::Time now) {
  // The first that matters; one that lasts from the trip must not hide another.
  stop_hazard_ = find_stop(now);
  interlock_hazard_ = find_open_interlock(now);
  const std::array<std::optional<Trip>, 8> all{stop_hazard_,      interlock_hazard_,       power_hazard_,
                                               samples_.hazard(), samples_.limit_hazard(), lateness_guard_.hazard(now),
                                               motion_hazard_,    samples_.lasting()};
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
  open_interlocks_ = open ? *open & (hand_wanted_ ? ~0U : ~settings_.arming.hold_to_run) : 0;
  if (!open) return Trip{.reason = Reason::interlocks_lost, .time = now};
  if (open_interlocks_ == 0) return std::nullopt;
  std::int8_t first = 0;
  while ((open_interlocks_ >> static_cast<unsigned>(first) & 1U) == 0) ++first;
  return Trip{.reason = Reason::interlock, .time = now, .interlock = first};
}

/// Somebody holds a contact closed for as long as the rig arms, and is led back to rest.
bool ControlLoop::wants_hold_to_run(unsigned requests) const {
  const bool arms = mode_ == Mode::arming || (mode_ == Mode::idle && (requests & bit(Request::arm)) != 0);
  const bool led = mode_ == Mode::safe && (led_back_ || (requests & bit(Request::rest)) != 0);
  return arms || led;
}

std::optional<Trip> ControlLoop::find_untested_stop(hal::Time now) const {
  const double allowed = settings_.arming.stop_test;
  if (allowed <= 0.0 || arming_.powered()) return std::nullopt;
  const hal::Time tested = rig_.stop_button.tested_at();
  const double since = tested == hal::never ? never_reached : (now - tested).seconds();
  if (since <= allowed) return std::nullopt;
  return Trip{.reason = Reason::arming_stop_untested, .value = since, .limit = allowed, .time = now};
}

/// Without power only a stop acts, and what shows that there is power or motion. On the way to rest the hazard that led
/// there may last; any other acts, and a force that grows.
bool ControlLoop::matters(const Trip& hazard) const {
  if (leads_drive(mode_)) return true;
  const bool always = is_stop(hazard.reason) || takes_heartbeat(hazard.reason);
  if (mode_ == Mode::idle) return always || hazard.reason == Reason::stop_requested;
  const bool lasts = expects_trip_ && hazard.reason == trip_.reason && hazard.channel == trip_.channel;
  if (hazard.reason == Reason::force) return moves_in_safe() && samples_.limit_hazard().has_value();
  return !lasts && (always || ((moves_in_safe() || power_.on()) && !is_lasting(hazard)));
}

/// A bad channel that was bad when the rig tripped.
bool ControlLoop::is_lasting(const Trip& hazard) const {
  const std::optional<Trip>& lasting = samples_.lasting();
  return lasting && hazard.reason == lasting->reason && hazard.channel == lasting->channel;
}

bool ControlLoop::allowed(const RequestRule& rule, bool hazard) const {
  if ((rule.needs & need::standing) != 0 && !at_rest()) return false;
  if ((rule.needs & need::no_hazard) != 0 && hazard) return false;
  if ((rule.needs & need::proven) != 0 && !proven_) return false;
  return (rule.needs & need::moving) == 0 || moves_in_safe();
}

/// A request, in the state that those before it have led to.
void ControlLoop::take_up(Request request, unsigned requests, const std::optional<Trip>& hazard, hal::Time now) {
  if ((requests & bit(request)) == 0) return;
  if (request == Request::rest) rest_refusals_.clear();
  const RequestRule* rule = rule_of(request, mode_);
  if (rule == nullptr) return;
  if (!allowed(*rule, hazard.has_value())) {
    if (request == Request::rest && hazard && proven_) list_refusals(rest_refusals_, *hazard, now);
    return;
  }
  switch (request) {
    case Request::stop:
      if (mode_ == Mode::safe) trip({.reason = Reason::stop_requested, .time = now});  // else it is a hazard
      return;
    case Request::arm:
      begin_arming(now);
      return;
    case Request::start:
      get_ready();
      return;
    case Request::rest:
      if (const auto there = place()) begin_at_rest(*there);
      follow(rule->event);
      return_to_rest(0.0);
      held_ = false;
      led_back_ = true;
      expects_trip_ = false;
      samples_.bear_nothing();
      return;
    default:
      follow(rule->event);
      if (request == Request::hold) player_.hold();
      if (request == Request::resume) player_.resume();
  }
}

/// One line of the table of transitions.
void ControlLoop::follow(Event event) {
  const Transition line = transition(mode_, event);
  mode_ = line.to;
  if (line.power == Power::give) power_.give();
  if (line.power == Power::take) power_.take();
  if (event == Event::checked) proven_ = true;
  if (event == Event::arm || mode_ == Mode::idle) proven_ = false;
  if (mode_ == Mode::idle) starved_ = false;
}

std::optional<double> ControlLoop::place() const {
  const std::optional<double> there = settings_.arming.position_tolerance > 0.0 ? power_.place() : std::nullopt;
  if (!there) return std::nullopt;
  const double half_stroke = 0.5 * settings_.limits.stroke;
  return *there > half_stroke ? half_stroke : *there < -half_stroke ? -half_stroke : *there;
}

/// The command rests at `position`, as if it had done so for long.
void ControlLoop::begin_at_rest(double position) {
  command_guard_.passed({position, 0.0, 0.0});
  command_guard_.passed({position, 0.0, 0.0});
}

void ControlLoop::return_to_rest(double velocity) {
  return_ =
      ReturnToRest(command_guard_.last().position, velocity, settings_.ramps, 0.5 * settings_.limits.stroke, period_);
}

void ControlLoop::begin_arming(hal::Time now) {
  follow(Event::arm);
  trip_ = {};
  second_ = {};
  expects_trip_ = false;
  samples_.bear_nothing();
  samples_.tare(force_channel(), 0.0);
  refusals_.clear();
  place_shown_ = false;
  double home = place().value_or(command_guard_.last().position);
  if (settings_.arming.position_tolerance > 0.0 && power_.always()) {
    const hal::Result<double> shown = rig_.command.read_back();  // the drive has power: there it is told to be
    if (shown) home = *shown;
  }
  begin_at_rest(home);
  // A recording begins here: what the estimators saw before would be missing in its replay.
  estimator_.restart();
  if (Companion* companion = companion_.get()) companion->restart();
  estimate(now);
  arming_.begin(home, now, sign_shown_ || power_.always());
}

/// The checks of arming, unless a hazard ends it already; what ends it.
std::optional<Trip> ControlLoop::look_at_arming(hal::Time now, std::optional<Trip> hazard) {
  ArmingChecks::Seen seen{.now = now, .command = command_guard_.last().position};
  if (settings_.arming.position_tolerance > 0.0) {
    const hal::Result<double> shown = rig_.command.read_back();
    if (shown) seen.read_back = *shown;
    seen.silent = !shown && shown.fault() == hal::Fault::timeout;
    if (!hazard && !shown && shown.fault() == hal::Fault::disconnected) {
      hazard = Trip{.reason = Reason::command_failed, .time = now};
    }
    if (samples_.fitted(position_channel())) seen.position = samples_.value(position_channel());
  }
  if (samples_.fitted(force_channel())) seen.force = samples_.value(force_channel());
  const std::optional<Trip> untested = find_untested_stop(now);
  if (!hazard) hazard = untested;
  if (hazard) {
    arming_.list(seen);
  } else {
    hazard = arming_.look(seen);
  }
  if (hazard) {
    if (hazard->reason == Reason::arming_polarity_x_act) sign_shown_ = false;
    if (is_fault(hazard->reason)) list_refusals(refusals_, *hazard, now);
    return hazard;
  }
  place_shown_ = place_shown_ || arming_.powered();
  if (arming_.powered() && !power_.wanted()) follow(Event::compared);
  if (arming_.done()) {
    samples_.tare(force_channel(), arming_.tare());
    sign_shown_ = sign_shown_ || settings_.arming.probe_amplitude > 0.0;
    follow(Event::checked);
  }
  return std::nullopt;
}

/// Everything that is wrong in the period in which an arming or a `rest` is refused, so that it can be put right at once.
void ControlLoop::list_refusals(Refusals& list, const Trip& first, hal::Time now) const {
  list.clear();
  list.add(first);
  const auto add = [&list](const std::optional<Trip>& hazard) {
    if (hazard) list.add(*hazard);
  };
  add(stop_hazard_);
  add(interlock_hazard_);
  for (std::int8_t i = 0; i < static_cast<std::int8_t>(hal::Interlocks::capacity); ++i) {
    if ((open_interlocks_ >> static_cast<unsigned>(i) & 1U) == 0) continue;
    list.add({.reason = Reason::interlock, .time = now, .interlock = i});
  }
  add(power_hazard_);
  samples_.each_hazard(now, add);
  add(motion_hazard_);
  add(find_untested_stop(now));
  for (const Trip& failed : arming_.failed()) list.add(failed);
}

void ControlLoop::get_ready() {
  follow(Event::start);
  trip_ = {};
  second_ = {};
  const std::optional<Motion> begin = player_.start();
  reference_begins_ = begin.has_value();
  if (!reference_begins_) return;
  hil_.start(*begin);
  move_ = SmoothMove(command_guard_.last().position, hil() ? 0.0 : begin->position, settings_.ramps.rate, period_);
  settling_left_ = (hal::seconds(settings_.ramps.settling).ns + settings_.period.ns - 1) / settings_.period.ns;
}

/// The first reason counts; what follows it in safe is kept beside it: the first, or the first that shows power which
/// nobody gave.
void ControlLoop::trip(const Trip& trip) {
  const bool stays = trip.reason == Reason::command_failed || !power_.on();
  const double velocity = stays ? 0.0 : command_guard_.velocity();
  if (takes_heartbeat(trip.reason)) starved_ = true;
  if (loses_power(trip.reason)) proven_ = false;
  led_back_ = false;
  if (mode_ == Mode::safe) {
    const bool power_unknown = takes_heartbeat(trip_.reason) || takes_heartbeat(second_.reason);
    if (second_.reason == Reason::none || (takes_heartbeat(trip.reason) && !power_unknown)) second_ = trip;
    if (moves_in_safe() && !held_) brake_and_hold(velocity);
    follow(Event::halt);
    return;
  }
  const Event event = event_of(trip.reason, mode_, power_.on());
  trip_ = trip;
  second_ = {};
  follow(event);
  hil_.end();
  held_ = false;
  expects_trip_ = true;
  if (event == Event::halt) {
    brake_and_hold(velocity);
  } else {
    return_to_rest(velocity);
  }
  samples_.bear();
}

void ControlLoop::brake_and_hold(double velocity) {
  held_ = true;
  return_ = ReturnToRest::brake_and_hold(command_guard_.last().position, velocity, settings_.ramps,
                                         0.5 * settings_.limits.stroke, period_);
}

/// The area of an air spring for the period that begins: by the skyhook in a run, else as it is at rest.
void ControlLoop::command_area(hal::Time now) {
  if constexpr (has_area) {
    if (!area_control_.wanted()) return;
    const double velocity = hil_.alive() ? hil_.body_velocity() : estimator_.velocities().body;
    const double area = in_run(mode_) ? area_control_.command(velocity) : 0.0;
    if (rig_.area->write(area) || !leads_drive(mode_)) return;
    trip({.reason = Reason::command_failed, .time = now});
  } else {
    static_cast<void>(now);
  }
}

void ControlLoop::compute(hal::Time now) {
  hil_.forget_hazard();
  if (leads_drive(mode_)) {
    const std::optional<hal::Command> wanted = wanted_command(now);
    if (!wanted) {
      trip({.reason = Reason::reference_ended, .time = now});
    } else if (hil_.hazard()) {
      trip(*hil_.hazard());
    } else {
      const CommandGuard::Verdict verdict = command_guard_.judge(*wanted, now);
      command_ = verdict.command;
      if (verdict.hazard) trip(*verdict.hazard);
    }
  }
  // In safe the enable goes one period after the last command of the way to rest, so that the drive gets there.
  if (mode_ == Mode::safe && (held_ || standing())) {
    follow(Event::arrived);
    led_back_ = false;
  }
  if (mode_ == Mode::safe) command_ = return_.next();
  if (mode_ == Mode::idle) command_ = {command_guard_.last().position, 0.0, 0.0};
  if (mode_ != Mode::ready && !in_run(mode_)) openings_ = rig_.valves.safe_position();
}

/// Where the drive shall be one period on, in a state that leads it; nothing: the reference has ended.
std::optional<hal::Command> ControlLoop::wanted_command(hal::Time now) {
  if (mode_ == Mode::arming) return arming_.next();
  if (mode_ == Mode::armed) return hal::Command{command_guard_.last().position, 0.0, 0.0};
  if (mode_ == Mode::ready) {
    if (!reference_begins_) return std::nullopt;
    if (move_.arrived()) --settling_left_;
    openings_ = valves_.at(hal::Time{});
    return move_.next();
  }
  openings_ = valves_.at(settings_.period * static_cast<std::int64_t>(player_.sample()));
  const std::optional<hal::Command> wanted = follow_reference(now);
  if (Companion* companion = companion_.get()) openings_ = companion->choose(openings_);
  return wanted;
}

std::optional<hal::Command> ControlLoop::follow_reference(hal::Time now) {
  const std::optional<Motion> there = player_.next();
  if (!there) return std::nullopt;
  if (!hil()) return hal::Command{there->position, there->velocity, there->acceleration};
  const HilInterface::Instant instant{command_guard_.last().position, openings_, sample_, now};
  return hil_.step(*there, instant, samples_);
}

void ControlLoop::act(hal::Time now) {
  if (!has_high_pressure(mode_)) write_high_pressure(now);
  if (!power_.wanted()) write_enable(now);  // off first, on last
  bool valves_stand = write_valves();
  if (!valves_stand && (leads_drive(mode_) || power_.wanted())) {
    lose_power({.reason = Reason::valves_failed, .time = now});
    command_ = return_.next();
    write_enable(now);
    valves_stand = write_valves();
  }
  if (writes_command()) write_command(now, valves_stand);
  write_enable(now);
  write_high_pressure(now);

  // Without beats the watchdog makes the valves safe and takes the power.
  if (!valves_stand || !power_.written() || starved_) return;
  if (rig_.heartbeat.beat()) return;
  ++counters_.failed_beats;
  if (!leads_drive(mode_) && !power_.wanted()) return;
  lose_power({.reason = Reason::heartbeat_failed, .time = now});
  (void)write_valves();
  write_enable(now);
}

/// A drive that has power at all times is told nothing before a comparison has shown where it stands: the converter that
/// says so may lie, and the command would be a jump.
bool ControlLoop::writes_command() const { return mode_ != Mode::idle && (place_shown_ || !power_.always()); }

void ControlLoop::write_command(hal::Time now, bool& valves_stand) {
  const hal::Result<void> written = rig_.command.write(command_);
  if (written) {
    command_guard_.passed(command_);
    failed_commands_in_a_row_ = 0;
    return;
  }
  const int most = settings_.limits.bridged_in_a_row;
  ++counters_.failed_commands;
  if (failed_commands_in_a_row_ < most) ++failed_commands_in_a_row_;
  const bool lost = written.fault() != hal::Fault::timeout || failed_commands_in_a_row_ >= most;
  if (lost && (leads_drive(mode_) || (mode_ == Mode::safe && !held_ && !standing()))) {
    lose_power({Reason::command_failed, std::nullopt, static_cast<double>(failed_commands_in_a_row_),
                static_cast<double>(most), now});
    valves_stand = write_valves();
  } else if (mode_ == Mode::safe && held_) {  // the drive has stayed where it was: begin again from there
    brake_and_hold(0.0);
  } else if (mode_ == Mode::safe && power_.on()) {
    return_to_rest(0.0);
  }
}

/// The watchdog takes the power, or has taken it, or nobody knows. The next beat, or a line that takes writes again,
/// would give it back wherever the command is by then: so it is withdrawn here too.
void ControlLoop::lose_power(const Trip& cause) {
  trip(cause);
  openings_ = rig_.valves.safe_position();
  (void)power_.write_high_pressure(false);  // first; tried again by the next period
}

/// At a change, and again after a fault.
void ControlLoop::write_enable(hal::Time now) {
  if (power_.write(now)) return;
  if (!leads_drive(mode_) && !power_.wanted()) return;
  lose_power({.reason = Reason::enable_failed, .time = now});
  (void)write_valves();
  (void)power_.write(now);
}

/// The second stage of the power unit: not before a probe has passed, and gone first.
void ControlLoop::write_high_pressure(hal::Time now) {
  if (power_.write_high_pressure(has_high_pressure(mode_))) return;
  if (!leads_drive(mode_) && !power_.wanted()) return;
  lose_power({.reason = Reason::enable_failed, .time = now});
  write_enable(now);
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
  hil_.note(record, command_guard_.last().position, in_run(mode_));
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
