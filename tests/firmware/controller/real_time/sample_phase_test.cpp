#include "firmware/controller/real_time/sample_phase.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace {

using firmware::controller::measured_phase;
using firmware::controller::SamplePhase;
using hal::Time;

constexpr Time period = hal::milliseconds(1);

struct VirtualClock final : hal::Clock {
  Time time = hal::milliseconds(5000);

 private:
  Time do_now() override { return time; }
  void do_sleep_until(Time deadline) override { time = std::max(time, deadline); }
};

hal::SensorSetup one_channel() {
  hal::SensorSetup setup;
  setup[3].fitted = true;
  return setup;
}

/// A converter whose trigger fires at `origin` + k · `step`, and whose samples can be read `latency` later.
struct Triggered final : hal::SensorSource {
  Triggered(hal::Clock& clock, Time origin, Time step, Time latency)
      : SensorSource(one_channel()), clock_(clock), origin_(origin), step_(step), latency_(latency) {}

 private:
  hal::Result<hal::Frame> do_read() override {
    const std::int64_t k = (clock_.now() - latency_ - origin_).ns / step_.ns;
    if (k % 7 == 0) return hal::Fault::timeout;  // a frame is missed now and then
    hal::Frame frame;
    frame.channels[3] = {1.0, origin_ + step_ * k, hal::Quality::good};
    return frame;
  }

  hal::Clock& clock_;
  Time origin_, step_, latency_;
};

std::optional<SamplePhase> phase_of(VirtualClock& clock, Time origin, Time step, Time age) {
  Triggered sensors(clock, origin, step, hal::microseconds(40));
  constexpr std::array<std::size_t, 1> channels{3};
  return measured_phase(clock, sensors, channels, period, age);
}

// Law (1). Wherever the trigger stands against the loop's start: a period begins when the newest sample is as old as
// was wanted, to the nanosecond, and not before the instant that was asked for.
TEST(SamplePhase, GivesSamplesTheSameAgeAtEveryStart) {
  constexpr Time age = hal::microseconds(250);
  for (const int offset : {0, 1, 130, 499, 500, 501, 870, 999}) {
    VirtualClock clock;
    const Time origin = hal::microseconds(offset) + hal::nanoseconds(17);
    const auto phase = phase_of(clock, origin, period, age);
    ASSERT_TRUE(phase) << offset;
    for (const int later : {0, 333, 12'345}) {
      const Time now = clock.now() + hal::microseconds(later);
      const Time first = phase->next(now);
      EXPECT_GE(first, now);
      EXPECT_LT(first, now + period);
      EXPECT_EQ((first - age - origin).ns % period.ns, 0) << offset << ' ' << later;
    }
  }
}

// Fault. Samples at another rate have no phase against the loop, and channels without a sample none either.
TEST(SamplePhase, IsNoneWhereConvertersRunAtARateOfTheirOwn) {
  VirtualClock clock;
  EXPECT_FALSE(phase_of(clock, {}, hal::microseconds(970), hal::microseconds(250)));
  VirtualClock early;
  early.time = hal::nanoseconds(50'000);  // no sample but the first
  EXPECT_FALSE(phase_of(early, {}, hal::milliseconds(100'000), hal::microseconds(250)));
}

}  // namespace
