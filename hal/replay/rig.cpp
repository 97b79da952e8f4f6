#include "hal/replay/rig.hpp"

namespace hal::replay {
namespace {

/// How long a suspension lasted is on record as the value of its trip only; so long is one for every limit [s].
constexpr double longest_gap = 3600.0;

/// Fitted is what the recorded rig had and the recording still has.
SensorSetup fitted_by(const Recording& recording, SensorSetup setup) {
  for (std::size_t i = 0; i < channel_capacity; ++i) {
    setup[i].fitted = setup[i].fitted && !recording.columns[i].values.empty();
  }
  return setup;
}

}  // namespace

Rig::Rig(const Recording& recording, const SensorSetup& setup, std::size_t ducts, Openings safe_position,
         const OutputStorage& storage)
    : recording_(recording),
      commands_(storage.commands),
      openings_(storage.openings),
      beats_(storage.beats),
      sensor_role_(*this, fitted_by(recording, setup)),
      valve_role_(*this, ducts, safe_position),
      enable_role_(*this, recording.drive_enable),
      interlock_role_(*this) {
  require(recording.check().empty(), "a recording to be replayed is sound");
}

hal::Rig Rig::roles() {
  return {clock_role_,     sensor_role_, valve_role_,     command_role_, button_role_,
          heartbeat_role_, enable_role_, interlock_role_, &area_role_};
}

Time Rig::now() const {
  if (!ended()) return recording_.time[row_];
  return recording_.time.back() + nanoseconds(1);  // after the last row; how long after, nobody recorded
}

bool Rig::refuses(Refusal::Output output) const {
  const Refusal& refusal = recording_.refusal;
  return refusal.from != never && refusal.output == output && refusal.from <= now();
}

Time Rig::ClockRole::do_suspended() {
  const Time at = rig.recording_.suspended;
  return at != never && at <= rig.now() ? seconds(longest_gap) : Time{};
}

void Rig::ClockRole::do_sleep_until(Time /*deadline*/) {
  if (rig.started_ && !rig.ended()) ++rig.row_;
  rig.started_ = true;
}

Result<Frame> Rig::SensorRole::do_read() {
  if (rig.ended()) return Fault::disconnected;
  Frame frame;
  for (std::size_t i = 0; i < channel_capacity; ++i) {
    const Column& column = rig.recording_.columns[i];
    if (column.values.empty()) continue;
    const Time taken = column.taken.empty() ? rig.now() : column.taken[rig.row_];
    if (taken != never) frame.channels[i] = {column.values[rig.row_], taken, Quality::good};
  }
  return frame;
}

Result<void> Rig::ValveRole::do_write(Openings openings) {
  if (rig.refuses(Refusal::Output::valves)) return Fault::refused;
  rig.openings_.keep(rig.now(), openings);
  return {};
}

Result<void> Rig::CommandRole::do_write(const Command& command) {
  if (rig.refuses(Refusal::Output::command)) return Fault::refused;
  rig.commands_.keep(rig.now(), command);
  rig.held_ = command.position;
  return {};
}

Result<void> Rig::EnableRole::do_write(bool on) {
  if (rig.refuses(Refusal::Output::enable)) return Fault::refused;
  rig.enabled_ = on;
  return {};
}

Result<std::uint32_t> Rig::InterlockRole::do_read() {
  std::uint32_t open = 0;
  for (const Opened& opened : rig.recording_.interlocks_opened) {
    if (opened.time <= rig.now()) open |= std::uint32_t{1} << opened.interlock;
  }
  return open;
}

Result<StopButton::Level> Rig::ButtonRole::do_read() {
  const bool pressed = rig.recording_.stop_pressed != never && rig.recording_.stop_pressed <= rig.now();
  return Level{pressed, rig.recording_.stop_pressed};
}

Result<void> Rig::HeartbeatRole::do_beat() {
  if (rig.refuses(Refusal::Output::heartbeat)) return Fault::refused;
  rig.beats_.keep(rig.now(), rig.beat_count_++);
  return {};
}

}  // namespace hal::replay
