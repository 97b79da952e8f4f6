#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hal/simulated/rig.hpp"

namespace {

using namespace hal;
using simulated::ChannelFault;
using simulated::DeviceFault;
using simulated::FaultPlan;
using simulated::LateWake;
using simulated::Press;

constexpr Time ms = milliseconds(1);

/// Shows the number of its instant on channel 0 and its tenfold on channel 1, and writes down what is done to it.
class CountingPlant final : public simulated::Plant {
 public:
  int instant = 0;
  int measurements = 0;
  std::vector<Command> commands;
  std::vector<Openings> openings;

 private:
  void do_measure(std::span<double, channel_capacity> values) override {
    ++measurements;
    values[0] = instant;
    values[1] = 10.0 * instant;
  }
  void do_advance(const Command& command, Openings open) override {
    ++instant;
    commands.push_back(command);
    openings.push_back(open);
  }
};

simulated::Construction two_channels() {
  simulated::Construction c;
  c.period = ms;
  c.sensors[0] = {true, -1.0, 100.0};
  c.sensors[1] = {true};
  c.ducts = 2;
  c.safe_position = Openings::first(2);
  c.rest = {0.01, 0.0, 0.0};
  return c;
}

/// Readings of channel 0 at the instants 0 … count − 1.
std::vector<Reading> readings(const FaultPlan& plan, int count, std::size_t channel = 0) {
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), plan);
  const hal::Rig roles = rig.roles();
  std::vector<Reading> all;
  for (int k = 0; k < count; ++k) {
    roles.clock.sleep_until(ms * k);
    all.push_back((*roles.sensors.read()).channels[channel]);
  }
  return all;
}

// Virtual time: nothing moves but by sleeping, and a sleep moves the plant by whole periods of its grid.
TEST(SimulatedRig, MovesThePlantOnlyByTheTimeSleptThrough) {
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels());
  const hal::Rig roles = rig.roles();
  EXPECT_EQ(roles.clock.now(), Time{});
  roles.clock.sleep_until(microseconds(999));
  EXPECT_EQ(plant.instant, 0);
  roles.clock.sleep_until(ms);
  EXPECT_EQ(plant.instant, 1);
  roles.clock.sleep_until(microseconds(3500));
  EXPECT_EQ(plant.instant, 3);
  EXPECT_EQ(roles.clock.now(), microseconds(3500));
  roles.clock.sleep_until(ms);  // passed long ago
  EXPECT_EQ(roles.clock.now(), microseconds(3500));
}

// Sensor noise is drawn when the plant is measured: once an instant, whether nobody reads or everybody does.
TEST(SimulatedRig, MeasuresEveryInstantExactlyOnce) {
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels());
  const hal::Rig roles = rig.roles();
  (void)roles.sensors.read();
  (void)roles.sensors.read();
  EXPECT_EQ(plant.measurements, 1);
  roles.clock.sleep_until(ms * 5);
  EXPECT_EQ(plant.measurements, 5);
  const Result<Frame> frame = roles.sensors.read();
  EXPECT_EQ(plant.measurements, 6);
  EXPECT_EQ(frame->channels[0].value, 5.0);
  EXPECT_EQ(frame->channels[0].taken, ms * 5);
  EXPECT_EQ(frame->channels[2].quality, Quality::missing);
}

TEST(SimulatedRig, HoldsOutputsUntilWrittenAnew) {
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels());
  const hal::Rig roles = rig.roles();
  roles.clock.sleep_until(ms);
  ASSERT_TRUE(roles.command.write({0.02, 0.3, 4.0}));
  ASSERT_TRUE(roles.valves.write(Openings::first(1)));
  roles.clock.sleep_until(ms * 3);
  ASSERT_EQ(plant.commands.size(), 3U);
  EXPECT_EQ(plant.commands[0], (Command{0.01, 0.0, 0.0})) << "at rest before the first command";
  EXPECT_EQ(plant.commands[1], (Command{0.02, 0.3, 4.0}));
  EXPECT_EQ(plant.commands[2], plant.commands[1]);
  EXPECT_EQ(plant.openings[0], Openings::first(2)) << "safe position before the first write";
  EXPECT_EQ(plant.openings[1], Openings::first(1));
}

