// A run played to the control program again.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "hal/replay/rig.hpp"
#include "tests/firmware/loop/rig_under_test.hpp"

namespace {

using namespace rig_under_test;
using firmware::Reason;
using hal::simulated::ChannelFault;
using hal::simulated::LateWake;
using hal::simulated::Press;
using Kind = ChannelFault::Kind;
using model::RigKind;

/// What a journal knows of the samples, as a recording in memory.
struct Tape {
  explicit Tape(const std::vector<Record>& records, const hal::SensorSetup& sensors) {
    for (const Record& row : records) {
      time.push_back(row.time);
      for (std::size_t c = 0; c < model::channel_count; ++c) {
        values[c].push_back(row.values[c]);
        taken[c].push_back(row.taken[c]);
      }
    }
    recording.time = time;
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      if (sensors[c].fitted) recording.columns[c] = {values[c], taken[c]};
    }
  }
  std::vector<hal::Time> time;
  std::array<std::vector<double>, model::channel_count> values;
  std::array<std::vector<hal::Time>, model::channel_count> taken;
  hal::replay::Recording recording;
};

void expect_same_bits(const Record& a, const Record& b) {
  const auto same = [](double x, double y) {
    return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
  };
  ASSERT_EQ(a.period, b.period);
  ASSERT_EQ(a.time, b.time);
  ASSERT_EQ(a.mode, b.mode) << a.period;
  ASSERT_EQ(a.trip.reason, b.trip.reason) << a.period;
  ASSERT_EQ(a.bridged, b.bridged) << a.period;
  ASSERT_EQ(a.openings, b.openings) << a.period;
  ASSERT_EQ(a.counters.late_periods, b.counters.late_periods) << a.period;
  ASSERT_EQ(a.counters.bridged_samples, b.counters.bridged_samples) << a.period;
  ASSERT_TRUE(same(a.command.position, b.command.position) && same(a.command.velocity, b.command.velocity) &&
              same(a.command.acceleration, b.command.acceleration))
      << a.period;
  ASSERT_TRUE(same(a.velocities.wheel, b.velocities.wheel) && same(a.velocities.body, b.velocities.body) &&
              same(a.velocities.foot_point, b.velocities.foot_point) &&
              same(a.velocities.deflection, b.velocities.deflection) && same(a.wheel_load, b.wheel_load))
      << a.period;
  for (std::size_t c = 0; c < model::channel_count; ++c) ASSERT_TRUE(same(a.values[c], b.values[c])) << a.period;
}

