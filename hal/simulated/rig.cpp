#include "hal/simulated/rig.hpp"

#include <algorithm>
#include <array>

namespace hal::simulated {

Rig::Rig(Plant& plant, const Construction& construction, const FaultPlan& plan)
    : plant_(plant),
      construction_(construction),
      plan_(plan),
      channel_faults_(plan),
      now_(construction.start),
      instant_(construction.start),
      held_command_(construction.rest),
      enabled_(!construction.drive_enable),
      drive_(construction.rest),
      held_openings_(construction.safe_position),
      last_beat_(construction.start),
      sensor_role_(*this, construction.sensors),
      valve_role_(*this, construction.ducts, construction.safe_position),
      interlock_role_(*this, construction.interlocks) {
  require(construction.period > Time{}, "a simulated rig has a period above 0");
  require(construction.coasting > 0.0, "a drive without its enable comes to a stop");
  require(plan.check().empty(), "a fault plan is sound");
}

hal::Rig Rig::roles() {
  return {clock_role_,  sensor_role_,
          valve_role_,  command_role_,
          button_role_, heartbeat_role_,
          enable_role_, interlock_role_,
          &area_role_,  construction_.high_pressure ? &pressure_role_ : nullptr};
}

bool Rig::watchdog_has_acted() const {
  return construction_.watchdog > Time{} && now_ - last_beat_ > construction_.watchdog;
}

Openings Rig::openings() const { return watchdog_has_acted() ? construction_.safe_position : held_openings_; }

void Rig::pass_time(Time deadline) {
  Time woken = std::max(deadline, now_);
  for (const LateWake& late : plan_.late_wakes) {
    if (late.window.contains(deadline)) woken += late.by;
  }
  while (instant_ + construction_.period <= woken) {
    measure();
    now_ = std::max(now_, instant_);  // the watchdog looks at the time of the step, not at the end of the sleep
    move_drive();
    plant_.advance(drive_, openings());
    instant_ += construction_.period;
    measured_ = false;
  }
  now_ = woken;
}

/// Of the drive's enable, whatever its output says.
bool Rig::contact_closed() const {
  for (const StuckEnable& stuck : plan_.stuck_enables) {
    if (stuck.window.contains(now_)) return stuck.on;
  }
  return enabled_;
}

bool Rig::powered() const { return !construction_.drive_enable || (contact_closed() && !watchdog_has_acted()); }

void Rig::move_drive() {
  for (const StuckDrive& stuck : plan_.stuck_drives) {
    if (!stuck.window.contains(now_) || (stuck.velocity != 0.0 && !powered())) continue;
    drive_.velocity = stuck.velocity;
    drive_.acceleration = 0.0;
    drive_.position += stuck.velocity * construction_.period.seconds();
    return;
  }
  if (powered()) {
    drive_ = held_command_;
    return;
  }
  const double period = construction_.period.seconds();
  const double slower = construction_.coasting * period;
  double& v = drive_.velocity;
  v = v > slower ? v - slower : v < -slower ? v + slower : 0.0;
  drive_.acceleration = 0.0;
  drive_.position += v * period;
  for (const Push& push : plan_.pushes) {
    if (push.window.contains(now_)) drive_.position += push.velocity * period;
  }
}

void Rig::measure() {
  if (measured_) return;
  std::array<double, channel_capacity> values{};
  plant_.measure(values);
  Frame shown;
  for (std::size_t i = 0; i < channel_capacity; ++i) {
    if (construction_.sensors[i].fitted) shown.channels[i] = {values[i], instant_, Quality::good};
  }
  frame_ = channel_faults_.apply(shown, instant_);
  measured_ = true;
}

std::optional<Fault> Rig::fault_of(DeviceFault::Device device) const {
  for (const DeviceFault& fault : plan_.devices) {
    if (fault.device == device && fault.window.contains(now_)) return fault.fault;
  }
  return std::nullopt;
}

Time Rig::ClockRole::do_suspended() {
  Time sum{};
  for (const Suspension& suspension : rig.plan_.suspensions) {
    if (suspension.at <= rig.now_) sum += suspension.length;
  }
  return sum;
}

Result<Frame> Rig::SensorRole::do_read() {
  rig.measure();
  if (const auto fault = rig.fault_of(DeviceFault::Device::sensors)) return *fault;
  return rig.frame_;
}

Result<void> Rig::ValveRole::do_write(Openings openings) {
  if (const auto fault = rig.fault_of(DeviceFault::Device::valves)) return *fault;
  rig.held_openings_ = openings;
  return {};
}

Result<void> Rig::CommandRole::do_write(const Command& command) {
  if (const auto fault = rig.fault_of(DeviceFault::Device::command)) return *fault;
  rig.held_command_ = command;
  return {};
}

Result<void> Rig::AreaRole::do_write(double area) {
  if (const auto fault = rig.fault_of(DeviceFault::Device::area)) return *fault;
  rig.plant_.command_area(area);
  return {};
}

Result<double> Rig::CommandRole::do_read_back() {
  if (const auto fault = rig.fault_of(DeviceFault::Device::command)) return *fault;
  double position = rig.held_command_.position;
  for (const ReadBackError& error : rig.plan_.read_back_errors) {
    if (error.window.contains(rig.now_)) position += error.offset;
  }
  return position;
}

Result<void> Rig::EnableRole::do_write(bool on) {
  if (const auto fault = rig.fault_of(DeviceFault::Device::drive_enable)) return *fault;
  if (rig.construction_.drive_enable) rig.enabled_ = on;
  return {};
}

Result<void> Rig::PressureRole::do_write(bool on) {
  if (const auto fault = rig.fault_of(DeviceFault::Device::high_pressure)) return *fault;
  rig.high_pressure_ = on;
  return {};
}

Result<bool> Rig::EnableRole::do_feedback() {
  if (const auto fault = rig.fault_of(DeviceFault::Device::enable_feedback)) return *fault;
  for (const StuckFeedback& stuck : rig.plan_.stuck_feedbacks) {
    if (stuck.window.contains(rig.now_)) return stuck.shows;
  }
  return rig.contact_closed();
}

Result<std::uint32_t> Rig::InterlockRole::do_read() {
  if (const auto fault = rig.fault_of(DeviceFault::Device::interlocks)) return *fault;
  std::uint32_t open = 0;
  for (const OpenInterlock& opening : rig.plan_.open_interlocks) {
    const bool began = opening.window.from <= rig.now_;
    const bool seen_before = opening.window.until <= last_read;
    if (began && !seen_before && opening.interlock < count()) open |= std::uint32_t{1} << opening.interlock;
  }
  last_read = rig.now_;
  return open;
}

Result<StopButton::Level> Rig::ButtonRole::do_read() {
  if (const auto fault = rig.fault_of(DeviceFault::Device::stop_button)) return *fault;
  Level level;
  for (const Press& press : rig.plan_.presses) {
    const bool began = press.window.from <= rig.now_;
    const bool seen_before = press.window.until <= last_read;
    if (!began || seen_before) continue;
    if (!level.pressed || press.window.from < level.since) level = {true, press.window.from};
    if (press.contacts != Press::Contacts::second) first_opened = press.window.from;
    if (press.contacts != Press::Contacts::first) second_opened = press.window.from;
  }
  level.one_contact = !StopChannels::one_press(first_opened, second_opened);
  last_read = rig.now_;
  bool first = false, second = false;
  for (const Press& press : rig.plan_.presses) {
    if (!press.window.contains(rig.now_)) continue;
    first = first || press.contacts != Press::Contacts::second;
    second = second || press.contacts != Press::Contacts::first;
  }
  if (!channels.agree(first, second, rig.now_)) return Fault::refused;
  return level;
}

Result<void> Rig::HeartbeatRole::do_beat() {
  if (const auto fault = rig.fault_of(DeviceFault::Device::heartbeat)) return *fault;
  rig.last_beat_ = rig.now_;
  ++rig.beats_;
  return {};
}

}  // namespace hal::simulated