TEST(ChannelFaults, DropLeavesNoSample) {
  const ChannelFault drop{ChannelFault::Kind::drop, 0, {ms * 2, ms * 4}};
  const auto all = readings({.channels = {&drop, 1}}, 6);
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(all[static_cast<std::size_t>(k)].quality, k == 2 || k == 3 ? Quality::missing : Quality::good) << k;
  }
}

// A sensor that has stopped renewing shows an old value with its old stamp: age is what gives it away.
TEST(ChannelFaults, FreezeRepeatsTheFirstSampleWithItsStamp) {
  const ChannelFault freeze{ChannelFault::Kind::freeze, 0, {ms * 2, ms * 5}};
  const auto all = readings({.channels = {&freeze, 1}}, 7);
  for (const std::size_t k : {2U, 3U, 4U}) {
    EXPECT_EQ(all[k].value, 2.0);
    EXPECT_EQ(all[k].taken, ms * 2);
  }
  EXPECT_EQ(all[5].value, 5.0);
}

TEST(ChannelFaults, FreezesAnewInEveryWindow) {
  const std::array<ChannelFault, 2> freezes{
      {{ChannelFault::Kind::freeze, 0, {ms * 1, ms * 3}}, {ChannelFault::Kind::freeze, 0, {ms * 4, ms * 6}}}};
  const auto all = readings({.channels = freezes}, 7);
  EXPECT_EQ(all[2].value, 1.0);
  EXPECT_EQ(all[3].value, 3.0);
  EXPECT_EQ(all[5].value, 4.0);
}

TEST(ChannelFaults, DelayShowsAnEarlierSampleWithItsStamp) {
  const ChannelFault delay{
      .kind = ChannelFault::Kind::delay, .channel = 0, .window = {ms * 4, ms * 6}, .delay_samples = 3};
  const auto all = readings({.channels = {&delay, 1}}, 7);
  EXPECT_EQ(all[3].value, 3.0);
  EXPECT_EQ(all[4].value, 1.0);
  EXPECT_EQ(all[4].taken, ms * 1);
  EXPECT_EQ(all[5].value, 2.0);
  EXPECT_EQ(all[6].value, 6.0);
}

// Before the first sample there is nothing to be late with.
TEST(ChannelFaults, DelayBeyondTheBeginningIsMissing) {
  const ChannelFault delay{.kind = ChannelFault::Kind::delay, .channel = 0, .delay_samples = 3};
  const auto all = readings({.channels = {&delay, 1}}, 5);
  EXPECT_EQ(all[2].quality, Quality::missing);
  EXPECT_EQ(all[3].value, 0.0);
  EXPECT_EQ(all[4].value, 1.0);
}

TEST(ChannelFaults, CorruptValues) {
  const std::array<ChannelFault, 4> faults{
      {{.kind = ChannelFault::Kind::not_a_number, .channel = 0, .window = {ms * 1, ms * 2}},
       {.kind = ChannelFault::Kind::spike, .channel = 0, .window = {ms * 2, ms * 3}, .spike = 0.5},
       {.kind = ChannelFault::Kind::bit_flip, .channel = 0, .window = {ms * 3, ms * 4}, .bit = 63},
       {.kind = ChannelFault::Kind::spike, .channel = 0, .window = {ms * 4, ms * 5}, .spike = 1e3}}};
  const auto all = readings({.channels = faults}, 6);
  EXPECT_EQ(all[1].quality, Quality::not_finite);
  EXPECT_EQ(all[2].value, 2.5);
  EXPECT_EQ(all[3].value, -3.0) << "bit 63 is the sign";
  EXPECT_EQ(all[3].quality, Quality::clipped) << "below −1, the end of the range";
  EXPECT_EQ(all[4].quality, Quality::clipped) << "the range is checked after the fault";
  EXPECT_EQ(all[5].value, 5.0);
}

