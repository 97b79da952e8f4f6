// A laser at the other end of a pseudo-terminal, which is a serial port to the program that opens it.
#include "hal/linux/rf60x_laser.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/without_heap.hpp"

namespace {

using hal::Quality;
using hal::Time;
using hal::linux::Opened;
using hal::linux::Rf60xLaser;

/// The sensor: sends what the test says, when it says.
class SimulatedSensor {
 public:
  SimulatedSensor() : terminal_(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK)) {
    if (terminal_ < 0 || ::grantpt(terminal_) != 0 || ::unlockpt(terminal_) != 0) return;
    port_ = ::ptsname(terminal_);
    line_ = ::open(port_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  }
  ~SimulatedSensor() {
    unplug();
    if (line_ >= 0) ::close(line_);
  }
  SimulatedSensor(const SimulatedSensor&) = delete;
  SimulatedSensor& operator=(const SimulatedSensor&) = delete;

  [[nodiscard]] const std::string& port() const { return port_; }
  void unplug() {
    if (terminal_ >= 0) ::close(terminal_);
    terminal_ = -1;
  }
  /// Returns when the bytes are there for whoever reads the port: the kernel hands them over when it has time.
  void send(const std::vector<std::uint8_t>& bytes) {
    const int wanted = waiting() + static_cast<int>(bytes.size());
    EXPECT_EQ(::write(terminal_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
    for (int i = 0; i < 5000 && waiting() < wanted; ++i) ::usleep(1000);
  }
  void send_result(unsigned d, bool renewed = true) {
    std::vector<std::uint8_t> bytes;
    for (unsigned i = 0; i < 4; ++i) {
      bytes.push_back(
          static_cast<std::uint8_t>(0x80U | (renewed ? 0x40U : 0U) | (count_ & 3U) << 4U | (d >> (4U * i) & 0xfU)));
    }
    ++count_;
    send(bytes);
  }
  /// What the program has asked for.
  [[nodiscard]] std::vector<std::uint8_t> requests() const {
    std::vector<std::uint8_t> bytes(64);
    pollfd ready{terminal_, POLLIN, 0};
    ::poll(&ready, 1, 5000);
    const ssize_t got = ::read(terminal_, bytes.data(), bytes.size());
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

 private:
  [[nodiscard]] int waiting() const {
    int bytes = 0;
    return ::ioctl(line_, FIONREAD, &bytes) == 0 ? bytes : 0;
  }

  int terminal_;
  int line_ = -1;  ///< the port itself, to see what waits there
  std::string port_;
  unsigned count_ = 0;
};

struct Bench {
  SimulatedSensor sensor;
  Opened<Rf60xLaser> laser;
  hal::Frame frame{};
  Time now = hal::milliseconds(1000);

  Bench() {
    Rf60xLaser::Wanted wanted;
    wanted.port = sensor.port();
    wanted.address = 3;
    wanted.channel = 7;
    wanted.range = 0.25;
    wanted.scale = -1.0;
    wanted.offset = 0.1;
    laser = Rf60xLaser::open(wanted);
    if (laser) {
      EXPECT_FALSE(laser.device->low_latency()) << "a pseudo-terminal cannot grant it, and opens all the same";
    }
  }
  /// One period on; the reading of the laser's channel.
  hal::Reading read() {
    now += hal::milliseconds(1);
    const auto result = laser.device->read(frame, now);
    EXPECT_TRUE(result);
    return frame.channels[7];
  }
};

TEST(Rf60xLaser, AsksForTheStreamAndEndsIt) {
  Bench bench;
  ASSERT_TRUE(bench.laser) << bench.laser.trouble;
  EXPECT_EQ(bench.sensor.requests(), (std::vector<std::uint8_t>{0x03, 0x87}));
  bench.laser.device.reset();
  EXPECT_EQ(bench.sensor.requests(), (std::vector<std::uint8_t>{0x03, 0x88}));
}

// (1) by hand: D = 1000h of a range of 250 mm is 62.5 mm; the quantity falls as the distance grows.
TEST(Rf60xLaser, GivesTheChannelInItsUnit) {
  Bench bench;
  ASSERT_TRUE(bench.laser) << bench.laser.trouble;
  EXPECT_EQ(bench.read().quality, Quality::missing) << "nothing has come yet";
  bench.sensor.send_result(0);
  bench.sensor.send_result(0x1000);
  const auto reading = bench.read();
  EXPECT_EQ(reading.quality, Quality::good);
  EXPECT_DOUBLE_EQ(reading.value, 0.1 - 0.0625);
  EXPECT_EQ(reading.taken, bench.now - hal::nanoseconds(11'000'000'000 / 921'600) * 4)
      << "four bytes of eleven bits ago: when its first byte came, at the latest";
}

// Nothing new is the old value with its old stamp: the firmware sees its age. So is a result that is not renewed.
TEST(Rf60xLaser, GrowsOldWhenTheSensorStops) {
  Bench bench;
  ASSERT_TRUE(bench.laser) << bench.laser.trouble;
  bench.sensor.send_result(0);
  bench.sensor.send_result(0x2000);
  const auto last = bench.read();
  for (int k = 0; k < 10; ++k) {
    if (k == 5) bench.sensor.send_result(0x2000, false);
    const auto reading = bench.read();
    EXPECT_EQ(reading.value, last.value);
    EXPECT_EQ(reading.taken, last.taken);
  }
  bench.sensor.unplug();
  EXPECT_EQ(bench.laser.device->read(bench.frame, bench.now).fault(), hal::Fault::disconnected);
}

// Fault. Garbage and half frames are counted, the good ones between them arrive, the loop is never held up.
TEST(Rf60xLaser, ReadsThroughGarbageAndHalfFrames) {
  Bench bench;
  ASSERT_TRUE(bench.laser) << bench.laser.trouble;
  bench.sensor.send_result(0x0111);
  bench.sensor.send({0x00, 0x13, 0x7f});
  bench.sensor.send_result(0x0222);
  bench.sensor.send({0xA1});  // half of what should come next
  EXPECT_DOUBLE_EQ(bench.read().value, 0.1 - 0x0222 * 0.25 / 0x4000) << "a new count is a beginning";
  bench.sensor.send_result(0x0333);
  bench.sensor.send_result(0x0444);
  EXPECT_DOUBLE_EQ(bench.read().value, 0.1 - 0x0444 * 0.25 / 0x4000);
  EXPECT_EQ(bench.laser.device->counts().garbage, 3U);
  EXPECT_GE(bench.laser.device->counts().torn, 1U);
}

// The factory sends a result each 5 ms: for a loop of 1 kHz a channel five periods old, and nothing else would say so.
TEST(Rf60xLaser, WarnsOfTheFactorySamplingPeriod) {
  Bench bench;
  ASSERT_TRUE(bench.laser) << bench.laser.trouble;
  EXPECT_NE(bench.laser.device->warning(hal::milliseconds(1)).find("0 results"), std::string::npos);
  for (unsigned k = 0; k < 200; ++k) {
    if (k % 5 == 0) bench.sensor.send_result(0x1000 + k);
    bench.read();
  }
  EXPECT_EQ(bench.laser.device->interval(), hal::milliseconds(5));
  const std::string warning = bench.laser.device->warning(hal::milliseconds(1));
  EXPECT_NE(warning.find("each 5.00 ms (the factory setting)"), std::string::npos) << warning;
  EXPECT_EQ(bench.laser.device->warning(hal::milliseconds(5)), "");
}

TEST(Rf60xLaser, ReadsWithoutHeap) {
  Bench bench;
  ASSERT_TRUE(bench.laser) << bench.laser.trouble;
  for (unsigned k = 0; k < 20; ++k) bench.sensor.send_result(k);
  support::without_heap([&] { static_cast<void>(bench.laser.device->read(bench.frame, bench.now)); });
  EXPECT_EQ(bench.laser.device->counts().frames, 19U);
}

TEST(Rf60xLaser, SaysWhyAPortCannotBeOpened) {
  Rf60xLaser::Wanted wanted;
  wanted.port = "/dev/no-such-port";
  EXPECT_EQ(Rf60xLaser::open(wanted).trouble, "laser at /dev/no-such-port: No such file or directory");
  wanted.port = "/dev/null";
  EXPECT_NE(Rf60xLaser::open(wanted).trouble.find("expected a serial port"), std::string::npos);
  wanted.baud = 1234;
  EXPECT_NE(Rf60xLaser::open(wanted).trouble.find("no rate of 1234 baud"), std::string::npos);
}

}  // namespace
