// What every back-end has in common because the roles themselves see to it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "hal/rig.hpp"

namespace {

using namespace hal;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// A million periods must add up without drift, and a period must be the double that everybody means by 0.001.
TEST(Time, IsExactInNanoseconds) {
  EXPECT_EQ(seconds(0.001), milliseconds(1));
  EXPECT_EQ(seconds(-0.001), milliseconds(-1));
  EXPECT_EQ(microseconds(1500).seconds(), 0.0015);
  EXPECT_EQ((milliseconds(1) * 1'000'000).seconds(), 1000.0);
  EXPECT_EQ(seconds(1.0 / 3.0), nanoseconds(333'333'333));
  EXPECT_EQ(seconds(2.0 / 3.0), nanoseconds(666'666'667));
  EXPECT_LT(never, nanoseconds(0));
  Time t = milliseconds(5);
  t += milliseconds(2);
  EXPECT_EQ(t - milliseconds(1), milliseconds(6));
}

class FakeSensors final : public SensorSource {
 public:
  explicit FakeSensors(const SensorSetup& setup) : SensorSource(setup) {}
  Result<Frame> next = Fault::timeout;

 private:
  Result<Frame> do_read() override { return next; }
};

SensorSetup three_channels() {
  SensorSetup setup;
  setup[0] = {true, -1.0, 2.0};
  setup[1] = {true};
  setup[3] = {true, 0.0, 10.0};
  return setup;
}

// A clipped sample looks like a good one; only the stated range gives it away. At the very end of the range it is
// clipped already, because a converter at its stop shows just that.
TEST(SensorSource, FlagsWhatCannotBeTrusted) {
  struct Case {
    double value;
    Quality expected;
  };
  FakeSensors sensors(three_channels());
  for (const Case& c :
       {Case{0.0, Quality::good}, Case{-0.999, Quality::good}, Case{1.999, Quality::good}, Case{2.0, Quality::clipped},
        Case{2.1, Quality::clipped}, Case{-1.0, Quality::clipped}, Case{-7.0, Quality::clipped},
        Case{nan, Quality::not_finite}, Case{infinity, Quality::not_finite}, Case{-infinity, Quality::not_finite}}) {
    Frame frame;
    frame.channels[0] = {c.value, milliseconds(3), Quality::good};
    sensors.next = frame;
    const Result<Frame> read = sensors.read();
    ASSERT_TRUE(read);
    EXPECT_EQ(read->channels[0].quality, c.expected) << c.value;
    EXPECT_EQ(read->channels[0].taken, milliseconds(3));
  }
}

// The verdict is the role's, not the back-end's: whatever it says beside `missing`, the value is looked at. A back-end
// that saw an end of its converter knows more: that stays.
TEST(SensorSource, JudgesForItself) {
  FakeSensors sensors(three_channels());
  Frame frame;
  frame.channels[0] = {0.5, milliseconds(3), Quality::clipped};
  frame.channels[1] = {0.5, milliseconds(3), Quality::not_finite};
  sensors.next = frame;
  const Result<Frame> read = sensors.read();
  EXPECT_EQ(read->channels[0].quality, Quality::clipped);
  EXPECT_EQ(read->channels[1].quality, Quality::good);
}

// A channel without stated range has every finite value; one that is not fitted has none, whatever a back-end delivers.
TEST(SensorSource, KnowsMissingFromUnlimited) {
  FakeSensors sensors(three_channels());
  Frame frame;
  frame.channels[1] = {1e200, milliseconds(3), Quality::good};
  frame.channels[2] = {1.0, milliseconds(3), Quality::good};
  frame.channels[3] = {1.0, milliseconds(3), Quality::missing};
  sensors.next = frame;
  const Result<Frame> read = sensors.read();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->channels[1].quality, Quality::good);
  EXPECT_EQ(read->channels[2].quality, Quality::missing) << "not fitted";
  EXPECT_EQ(read->channels[2].taken, never);
  EXPECT_EQ(read->channels[3].quality, Quality::missing) << "fitted, no sample";
  EXPECT_EQ(read->channels[3].taken, never);
}

TEST(SensorSource, HandsFaultsThrough) {
  FakeSensors sensors(three_channels());
  sensors.next = Fault::disconnected;
  const Result<Frame> read = sensors.read();
  ASSERT_FALSE(read);
  EXPECT_EQ(read.fault(), Fault::disconnected);
}

// A range that contains nothing would make every sample bad: a mistake of ours.
TEST(SensorSourceDeathTest, RefusesAnEmptyRange) {
  SensorSetup setup;
  setup[0] = {true, 1.0, 1.0};
  EXPECT_DEATH(FakeSensors{setup}, "range");
}