// Bit 0 is a bit like any other, the last of the mantissa.
TEST(ChannelFaults, TurnOverTheBitThatIsNamed) {
  const ChannelFault flip{.kind = ChannelFault::Kind::bit_flip, .channel = 0, .bit = 0};
  EXPECT_EQ(readings({.channels = {&flip, 1}}, 2)[1].value, std::nextafter(1.0, 2.0));
}

TEST(ChannelFaults, LeaveOtherChannelsAlone) {
  const ChannelFault drop{ChannelFault::Kind::drop, 0, {}};
  for (const Reading& reading : readings({.channels = {&drop, 1}}, 5, 1)) EXPECT_EQ(reading.quality, Quality::good);
}

TEST(ChannelFaults, ActInTheOrderOfTheList) {
  const std::array<ChannelFault, 2> faults{{{.kind = ChannelFault::Kind::drop, .channel = 0},
                                            {.kind = ChannelFault::Kind::delay, .channel = 0, .delay_samples = 1}}};
  EXPECT_EQ(readings({.channels = faults}, 3)[2].value, 1.0) << "the delay has the last word";
}

// A bit that is drawn must turn over exactly one bit, the same one for the same seed and different ones over time.
TEST(ChannelFaults, AreDrawnFromTheSeedAlone) {
  const ChannelFault flip{.kind = ChannelFault::Kind::bit_flip, .channel = 1, .probability = 0.5};
  const auto bits = [&flip](std::uint64_t seed) {
    std::vector<std::uint64_t> flipped;
    const auto all = readings({.channels = {&flip, 1}, .seed = seed}, 400, 1);
    for (std::size_t k = 0; k < all.size(); ++k) {
      flipped.push_back(std::bit_cast<std::uint64_t>(all[k].value) ^
                        std::bit_cast<std::uint64_t>(10.0 * static_cast<double>(k)));
    }
    return flipped;
  };
  const auto first = bits(1);
  EXPECT_EQ(first, bits(1));
  EXPECT_NE(first, bits(2));
  int hit = 0;
  std::uint64_t seen = 0;
  for (const std::uint64_t mask : first) {
    EXPECT_LE(std::popcount(mask), 1);
    hit += std::popcount(mask);
    seen |= mask;
  }
  EXPECT_NEAR(hit, 200, 40) << "400 draws at one half: standard deviation 10, four of them, seed 1";
  EXPECT_GT(std::popcount(seen), 40) << "about 200 draws of 64 bits leave 3 unseen on average, seed 1";
}

TEST(DeviceFaults, AnswerForTheirDeviceOnlyAndKeepTheOldOutput) {
  using Device = DeviceFault::Device;
  for (const Device device : {Device::sensors, Device::valves, Device::command, Device::stop_button, Device::heartbeat,
                              Device::drive_enable, Device::interlocks}) {
    const DeviceFault fault{device, Fault::disconnected, {ms * 1, ms * 2}};
    CountingPlant plant;
    simulated::Rig rig(plant, two_channels(), {.devices = {&fault, 1}});
    const hal::Rig roles = rig.roles();
    for (int k = 0; k < 3; ++k) {
      roles.clock.sleep_until(ms * k);
      const auto fails = [&](Device asked) { return k == 1 && asked == device; };
      EXPECT_EQ(!roles.sensors.read(), fails(Device::sensors)) << k;
      EXPECT_EQ(!roles.valves.write(Openings::from_bits(static_cast<unsigned>(k))), fails(Device::valves)) << k;
      EXPECT_EQ(!roles.command.write({0.001 * k, 0.0, 0.0}), fails(Device::command)) << k;
      EXPECT_EQ(!roles.stop_button.pressed(), fails(Device::stop_button)) << k;
      EXPECT_EQ(!roles.heartbeat.beat(), fails(Device::heartbeat)) << k;
      EXPECT_EQ(!roles.drive_enable.write(true), fails(Device::drive_enable)) << k;
      EXPECT_EQ(!roles.interlocks.open(), fails(Device::interlocks)) << k;
      EXPECT_EQ(rig.openings().bits(), static_cast<unsigned>(fails(Device::valves) ? 0 : k));
      EXPECT_EQ(rig.command().position, fails(Device::command) ? 0.0 : 0.001 * k);
    }
    EXPECT_EQ(rig.beats(), device == Device::heartbeat ? 2U : 3U);
  }
}

