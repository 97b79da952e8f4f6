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

}  // namespace
