// The small parts of the Linux back-end, and what it says where there is no hardware. With hardware, simulated by a
// kernel: tests/guest.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "hal/linux/clock.hpp"
#include "hal/linux/command_limit.hpp"
#include "hal/linux/gpio.hpp"
#include "hal/linux/iio.hpp"
#include "hal/linux/opened.hpp"
#include "hal/linux/sensors.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using hal::linux::CommandLimit;

// The clock of edges and samples; an absolute sleep ends at its time or later, one in the past at once.
TEST(MonotonicClock, SleepsUntilATime) {
  hal::linux::MonotonicClock clock;
  const hal::Time begin = clock.now();
  clock.sleep_until(begin + hal::milliseconds(3));
  EXPECT_GE(clock.now(), begin + hal::milliseconds(3));
  const hal::Time later = clock.now();
  clock.sleep_until(begin);
  clock.sleep_until(hal::never);
  EXPECT_LT(clock.now() - later, hal::milliseconds(60'000));  // a machine may be slow; `never` is centuries away
}

TEST(CommandLimit, HoldsTheRange) {
  CommandLimit limit({-0.1, 0.2, 1e6, 1.0}, 0.0);
  EXPECT_EQ(limit.limit(0.15, 1.0), 0.15);
  EXPECT_EQ(limit.limit(0.25, 1.0), 0.2);
  EXPECT_EQ(limit.limit(-0.25, 1.0), -0.1);
  EXPECT_EQ(limit.limit(std::numeric_limits<double>::quiet_NaN(), 1.0), -0.1);
  EXPECT_EQ(limit.limited(), 3U);
}

// 0.7 m/s are 0.7 mm in a period; after a second without commands too, because nobody watched the drive.
TEST(CommandLimit, HoldsTheRate) {
  CommandLimit limit({-0.125, 0.125, 0.7, 1e-3}, 0.01);
  EXPECT_NEAR(limit.limit(0.02, 1e-3), 0.0107, 1e-9);
  EXPECT_NEAR(limit.limit(0.02, 0.5e-3), 0.01105, 1e-9);
  EXPECT_NEAR(limit.limit(-0.02, 1.0), 0.01035, 1e-9);
  EXPECT_EQ(limit.limited(), 3U);
  EXPECT_EQ(limit.limit(0.0104, 1e-3), 0.0104);
  EXPECT_EQ(limit.limited(), 3U);
}

// Fault. Two programs must not drive one output: the second is told so, until the first has closed it.
TEST(OpenAlone, GivesAnOutputToOneProgram) {
  const support::TemporaryFolder folder;
  const std::string output = folder.write("out_voltage0_raw", "0\n");
  std::string trouble;
  const int first = hal::linux::open_alone(output, O_RDWR, trouble);
  ASSERT_GE(first, 0) << trouble;
  EXPECT_EQ(hal::linux::open_alone(output, O_RDWR, trouble), -1);
  EXPECT_EQ(trouble, output + ": another program drives it; end that program");
  ::close(first);
  const int again = hal::linux::open_alone(output, O_RDWR, trouble);
  EXPECT_GE(again, 0);
  ::close(again);
  EXPECT_EQ(hal::linux::open_alone(folder / "none", O_RDWR, trouble), -1);
  EXPECT_EQ(trouble, (folder / "none").string() + ": No such file or directory");
}

class OneChannel final : public hal::linux::SensorPart {
 public:
  OneChannel(std::size_t channel, double value, bool there) : channel_(channel), value_(value), there_(there) {}
  hal::Result<void> read(hal::Frame& frame, hal::Time now) override {
    if (!there_) return hal::Fault::disconnected;
    frame.channels[channel_] = {value_, now, hal::Quality::good};
    return {};
  }

 private:
  std::size_t channel_;
  double value_;
  bool there_;
};

TEST(Sensors, AreAllPartsTogether) {
  for (const bool there : {true, false}) {
    hal::linux::MonotonicClock clock;
    std::vector<std::unique_ptr<hal::linux::SensorPart>> parts;
    parts.push_back(std::make_unique<OneChannel>(1, 10.0, true));
    parts.push_back(std::make_unique<OneChannel>(4, 40.0, there));
    hal::SensorSetup setup{};
    setup[1].fitted = setup[4].fitted = true;
    hal::linux::Sensors sensors(setup, clock, std::move(parts));
    const auto frame = sensors.read();
    ASSERT_EQ(static_cast<bool>(frame), there);
    if (!there) continue;
    EXPECT_EQ(frame->channels[1].value, 10.0);
    EXPECT_EQ(frame->channels[4].value, 40.0);
    EXPECT_EQ(frame->channels[2].quality, hal::Quality::missing);
  }
}

// A user reads one line that names the thing and says what to do.
TEST(LinuxDevices, SayWhatIsNotThere) {
  const auto lines = hal::linux::OutputLines::open({"no-such-chip", {"duct_1"}, false, 0, "test"});
  EXPECT_FALSE(lines);
  EXPECT_EQ(lines.trouble.find("GPIO chip 'no-such-chip' is not there, found "), 0U) << lines.trouble;
  EXPECT_NE(lines.trouble.find("--list"), std::string::npos);
  const auto edge = hal::linux::EdgeLine::open({"no-such-chip", "stop", false, hal::linux::Bias::as_is, "test"});
  EXPECT_FALSE(edge);
  EXPECT_EQ(edge.trouble.find("GPIO chip 'no-such-chip' is not there"), 0U) << edge.trouble;

  const auto converters = hal::linux::IioConverters::open({"", 0.0, {{0, "no-such-adc", "voltage0", 1.0, 0.0}}});
  EXPECT_FALSE(converters);
  EXPECT_NE(converters.trouble.find("onverter"), std::string::npos) << converters.trouble;
  for (const std::string& text : {lines.trouble, edge.trouble, converters.trouble}) {
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
}

TEST(LinuxDevices, AreListedForPeople) {
  EXPECT_FALSE(hal::linux::list_gpio().empty());
  EXPECT_FALSE(hal::linux::list_iio().empty());
  EXPECT_EQ(hal::linux::gpio_library().find("libgpiod "), 0U);
  EXPECT_EQ(hal::linux::iio_library().find("libiio 0."), 0U);
}

}  // namespace
