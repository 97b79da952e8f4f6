// A sensor of a quarter car that contradicts the Kalman filter: what is noticed, how soon, and what is left alone.
#include "firmware/loop/guards/innovation_guard.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "firmware/loop/kalman/steady_gains.hpp"
#include "firmware/loop/semi_active.hpp"
#include "tests/firmware/loop/kalman/linear_car.hpp"
#include "tests/firmware/loop/rig_under_test.hpp"

namespace innovation_guard_test {
namespace {

using firmware::EstimatorEquations;
using firmware::InnovationGuard;
using firmware::Reason;
using firmware::Trip;
using model::Channel;
using support::LinearCar;

const std::vector<Channel> every{Channel::z_r,   Channel::dz_w,  Channel::dz_b,
                                 Channel::zdd_b, Channel::zdd_w, Channel::F_w};

/// A car on its road, its filter and the guard behind it.
struct Watched {
  explicit Watched(std::uint64_t seed, double false_alarms = 1e-2, const firmware::Supervision& supervision = {},
                   const std::vector<Channel>& channels = every, double period = LinearCar::period)
      : equations(settings_of(channels, false_alarms), LinearCar::rig()),
        filter(equations, *std::make_unique<firmware::SteadyGains>(equations, period), period),
        guard(supervision, equations, period),
        used(channels),
        car(seed, period),
        normal(seed + 1),
        step_time(hal::seconds(period)) {}

  static firmware::KalmanSettings settings_of(const std::vector<Channel>& channels, double false_alarms) {
    firmware::KalmanSettings settings = LinearCar::settings(channels);
    settings.false_alarms = false_alarms;
    return settings;
  }
  /// One period; `disturb` changes what is read of a channel.
  template <class Disturb>
  std::optional<Trip> step(const Disturb& disturb) {
    car.step();
    now = now + step_time;
    hal::Frame frame;
    for (const Channel channel : used) {
      const std::optional<double> value = disturb(channel, car.reading(channel));
      if (value) frame.channels[model::index(channel)] = {*value, now, hal::Quality::good};
    }
    filter.step(frame, 0, now);
    return guard.follow(filter, now);
  }