TEST(Openings, AreASetOfUpToSixDucts) {
  EXPECT_EQ(Openings{}.bits(), 0U);
  EXPECT_EQ(Openings::first(2).bits(), 0b11U);
  EXPECT_EQ(Openings::first(6).bits(), 0b111111U);
  EXPECT_EQ(Openings::first(2).with(4, true).with(0, false), Openings::from_bits(0b10010));
  EXPECT_TRUE(Openings::from_bits(0b10000).is_open(4));
  EXPECT_FALSE(Openings::from_bits(0b10000).is_open(3));
  EXPECT_FALSE(Openings::from_bits(0b10000).is_open(6));
  EXPECT_TRUE(Openings::first(3).within(3));
  EXPECT_FALSE(Openings::first(3).within(2));
}

TEST(OpeningsDeathTest, HaveNoSeventhDuct) {
  EXPECT_DEATH((void)Openings::first(7), "six ducts");
  EXPECT_DEATH((void)Openings::from_bits(64), "six ducts");
  EXPECT_DEATH((void)Openings{}.with(6, true), "six ducts");
}

class FakeValves final : public ValveBank {
 public:
  FakeValves(std::size_t installed, Openings safe) : ValveBank(installed, safe) {}
  int writes = 0;
  Openings last{};

 private:
  Result<void> do_write(Openings openings) override {
    ++writes;
    last = openings;
    return {};
  }
};

// Half of a wrong write would leave valves in a mixture that nobody chose.
TEST(ValveBank, RefusesADuctThatIsNotInstalledAndTouchesNone) {
  FakeValves valves(2, Openings::first(2));
  EXPECT_TRUE(valves.write(Openings::first(1)));
  const Result<void> refused = valves.write(Openings::from_bits(0b101));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.fault(), Fault::refused);
  EXPECT_EQ(valves.writes, 1);
  EXPECT_EQ(valves.last, Openings::first(1));
  EXPECT_EQ(valves.safe_position(), Openings::first(2));
}

TEST(ValveBankDeathTest, HasASafePositionThatItCanTake) {
  EXPECT_DEATH(FakeValves(2, Openings::first(3)), "safe position");
  EXPECT_DEATH(FakeValves(7, Openings{}), "six ducts");
}

class FakeDrive final : public CommandOutput {
 public:
  int writes = 0;

 private:
  Result<void> do_write(const Command&) override {
    ++writes;
    return {};
  }
};

// What a drive does with NaN is up to its maker: it must never get one, in any member.
TEST(CommandOutput, NeverSendsWhatIsNoNumber) {
  FakeDrive drive;
  EXPECT_TRUE(drive.write({0.1, 0.2, 0.3}));
  for (const Command& bad : {Command{nan, 0.0, 0.0}, Command{0.0, infinity, 0.0}, Command{0.0, 0.0, -infinity}}) {
    const Result<void> refused = drive.write(bad);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.fault(), Fault::refused);
  }
  EXPECT_EQ(drive.writes, 1);
}

class FakeButton final : public StopButton {
 public:
  void set(bool pressed, Time since) {
    level_.pressed = pressed;
    level_.since = since;
  }
  bool cut = false;

 private:
  Result<Level> do_read() override {
    if (cut) return Fault::disconnected;
    return level_;
  }
  Level level_{};
};

// A finger is quicker than an engineer who reads the log: the press stays until somebody has seen it.
TEST(StopButton, LatchesAPressUntilReleased) {
  FakeButton button;
  EXPECT_FALSE(*button.pressed());
  EXPECT_EQ(button.pressed_at(), never);
  button.set(true, milliseconds(7));
  EXPECT_TRUE(*button.pressed());
  button.set(false, never);
  EXPECT_TRUE(*button.pressed());
  button.set(true, milliseconds(9));
  EXPECT_TRUE(*button.pressed());
  EXPECT_EQ(button.pressed_at(), milliseconds(7)) << "of the first press";
  button.release();
  EXPECT_TRUE(*button.pressed()) << "still held";
  EXPECT_EQ(button.pressed_at(), milliseconds(9));
  button.set(false, never);
  button.release();
  EXPECT_FALSE(*button.pressed());
}

TEST(StopButton, SaysWhenItCannotBeRead) {
  FakeButton button;
  button.cut = true;
  const Result<bool> read = button.pressed();
  ASSERT_FALSE(read);
  EXPECT_EQ(read.fault(), Fault::disconnected);
}

// Taking the value of a fault would feed the loop with a number that nobody measured.
TEST(ResultDeathTest, HasEitherValueOrFault) {
  const Result<double> fault = Fault::timeout;
  const Result<double> value = 1.5;
  EXPECT_EQ(*value, 1.5);
  EXPECT_EQ(fault.fault(), Fault::timeout);
  EXPECT_DEATH((void)*fault, "no value");
  EXPECT_DEATH((void)value.fault(), "no fault");
  EXPECT_DEATH((void)Result<void>{}.fault(), "no fault");
}

}  // namespace
