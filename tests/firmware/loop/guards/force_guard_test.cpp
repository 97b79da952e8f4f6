// A force that does not answer the motion: what is noticed, how soon, and what is left alone.
#include "firmware/loop/guards/force_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "tests/firmware/loop/rig_under_test.hpp"
#include "tests/firmware/loop/silent_sensors.hpp"

namespace force_guard_test {
namespace {

using namespace rig_under_test;
using firmware::ForceGuard;
using firmware::Reason;
using firmware::Trip;
using hal::Quality;
using model::RigKind;

/// A guard with its two sensors.
struct Cell {
  explicit Cell(const Parameters& rig, const firmware::Supervision& supervision = {})
      : sensors(sensors_of(RigKind::component_bench)),
        samples(firmware::Limits{}, ms, sensors),
        guard(supervision, rig, h) {}

  std::optional<Trip> follow(double x, double force, Quality quality = Quality::good) {
    hal::Frame frame;
    now = now + ms;
    frame.channels[model::index(Channel::x_act)] = {x, now, Quality::good};
    frame.channels[model::index(Channel::F)] = {force, now, quality};
    samples.take(frame, now);
    return guard.follow(samples, now);
  }
  /// ± 3 N, rectangular.
  double noise() {
    drawn = drawn * 6364136223846793005U + 1442695040888963407U;
    return 6.0 * static_cast<double>(drawn >> 11U) / 9007199254740992.0 - 3.0;
  }

  SilentSensors sensors;
  firmware::SampleGuard samples;
  ForceGuard guard;
  hal::Time now{};
  std::uint64_t drawn = 1;
};

double sine(double t, double amplitude) { return amplitude * std::sin(two_pi * 1.3 * t); }

/// Seconds from the tear at `torn` until the guard trips; 20: it does not.
double noticed(const Parameters& rig, double stiffness, double amplitude, double torn,
               const firmware::Supervision& supervision = {}) {
  Cell cell(rig, supervision);
  for (int k = 0; k < 20'000; ++k) {
    const double t = h * k, x = sine(t, amplitude);
    if (const auto trip = cell.follow(x, (t < torn ? stiffness * x : 0.0) + cell.noise())) {
      EXPECT_EQ(trip->reason, Reason::innovation);
      EXPECT_EQ(trip->channel, Channel::F);
      return t - torn;
    }
  }
  return 20.0;
}

// Fault. A torn-off load cell with ± 3 N of noise, which no other guard sees, while the bench moves by ± 9 mm: within 3 s,
// at whichever phase it tears, and with springs and coupling (86.5 kN/m) before. A sound one never trips, be its spring
// a quarter of what is described (0.25: above the share of 0.1).
TEST(ForceGuard, NoticesATornOffCellWithinThreeSeconds) {
  const Parameters rig = paper_rig(RigKind::component_bench);
  for (const double torn : {5.0, 5.1, 5.2, 5.3, 5.4, 5.5, 5.6, 5.7}) {
    for (const double stiffness : {31.5e3, 86.5e3}) {
      const double after = noticed(rig, stiffness, 9e-3, torn);
      EXPECT_GT(after, 0.5);
      EXPECT_LT(after, 3.0) << torn << " s, " << stiffness << " N/m";
    }
  }
  EXPECT_EQ(noticed(rig, 0.25 * 31.5e3, 9e-3, 100.0), 20.0);
}

// A small motion is not judged: at ± 2.5 mm (1.8 mm rms) noise and friction may be most of the force. A torn cell that
// was never there is seen as soon as the motion is known, half of it the guard's own memory of 0.5 s.
TEST(ForceGuard, WaitsForMotion) {
  const Parameters rig = paper_rig(RigKind::component_bench);
  EXPECT_EQ(noticed(rig, 0.0, 2.5e-3, 0.0), 20.0);
  EXPECT_LT(noticed(rig, 0.0, 9e-3, 0.0), 0.5);
}

// Samples that are lost or clipped say nothing, for however long: SampleGuard has its own word for them.
TEST(ForceGuard, LeavesBadSamplesOut) {
  Cell cell(paper_rig(RigKind::component_bench));
  for (int k = 0; k < 20'000; ++k) {
    const double x = sine(h * k, 9e-3);
    const bool bad = k > 4000;
    EXPECT_FALSE(cell.follow(x, bad ? 0.0 : 31.5e3 * x, bad ? Quality::clipped : Quality::good)) << k;
  }
}

// Not judged: a car, a damper alone, free play, a sensor that saturates as described. A soft mount counts in series, a
// sensor's gain with it.
TEST(ForceGuard, ExpectsWhatIsDescribed) {
  EXPECT_EQ(noticed(paper_rig(RigKind::quarter_car), 0.0, 9e-3, 0.0), 20.0);
  Parameters rig = paper_rig(RigKind::component_bench);
  rig.suspension.stiffness = 0.0;
  EXPECT_EQ(noticed(rig, 0.0, 9e-3, 0.0), 20.0);
  rig = paper_rig(RigKind::component_bench);
  rig.effects.get<model::Backlash>().active = true;
  rig.effects.get<model::Backlash>().effect.gap = 1e-3;
  EXPECT_EQ(noticed(rig, 0.0, 9e-3, 0.0), 20.0);
  rig = paper_rig(RigKind::component_bench);
  rig.effects.get<model::TopMount>().active = true;
  rig.effects.get<model::TopMount>().effect.stiffness = 3.5e3;  // 3.15 kN/m in series: a tenth
  EXPECT_EQ(noticed(rig, 3.0e3, 9e-3, 100.0), 20.0);
  EXPECT_LT(noticed(rig, 0.0, 9e-3, 5.0), 3.0);
  rig = paper_rig(RigKind::component_bench);
  EXPECT_LT(noticed(rig, 3.0e3, 9e-3, 100.0) + 100.0, 3.0) << "without the mount that is implausible";
  firmware::Supervision off;
  off.force_share = 0.0;
  EXPECT_EQ(noticed(rig, 0.0, 9e-3, 0.0, off), 20.0);
}

// Fault. In the loop, on a hil rig: F tears off 2 s after the start of a run. Its force of a moment ago no longer moves
// the car; the run ends within 3 s by F, and the rig returns to rest.
TEST(ForceGuard, EndsTheRunOfAHilRig) {
  Scene scene(RigKind::hil, 20'000);
  scene.reference = road(20'000, 3.0);
  scene.deviations.force_torn_after = 2000;
  scene.deviations.force_noise = 3.0;
  Journey run{scene};
  run.whole();
  EXPECT_EQ(run.loop.trip().reason, Reason::innovation) << name(run.loop.trip().reason);
  EXPECT_EQ(run.loop.trip().channel, Channel::F);
  EXPECT_LT(run.loop.trip().time.seconds(), 5.0);
  EXPECT_GT(run.loop.trip().time.seconds(), 2.0);
}

}  // namespace
}  // namespace force_guard_test