  EstimatorEquations equations;
  firmware::KalmanFilter filter;
  InnovationGuard guard;
  std::vector<Channel> used;
  support::DrivenCar car;
  support::Normal normal;
  hal::Time step_time;
  hal::Time now{};
};

// Fault. Each sensor in turn shows nothing but the noise that is described; F_w ± 3 N, which no other guard sees. It is
// noticed within a second, at whichever moment it tears. The guard names the very channel, but for z_r, which is the
// filter's only hold on the road, and zdd_w, which leads the others astray.
TEST(InnovationGuard, NoticesASensorThatIsTornOff) {
  for (const Channel torn : every) {
    for (const int after : {5000, 5217, 5433}) {
      Watched rig(static_cast<std::uint64_t>(after));
      std::optional<Trip> trip;
      int k = 0;
      while (!trip && k < after + 4000) {
        ++k;
        trip = rig.step([&](Channel channel, double value) {
          const double noise = channel == Channel::F_w ? 3.0 : LinearCar::noise(channel);
          return std::optional(channel == torn && k > after ? noise * rig.normal() : value);
        });
      }
      ASSERT_TRUE(trip) << model::name(torn) << " " << after;
      EXPECT_EQ(trip->reason, Reason::innovation);
      const bool misleads = torn == Channel::z_r || torn == Channel::zdd_w;
      if (!misleads) {
        EXPECT_EQ(trip->channel, torn) << model::name(*trip->channel) << " " << after;
      }
      EXPECT_GT(trip->value, trip->limit);
      EXPECT_GT(k, after);
      EXPECT_LT(k, after + 1000) << model::name(torn);
    }
  }
}

// Law. At any sample rate: a torn-off F_w, a dz_b whose gain is lost but for a tenth, a body's accelerometer that shows
// nothing are noticed within a second; a sound minute ends by nothing.
TEST(InnovationGuard, JudgesByTime) {
  for (const double period : {2e-3, 1e-3, 0.2e-3}) {
    const auto samples = [&](double time) { return static_cast<int>(time / period + 0.5); };
    for (const Channel lost : {Channel::F_w, Channel::dz_b, Channel::zdd_b}) {
      for (const int after : {samples(5.0), samples(5.25)}) {
        Watched rig(static_cast<std::uint64_t>(after), 1e-2, {}, every, period);
        std::optional<Trip> trip;
        int k = 0;
        while (!trip && k < after + samples(4.0)) {
          ++k;
          trip = rig.step([&](Channel channel, double value) {
            const double shown = channel == Channel::F_w ? 3.0 * rig.normal() : 0.1 * value;
            return std::optional(channel == lost && k > after ? shown : value);
          });
        }
        ASSERT_TRUE(trip) << model::name(lost) << " " << period;
        EXPECT_EQ(trip->channel, lost) << model::name(*trip->channel) << " " << period;
        EXPECT_GT(k, after);
        EXPECT_LT(k, after + samples(1.0)) << model::name(lost) << " " << period;
      }
    }
    Watched sound(11, 1e-2, {}, every, period);
    for (int k = 0; k < samples(60.0); ++k) {
      const auto trip = sound.step([&](Channel, double value) { return std::optional(value); });
      ASSERT_FALSE(trip) << period << ": " << model::name(*trip->channel) << " at " << k;
    }
  }
}

// Law. What a right model with right noise never does, nor one that is a tenth off: no false alarm within a minute each
// (ten hours of the whole loop: ../../../../firmware/loop/README.md).
TEST(InnovationGuard, LeavesARightAndANearlyRightModelAlone) {
  for (const double wrong : {0.0, 0.1, -0.1}) {
    Watched rig(11);
    for (int k = 0; k < 60'000; ++k) {
      const auto trip = rig.step([&](Channel channel, double value) {
        return std::optional(value + (channel == Channel::F_w || channel == Channel::zdd_b ? wrong * value : 0.0));
      });
      ASSERT_FALSE(trip) << wrong << ": " << model::name(*trip->channel) << " at " << k;
    }
  }
}

/// Whether sensors with so many times their noise end a run within 10 s, of a car that drives or stands. The filter has
/// run for 3 s before.
bool ends_by_noise(double factor, bool drives, const firmware::Supervision& supervision = {}) {
  Watched rig(7, 1e-2, supervision);
  for (int k = 0; k < 13'000; ++k) {
    const auto trip = rig.step([&](Channel channel, double) {
      return std::optional((drives ? rig.car.truth(channel) : 0.0) + factor * LinearCar::noise(channel) * rig.normal());
    });
    if (k < 3000) rig.guard.start();
    if (k >= 3000 && trip) return true;
  }
  return false;
}

// Point. Sensors may have up to 3 times the noise that is described; 8 times is a broken sensor.
TEST(InnovationGuard, KnowsNoiseFromFaults) {
  EXPECT_FALSE(ends_by_noise(2.5, false));
  EXPECT_FALSE(ends_by_noise(2.5, true));
  EXPECT_TRUE(ends_by_noise(8.0, false));
  firmware::Supervision wide;
  wide.innovation_noise = 12.0;
  EXPECT_FALSE(ends_by_noise(8.0, false, wide));
}

// Point. (4): N = 1000, 0.01 false alarms an hour of six channels at 1 kHz: p = 4.6e-10, hence z = 6.12 and
// c = 1.299. A hundred times as many: z = 5.34, c = 1.258.
TEST(InnovationGuard, HasTheLimitOfItsFalseAlarmRate) {
  const Watched rare(1, 1e-2), frequent(1, 1.0);
  EXPECT_NEAR(rare.guard.limit() / 9.0, 1.299, 2e-3);
  EXPECT_NEAR(frequent.guard.limit() / 9.0, 1.258, 2e-3);
}

// Samples that are lost say nothing, for however long: SampleGuard has its own word for them.
TEST(InnovationGuard, LeavesLostSamplesOut) {
  Watched rig(5);
  for (int k = 0; k < 10'000; ++k) {
    const auto trip = rig.step([&](Channel channel, double value) {
      const bool lost = channel == Channel::F_w && k > 3000;
      return lost ? std::nullopt : std::optional(value);
    });
    ASSERT_FALSE(trip) << k;
  }
}

// Fault. In the loop: F_w of a quarter car tears off 4 s after the start of a run and shows ± 3 N. The run ends by it
// within 2 s, and the cylinder returns to rest; with the guard off by a wide share nobody notices.
TEST(InnovationGuard, EndsTheRunOfAQuarterCar) {
  for (const bool wide : {false, true}) {
    rig_under_test::Scene scene(model::RigKind::quarter_car, 9000);
    scene.reference = rig_under_test::road(9000, 3.0);
    scene.deviations.force_torn_after = 4000;
    scene.deviations.force_noise = 3.0;
    if (wide) scene.settings.supervision.innovation_share = 1000.0;
    firmware::KalmanSettings settings;
    for (const Channel c : every) settings.noise[model::index(c)] = LinearCar::noise(c);
    const EstimatorEquations equations(settings, scene.parameters);
    const auto gains = std::make_unique<firmware::SteadyGains>(equations, 1e-3);
    const auto companion = std::make_unique<firmware::SemiActive>(equations, *gains, firmware::DuctPolicySettings{},
                                                                  1e-3, scene.settings.supervision);
    rig_under_test::Journey run{scene};
    run.loop.attach(*companion);
    run.whole();
    if (wide) {
      EXPECT_EQ(run.loop.trip().reason, Reason::reference_ended) << name(run.loop.trip().reason);
      continue;
    }
    EXPECT_EQ(run.loop.trip().reason, Reason::innovation) << name(run.loop.trip().reason);
    EXPECT_EQ(run.loop.trip().channel, Channel::F_w);
    EXPECT_GT(run.loop.trip().time.seconds(), 4.0);
    EXPECT_LT(run.loop.trip().time.seconds(), 6.0);
    rig_under_test::expect_safe_end(run);
  }
}

}  // namespace
}  // namespace innovation_guard_test
