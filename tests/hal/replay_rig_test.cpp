#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "hal/replay/rig.hpp"

namespace replay_rig_test {
namespace {

using namespace hal;

constexpr Time ms = milliseconds(1);
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct Tape {
  std::array<Time, 3> time{ms, ms * 2, microseconds(3700)};
  std::array<double, 3> values{0.5, nan, 5.0};
  std::array<double, 3> late{1.0, 2.0, 3.0};
  std::array<Time, 3> taken{microseconds(900), never, microseconds(1900)};

  replay::Recording recording() const {
    replay::Recording r;
    r.time = time;
    r.columns[0].values = values;
    r.columns[2] = {late, taken};
    return r;
  }
  static SensorSetup setup() {
    SensorSetup s;
    s[0] = {true, -1.0, 2.0};
    s[1] = {true};
    s[2] = {true};
    return s;
  }
};

// The loop's decisions hang on time, stamp and quality as much as on values: all of them must come back.
TEST(Replay, PlaysValuesStampsAndTime) {
  const Tape tape;
  replay::Rig rig(tape.recording(), Tape::setup(), 1, {}, {});
  const hal::Rig roles = rig.roles();
  EXPECT_TRUE(roles.sensors.fitted(0));
  EXPECT_FALSE(roles.sensors.fitted(1)) << "no column";

  roles.clock.sleep_until(Time{});
  EXPECT_EQ(roles.clock.now(), ms);
  Result<Frame> frame = roles.sensors.read();
  EXPECT_EQ(frame->channels[0].value, 0.5);
  EXPECT_EQ(frame->channels[0].taken, ms) << "without stamps: the row's time";
  EXPECT_EQ(frame->channels[2].taken, microseconds(900));

  roles.clock.sleep_until(ms * 2);
  frame = roles.sensors.read();
  EXPECT_EQ(frame->channels[0].quality, Quality::not_finite);
  EXPECT_EQ(frame->channels[2].quality, Quality::missing) << "a stamp that says never";

  roles.clock.sleep_until(ms * 3);
  EXPECT_EQ(roles.clock.now(), microseconds(3700)) << "late as it was";
  frame = roles.sensors.read();
  EXPECT_EQ(frame->channels[0].quality, Quality::clipped) << "the ranges of the rig hold in replay, too";
  EXPECT_EQ(frame->channels[2].value, 3.0);
  EXPECT_FALSE(rig.ended());
}

TEST(Replay, IsDisconnectedAfterTheLastRow) {
  const Tape tape;
  replay::Rig rig(tape.recording(), Tape::setup(), 1, {}, {});
  const hal::Rig roles = rig.roles();
  for (int i = 0; i < 3; ++i) roles.clock.sleep_until(Time{});
  EXPECT_FALSE(rig.ended());
  roles.clock.sleep_until(Time{});
  EXPECT_TRUE(rig.ended());
  for (int i = 0; i < 3; ++i) roles.clock.sleep_until(Time{});
  EXPECT_TRUE(rig.ended());
  EXPECT_GT(roles.clock.now(), microseconds(3700));
  const Result<Frame> frame = roles.sensors.read();
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.fault(), Fault::disconnected);
}

TEST(Replay, KeepsWhatIsWrittenAndCountsWhatDoesNotFit) {
  const Tape tape;
  std::array<replay::Written<Command>, 2> commands;
  std::array<replay::Written<Openings>, 4> openings;
  std::array<replay::Written<std::uint64_t>, 4> beats;
  replay::Rig rig(tape.recording(), Tape::setup(), 2, {}, {commands, openings, beats});
  const hal::Rig roles = rig.roles();
  for (int i = 0; i < 3; ++i) {
    roles.clock.sleep_until(Time{});
    ASSERT_TRUE(roles.command.write({0.1 * i, 0.0, 0.0}));
    ASSERT_TRUE(roles.valves.write(Openings::first(1)));
    ASSERT_TRUE(roles.heartbeat.beat());
  }
  ASSERT_EQ(rig.commands().written().size(), 2U);
  EXPECT_EQ(rig.commands().lost(), 1U);
  EXPECT_EQ(rig.commands().written()[1].time, ms * 2);
  EXPECT_EQ(rig.commands().written()[1].value.position, 0.1);
  ASSERT_EQ(rig.openings().written().size(), 3U);
  EXPECT_EQ(rig.openings().written()[2].value, Openings::first(1));
  EXPECT_EQ(rig.openings().lost(), 0U);
  ASSERT_EQ(rig.beats().written().size(), 3U);
  EXPECT_EQ(rig.beats().written()[2].value, 2U);
}

TEST(Replay, PressesTheButtonWhenItWasPressed) {
  const Tape tape;
  replay::Recording recording = tape.recording();
  recording.stop_pressed = microseconds(1500);
  replay::Rig rig(recording, Tape::setup(), 1, {}, {});
  const hal::Rig roles = rig.roles();
  roles.clock.sleep_until(Time{});
  EXPECT_FALSE(*roles.stop_button.pressed());
  roles.clock.sleep_until(Time{});
  EXPECT_TRUE(*roles.stop_button.pressed());
  EXPECT_EQ(roles.stop_button.pressed_at(), microseconds(1500));
}

// Pressed at the time of a row is pressed in that row.
TEST(Replay, PressesTheButtonInTheVeryRow) {
  const Tape tape;
  replay::Recording recording = tape.recording();
  recording.stop_pressed = ms * 2;
  replay::Rig rig(recording, Tape::setup(), 1, {}, {});
  const hal::Rig roles = rig.roles();
  roles.clock.sleep_until(Time{});
  EXPECT_FALSE(*roles.stop_button.pressed());
  roles.clock.sleep_until(Time{});
  EXPECT_TRUE(*roles.stop_button.pressed());
}

TEST(Recording, SaysWhatIsWrongWithIt) {
  const Tape tape;
  EXPECT_TRUE(tape.recording().check().empty());
  EXPECT_FALSE(replay::Recording{}.check().empty());

  const std::array<Time, 3> standing{ms, ms * 2, ms * 2};
  replay::Recording recording = tape.recording();
  recording.time = standing;
  EXPECT_FALSE(recording.check().empty()) << "time stands still";

  recording = tape.recording();
  recording.columns[0].values = std::span(tape.values).first(2);
  EXPECT_FALSE(recording.check().empty()) << "short column";

  recording = tape.recording();
  recording.columns[2].taken = std::span(tape.taken).first(2);
  EXPECT_FALSE(recording.check().empty()) << "short stamps";
}

TEST(ReplayDeathTest, PlaysOnlyASoundRecording) {
  EXPECT_DEATH(replay::Rig(replay::Recording{}, Tape::setup(), 1, {}, {}), "sound");
}

}  // namespace
}  // namespace replay_rig_test
