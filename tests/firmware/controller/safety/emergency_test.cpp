// What is left when the program is beyond help: valves safe, the command to rest at the given rate, an end in any case.
#include "firmware/controller/safety/emergency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "tests/support/without_heap.hpp"

namespace {

using firmware::Ramps;
using firmware::controller::EmergencyReturn;
using firmware::controller::RememberedCommand;

constexpr double h = 1e-3;

class Valves final : public hal::ValveBank {
 public:
  Valves() : ValveBank(6, hal::Openings::first(2)) {}
  hal::Openings stand = hal::Openings::first(6);

 private:
  hal::Result<void> do_write(hal::Openings openings) override {
    stand = openings;
    return {};
  }
};

class Drive final : public hal::CommandOutput {
 public:
  Drive() { commands.reserve(10'000); }
  std::vector<double> commands;
  std::vector<hal::Fault> faults;  ///< of the next writes, last first

 private:
  hal::Result<void> do_write(const hal::Command& command) override {
    if (!faults.empty()) {
      const hal::Fault fault = faults.back();
      faults.pop_back();
      return fault;
    }
    commands.push_back(command.position);
    return {};
  }
};

class Sleeper final : public hal::Clock {
 public:
  hal::Time time{};

 private:
  hal::Time do_now() override { return time; }
  void do_sleep_until(hal::Time deadline) override { time = deadline; }
};

class Button final : public hal::StopButton {
 public:
  explicit Button(hal::Clock& clock) : clock_(clock) {}
  hal::Time pressed_from{std::numeric_limits<std::int64_t>::max()};

 private:
  hal::Result<Level> do_read() override { return Level{clock_.now() >= pressed_from, clock_.now()}; }
  hal::Clock& clock_;
};

class Enable final : public hal::DriveEnable {
 public:
  bool on = true;

 private:
  hal::Result<void> do_write(bool wanted) override {
    on = wanted;
    return {};
  }
};

class Door final : public hal::Interlocks {
 public:
  explicit Door(hal::Clock& clock) : Interlocks(1), clock_(clock) {}
  hal::Time open_from{std::numeric_limits<std::int64_t>::max()};

 private:
  hal::Result<std::uint32_t> do_read() override { return clock_.now() >= open_from ? 1U : 0U; }
  hal::Clock& clock_;
};

class Beats final : public hal::Heartbeat {
  hal::Result<void> do_beat() override { return {}; }
};

class Sensors final : public hal::SensorSource {
 public:
  Sensors() : SensorSource({}) {}

 private:
  hal::Result<hal::Frame> do_read() override { return hal::Frame{}; }
};

struct Scene {
  Valves valves;
  Drive drive;
  RememberedCommand command{drive};
  Sleeper clock;
  Button button{clock};
  Enable enable;
  Door door{clock};
  Beats beats;
  Sensors sensors;
  Ramps ramps{};
  EmergencyReturn emergency_return{
      {clock, sensors, valves, command, button, beats, enable, door}, command, clock, ramps, 0.125, h};
};

// Braked at no more than the deceleration that the stroke asks for, back at no more than the given rate, at rest at the
// end; one write a period, no heap: a signal handler has none.
TEST(EmergencyReturn, MovesTheCommandToRestAtTheGivenRate) {
  Scene scene;
  ASSERT_TRUE(scene.command.write({0.04, 0.3, 0.0}));
  EXPECT_EQ(support::without_heap([&] { return scene.emergency_return.go(); }), EmergencyReturn::End::at_rest);
  EXPECT_EQ(scene.valves.stand, hal::Openings::first(2));
  EXPECT_FALSE(scene.enable.on);
  const auto& commands = scene.drive.commands;
  ASSERT_GT(commands.size(), 2U);
  EXPECT_EQ(commands.back(), scene.ramps.rest);
  EXPECT_EQ(scene.clock.time, hal::milliseconds(static_cast<std::int64_t>(commands.size()) - 1)) << "one a period";
  // 0.3 m/s at 20 m/s² stop within 15 ms; the first step is at most 0.3 mm.
  const std::size_t braked = 16;
  for (std::size_t k = 1; k < commands.size(); ++k) {
    const double speed = std::abs(commands[k] - commands[k - 1]) / h;
    EXPECT_LE(speed, (k < braked ? 0.3 : scene.ramps.rate) * (1.0 + 1e-9)) << k;
  }
}

// A drive that was never told anything keeps its place.
TEST(EmergencyReturn, CommandsNothingWhereNothingWasCommanded) {
  Scene scene;
  EXPECT_EQ(scene.emergency_return.go(), EmergencyReturn::End::at_rest);
  EXPECT_TRUE(scene.drive.commands.empty());
  EXPECT_EQ(scene.valves.stand, hal::Openings::first(2));
}

// What did not reach the drive is not where it stands.
TEST(RememberedCommand, RemembersWhatWentOut) {
  Scene scene;
  ASSERT_TRUE(scene.command.write({0.01, 0.2, 0.0}));
  scene.drive.faults = {hal::Fault::timeout};
  EXPECT_FALSE(scene.command.write({0.02, 0.4, 0.0}));
  EXPECT_EQ(scene.command.position(), 0.01);
  EXPECT_EQ(scene.command.velocity(), 0.2);
}

// A time-out or two are bridged; a converter that is gone, or never answers, ends the emergency return and not the
// program's patience.
TEST(EmergencyReturn, GivesUpWhereTheDriveIsLost) {
  using hal::Fault;
  const std::vector<std::pair<std::vector<Fault>, EmergencyReturn::End>> cases{
      {{Fault::timeout, Fault::timeout}, EmergencyReturn::End::at_rest},
      {{Fault::timeout, Fault::timeout, Fault::timeout}, EmergencyReturn::End::command_lost},
      {{Fault::disconnected}, EmergencyReturn::End::command_lost},
      {{Fault::refused}, EmergencyReturn::End::command_lost}};
  for (const auto& [faults, end] : cases) {
    Scene scene;
    ASSERT_TRUE(scene.command.write({0.04, 0.0, 0.0}));
    scene.drive.faults = faults;
    EXPECT_EQ(scene.emergency_return.go(), end) << faults.size();
    EXPECT_EQ(scene.valves.stand, hal::Openings::first(2)) << "whatever becomes of the command";
  }
}

// From the end of the stroke the slowest way back takes 1.5 · 0.125 m / 0.05 m/s = 3.75 s: 8.5 s bound it.
TEST(EmergencyReturn, IsBoundedInTime) {
  Scene scene;
  EXPECT_EQ(scene.emergency_return.periods_at_most(), 8500);
  ASSERT_TRUE(scene.command.write({-0.125, 0.0, 0.0}));
  EXPECT_EQ(scene.emergency_return.go(), EmergencyReturn::End::at_rest);
  EXPECT_LT(scene.drive.commands.size(), 4000U);
}

// Fault. A press on the way back, a door that opens: braked within the braking distance, held there, without power at
// once.
TEST(EmergencyReturn, HoldsWhereSomebodyStopsIt) {
  for (const bool by_button : {true, false}) {
    Scene scene;
    ASSERT_TRUE(scene.command.write({0.04, 0.0, 0.0}));
    (by_button ? scene.button.pressed_from : scene.door.open_from) = hal::milliseconds(500);
    EXPECT_EQ(scene.emergency_return.go(), EmergencyReturn::End::held);
    EXPECT_FALSE(scene.enable.on);
    const auto& commands = scene.drive.commands;
    const double there = commands[499];  // 500 writes before the press, the first of them by the test
    EXPECT_NEAR(commands.back(), there, 0.05 * h + 0.05 * 0.05 / (2.0 * scene.ramps.braking));
    EXPECT_LT(commands.size(), 510U);
  }
}

// Somebody who holds the button while the program traps sees no way back at all.
TEST(EmergencyReturn, DoesNotBeginUnderAPress) {
  Scene scene;
  ASSERT_TRUE(scene.command.write({0.04, 0.0, 0.0}));
  scene.button.pressed_from = {};
  EXPECT_EQ(scene.emergency_return.go(), EmergencyReturn::End::held);
  EXPECT_EQ(scene.drive.commands.back(), 0.04);
  EXPECT_FALSE(scene.enable.on);
}

}  // namespace