TEST(SimulatedStopButton, IsHeldDuringThePressAndKeepsItsTime) {
  const Press press{{ms * 2, ms * 4}};
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), {.presses = {&press, 1}});
  const hal::Rig roles = rig.roles();
  EXPECT_FALSE(*roles.stop_button.pressed());
  roles.clock.sleep_until(ms * 3);
  EXPECT_TRUE(*roles.stop_button.pressed());
  EXPECT_EQ(roles.stop_button.pressed_at(), ms * 2);
  roles.stop_button.release();
  EXPECT_TRUE(*roles.stop_button.pressed()) << "still held";
  roles.clock.sleep_until(ms * 4);
  roles.stop_button.release();
  EXPECT_TRUE(*roles.stop_button.pressed()) << "was held since the last look";
  roles.clock.sleep_until(ms * 5);
  roles.stop_button.release();
  EXPECT_FALSE(*roles.stop_button.pressed());
}

// A press between two periods is an edge that a level read once a period would miss.
TEST(SimulatedStopButton, RemembersAPressShorterThanAPeriod) {
  const Press press{{microseconds(1200), microseconds(1300)}};
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), {.presses = {&press, 1}});
  const hal::Rig roles = rig.roles();
  roles.clock.sleep_until(ms);
  EXPECT_FALSE(*roles.stop_button.pressed());
  roles.clock.sleep_until(ms * 2);
  EXPECT_TRUE(*roles.stop_button.pressed());
  EXPECT_EQ(roles.stop_button.pressed_at(), microseconds(1200));
}

TEST(SimulatedStopButton, TellsTheEarliestOfSeveralPresses) {
  const std::array<Press, 2> presses{{{{ms * 3, ms * 6}}, {{ms * 2, ms * 6}}}};
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), {.presses = presses});
  const hal::Rig roles = rig.roles();
  roles.clock.sleep_until(ms * 4);
  EXPECT_TRUE(*roles.stop_button.pressed());
  EXPECT_EQ(roles.stop_button.pressed_at(), ms * 2);
}

// Two contacts of one button: either is a press at once, and half a second of difference is a broken contact.
TEST(SimulatedStopButton, ComparesItsContacts) {
  const Press press{{ms * 2, ms * 600}, Press::Contacts::second};
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), {.presses = {&press, 1}});
  const hal::Rig roles = rig.roles();
  roles.clock.sleep_until(ms * 3);
  EXPECT_TRUE(*roles.stop_button.pressed());
  roles.clock.sleep_until(ms * 503);
  EXPECT_TRUE(*roles.stop_button.pressed()) << "just the half second";
  roles.clock.sleep_until(ms * 504);
  ASSERT_FALSE(roles.stop_button.pressed());
  EXPECT_EQ(roles.stop_button.pressed().fault(), Fault::refused);
  roles.clock.sleep_until(ms * 600);
  EXPECT_TRUE(roles.stop_button.pressed()) << "they agree again";
}

// Fault. A press that one contact shows is a press and no test of the button: the other one may be welded. Nor do two
// of them make one test, a contact each, a second apart.
TEST(SimulatedStopButton, IsTestedByBothContacts) {
  const std::array presses{Press{{ms * 2, ms * 50}, Press::Contacts::first},
                           Press{{ms * 1002, ms * 1050}, Press::Contacts::second}, Press{{ms * 2002, ms * 2050}}};
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), {.presses = presses});
  const hal::Rig roles = rig.roles();
  for (const int at : {3, 500, 1003, 1500}) {  // in between the contacts agree again
    roles.clock.sleep_until(ms * at);
    EXPECT_TRUE(*roles.stop_button.pressed()) << at;
    EXPECT_EQ(roles.stop_button.tested_at(), never) << at;
  }
  roles.clock.sleep_until(ms * 2003);
  EXPECT_TRUE(*roles.stop_button.pressed());
  EXPECT_EQ(roles.stop_button.tested_at(), ms * 2002);
  EXPECT_EQ(roles.stop_button.pressed_at(), ms * 2) << "latched by the first";
}