// A recording replayed through the same firmware gives the same outputs, to the bit: also one of a run with dropped,
// frozen, late and corrupt samples, late periods and, in the end, the stop button.
TEST(Replay, GivesTheSameOutputsToTheBit) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::hil, RigKind::component_bench}) {
    const std::size_t channel = model::index(kind == RigKind::quarter_car ? Channel::dz_b : Channel::x_act);
    const std::array<ChannelFault, 5> faults{
        {{.kind = Kind::drop, .channel = channel, .probability = 0.05},
         {.kind = Kind::not_a_number, .channel = channel, .window = {ms * 200, ms * 201}},
         {.kind = Kind::freeze, .channel = channel, .window = {ms * 250, ms * 255}},
         {.kind = Kind::delay, .channel = channel, .window = {ms * 300, ms * 302}, .delay_samples = 9},
         {.kind = Kind::bit_flip, .channel = channel, .window = {ms * 350, ms * 360}, .bit = 40}}};
    const std::array<LateWake, 2> late{
        {{{ms * 100, ms * 101}, hal::microseconds(700)}, {{ms * 400, ms * 402}, hal::microseconds(1300)}}};
    const Press press{{hal::microseconds(700'300), hal::microseconds(700'400)}};
    Scene scene(kind, 2000);
    scene.faults = {.channels = faults, .presses = {&press, 1}, .late_wakes = late, .seed = 5};
    Journey live{scene};
    live.whole();
    ASSERT_EQ(live.loop.trip().reason, Reason::stop_button) << name(live.loop.trip().reason) << ", seed 5";
    ASSERT_GT(live.loop.counters().bridged_samples, 10U);
    ASSERT_GE(live.loop.counters().late_periods, 2U);

    Tape tape(live.records, scene.sensors);
    tape.recording.stop_pressed = press.window.from;
    std::vector<hal::replay::Written<hal::Command>> commands(live.records.size());
    std::vector<hal::replay::Written<hal::Openings>> openings(live.records.size());
    hal::replay::Rig rig(tape.recording, scene.sensors, 6, scene.safe_position, {commands, openings, {}});
    firmware::TableReference reference(scene.reference);
    std::vector<Record> storage(live.records.size());
    firmware::Journal journal(storage);
    firmware::ControlLoop loop(scene.settings, scene.parameters, rig.roles(), reference, scene.valves, journal);
    loop.arm();
    loop.start();
    std::size_t left = live.records.size();
    loop.run([&left] { return left-- > 0; });

    for (std::size_t k = 0; k < live.records.size(); ++k) {
      const auto replayed = journal.pop();
      ASSERT_TRUE(replayed);
      expect_same_bits(live.records[k], *replayed);
      ASSERT_EQ(rig.commands().written()[k].value, live.records[k].command) << name(kind);
      ASSERT_EQ(rig.openings().written()[k].value, live.records[k].openings) << name(kind);
    }
  }
}

// Arming is part of what is replayed: comparing, taring, the probe, and the offset that is taken from F from then on.
// The rig that was recorded had an enable and an interlock that opened in the end.
TEST(Replay, ArmsAgainToTheBit) {
  const hal::simulated::OpenInterlock open{1, {ms * 2500, ms * 9000}};
  Scene scene(RigKind::hil, 2000);
  scene.settings.arming = {.tare_time = 0.2, .preload = 1000.0, .position_tolerance = 5e-3, .probe_amplitude = 2e-3};
  scene.settings.arming.force_ramp = 0.3;
  scene.deviations.force_offset = 400.0;
  scene.deviations.force_noise = 20.0;
  scene.faults.open_interlocks = {&open, 1};
  Journey live{scene};
  const auto lead = [](firmware::ControlLoop& loop, int k) {
    if (k == 20) loop.arm();
    if (k == 2000) loop.start();
  };
  for (int k = 0; k < 3000; ++k) {
    lead(live.loop, k);
    live.periods(1);
  }
  ASSERT_EQ(live.loop.trip().reason, Reason::interlock) << name(live.loop.trip().reason);
  ASSERT_GT(live.rows(firmware::Mode::running).size(), 400U);

  Tape tape(live.records, scene.sensors);
  tape.recording.drive_enable = true;
  const hal::replay::Opened opened{open.window.from, open.interlock};
  tape.recording.interlocks_opened = {&opened, 1};
  hal::replay::Rig rig(tape.recording, scene.sensors, 6, scene.safe_position, {});
  firmware::TableReference reference(scene.reference);
  std::vector<Record> storage(8);
  firmware::Journal journal(storage);
  firmware::ControlLoop loop(scene.settings, scene.parameters, rig.roles(), reference, scene.valves, journal);
  for (int k = 0; k < 3000; ++k) {
    lead(loop, k);
    rig.roles().clock.sleep_until(loop.due());
    loop.step();
    const auto replayed = journal.pop();
    ASSERT_TRUE(replayed);
    expect_same_bits(live.records[static_cast<std::size_t>(k)], *replayed);
    ASSERT_EQ(replayed->enabled, live.records[static_cast<std::size_t>(k)].enabled) << k;
    ASSERT_EQ(replayed->tare, live.records[static_cast<std::size_t>(k)].tare) << k;
  }
  EXPECT_FALSE(rig.enabled());
}

}  // namespace