// Without its enable a drive coasts to a stop, whatever it is told; with it, it is where it is told.
TEST(SimulatedDrive, MovesOnlyWithItsEnable) {
  CountingPlant plant;
  simulated::Construction c = two_channels();
  c.drive_enable = true;
  c.coasting = 10.0;
  simulated::Rig rig(plant, c);
  const hal::Rig roles = rig.roles();
  EXPECT_TRUE(roles.drive_enable.fitted());
  ASSERT_TRUE(roles.command.write({0.02, 0.0, 0.0}));
  roles.clock.sleep_until(ms);
  EXPECT_EQ(plant.commands.back().position, 0.01) << "off at first";
  ASSERT_TRUE(roles.drive_enable.write(true));
  ASSERT_TRUE(roles.command.write({0.02, 0.1, 0.0}));
  roles.clock.sleep_until(ms * 2);
  EXPECT_EQ(plant.commands.back().position, 0.02);
  ASSERT_TRUE(roles.drive_enable.write(false));
  ASSERT_TRUE(roles.command.write({0.03, 0.1, 0.0}));
  roles.clock.sleep_until(ms * 3);
  EXPECT_NEAR(plant.commands.back().velocity, 0.09, 1e-12);
  roles.clock.sleep_until(ms * 100);
  EXPECT_EQ(plant.commands.back().velocity, 0.0);
  EXPECT_NEAR(plant.commands.back().position, 0.02 + 0.1 * 0.1 / (2.0 * 10.0), 1e-4);
  EXPECT_FALSE(rig.enabled());
}

// Point. A seized spool leads a drive with power away from its command, by 0.1 m/s; without power it coasts: at
// 20 m/s² by 0.08 mm in the first period and 0.02 mm less in each other.
TEST(SimulatedDrive, RunsAwayOnlyWithItsPower) {
  CountingPlant plant;
  simulated::Construction c = two_channels();
  c.drive_enable = true;
  const simulated::StuckDrive away{{Time{}}, 0.1};
  FaultPlan plan;
  plan.stuck_drives = {&away, 1};
  simulated::Rig rig(plant, c, plan);
  const hal::Rig roles = rig.roles();
  ASSERT_TRUE(roles.drive_enable.write(true));
  roles.clock.sleep_until(ms * 10);
  EXPECT_NEAR(rig.drive().position, 0.01 + 10 * 0.1e-3, 1e-12);
  ASSERT_TRUE(roles.drive_enable.write(false));
  roles.clock.sleep_until(ms * 30);
  EXPECT_NEAR(rig.drive().position, 0.011 + 0.08e-3 + 0.06e-3 + 0.04e-3 + 0.02e-3, 1e-12);
}

TEST(SimulatedDrive, HasPowerAtAllTimesWithoutAnEnable) {
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels());
  EXPECT_FALSE(rig.roles().drive_enable.fitted());
  ASSERT_TRUE(rig.roles().drive_enable.write(false));
  EXPECT_TRUE(rig.enabled());
}

// The converter shows what it was told, or something else where the plan says so.
TEST(SimulatedDrive, ShowsItsCommand) {
  const simulated::ReadBackError error{0.003, {ms * 2, ms * 3}};
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), {.read_back_errors = {&error, 1}});
  const hal::Rig roles = rig.roles();
  EXPECT_EQ(*roles.command.read_back(), 0.01);
  ASSERT_TRUE(roles.command.write({0.02, 0.0, 0.0}));
  EXPECT_EQ(*roles.command.read_back(), 0.02);
  roles.clock.sleep_until(ms * 2);
  EXPECT_EQ(*roles.command.read_back(), 0.02 + 0.003);
}

// An interlock that opened between two reads was open once.
TEST(SimulatedInterlocks, ShowWhatOpenedSinceTheLastRead) {
  const std::array<simulated::OpenInterlock, 2> openings{
      {{0, {microseconds(1200), microseconds(1300)}}, {2, {ms * 3, ms * 5}}}};
  CountingPlant plant;
  simulated::Construction c = two_channels();
  c.interlocks = 3;
  simulated::Rig rig(plant, c, {.open_interlocks = openings});
  const hal::Rig roles = rig.roles();
  EXPECT_EQ(roles.interlocks.count(), 3U);
  EXPECT_EQ(*roles.interlocks.open(), 0U);
  roles.clock.sleep_until(ms * 2);
  EXPECT_EQ(*roles.interlocks.open(), 1U);
  roles.clock.sleep_until(ms * 4);
  EXPECT_EQ(*roles.interlocks.open(), 4U);
  roles.clock.sleep_until(ms * 6);
  EXPECT_EQ(*roles.interlocks.open(), 4U) << "open since the last read";
  EXPECT_EQ(*roles.interlocks.open(), 0U);
}

TEST(SimulatedClock, WakesLateWhereThePlanSaysSo) {
  const LateWake late{{ms * 2, ms * 3}, microseconds(400)};
  CountingPlant plant;
  simulated::Rig rig(plant, two_channels(), {.late_wakes = {&late, 1}});
  const hal::Rig roles = rig.roles();
  roles.clock.sleep_until(ms);
  EXPECT_EQ(roles.clock.now(), ms);
  roles.clock.sleep_until(ms * 2);
  EXPECT_EQ(roles.clock.now(), microseconds(2400));
  EXPECT_EQ(roles.sensors.read()->channels[0].taken, ms * 2) << "the converter kept its own pace";
  roles.clock.sleep_until(ms * 3);
  EXPECT_EQ(roles.clock.now(), ms * 3);
}

// The watchdog is what remains when the program hangs: the plant must feel it.
TEST(SimulatedWatchdog, MakesTheValvesSafeWhenBeatsCease) {
  simulated::Construction c = two_channels();
  c.watchdog = ms * 5;
  CountingPlant plant;
  simulated::Rig rig(plant, c);
  const hal::Rig roles = rig.roles();
  for (int k = 0; k < 4; ++k) {
    roles.clock.sleep_until(ms * k);
    ASSERT_TRUE(roles.valves.write(Openings::first(1)));
    ASSERT_TRUE(roles.heartbeat.beat());
  }
  roles.clock.sleep_until(ms * 12);  // one long sleep, last beat at 3 ms
  EXPECT_TRUE(rig.watchdog_has_acted());
  EXPECT_EQ(rig.openings(), Openings::first(2));
  for (std::size_t k = 0; k < plant.openings.size(); ++k) {
    EXPECT_EQ(plant.openings[k], Openings::first(k <= 8 ? 1 : 2)) << "step from " << k << " ms";
  }
}

TEST(FaultPlan, SaysWhatIsWrongWithIt) {
  const auto wrong = [](const ChannelFault& fault) { return !FaultPlan{.channels = {&fault, 1}}.check().empty(); };
  EXPECT_FALSE(wrong({}));
  EXPECT_FALSE(wrong({.probability = 0.0}));
  EXPECT_TRUE(wrong({.channel = channel_capacity}));
  EXPECT_TRUE(wrong({.delay_samples = simulated::delay_capacity}));
  EXPECT_TRUE(wrong({.bit = 64}));
  EXPECT_TRUE(wrong({.bit = -2}));
  EXPECT_TRUE(wrong({.probability = 1.5}));
  EXPECT_TRUE(wrong({.probability = std::nan("")}));
  const LateWake early{{}, milliseconds(-1)};
  const FaultPlan plan{.late_wakes = {&early, 1}};
  EXPECT_FALSE(plan.check().empty());
}

TEST(SimulatedRigDeathTest, NeedsAPeriodAndASoundPlan) {
  CountingPlant plant;
  EXPECT_DEATH(simulated::Rig(plant, simulated::Construction{}), "period");
  const ChannelFault nowhere{.channel = channel_capacity};
  EXPECT_DEATH(simulated::Rig(plant, two_channels(), {.channels = {&nowhere, 1}}), "plan");
}

}  // namespace
