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
  explicit Cell(const Parameters& rig, const firmware::Supervision& supervision = {}, double period = h)
      : sensors(sensors_of(RigKind::component_bench)),
        step(hal::seconds(period)),
        samples(firmware::Limits{}, step, sensors),
        guard(supervision, rig, period) {}

  std::optional<Trip> follow(double x, double force, Quality quality = Quality::good) {
    hal::Frame frame;
    now = now + step;
    frame.channels[model::index(Channel::x_act)] = {x, now, Quality::good};
    frame.channels[model::index(Channel::F)] = {force, now, quality};
    samples.take(frame, now);
    return guard.follow(samples, now);
  }
  /// Rectangular, up to ± `peak` [N].
  double noise(double peak) {
    drawn = drawn * 6364136223846793005U + 1442695040888963407U;
    return peak * (2.0 * static_cast<double>(drawn >> 11U) / 9007199254740992.0 - 1.0);
  }

  SilentSensors sensors;
  hal::Time step;
  firmware::SampleGuard samples;
  ForceGuard guard;
  hal::Time now{};
  std::uint64_t drawn = 1;
};

double sine(double t, double amplitude, double frequency = 1.3) { return amplitude * std::sin(two_pi * frequency * t); }

// Point. What the trip shows is the amplitude of F over that of x, whatever the phase between them: 0.05 of 31.5 kN/m, a
// sixth of a cycle ahead at 30 Hz, where x and u are far from independent.
TEST(ForceGuard, ShowsTheStiffnessThatItFinds) {
  Cell cell(paper_rig(RigKind::component_bench));
  const double w = two_pi * 30.0, sixth = two_pi / 6.0;
  std::optional<Trip> trip;
  for (int k = 0; k < 1000; ++k) {  // the second block: the first one begins with a jump
    const auto now = cell.follow(9e-3 * std::sin(w * h * k), 0.05 * 31.5e3 * 9e-3 * std::sin(w * h * k + sixth));
    if (now) trip = now;
  }
  ASSERT_TRUE(trip);
  EXPECT_NEAR(trip->value, 0.05 * 31.5e3, 1.0);
  EXPECT_NEAR(trip->limit, 0.1 * 31.5e3, 1e-9);
}

/// What a cell shows, and when it tears.
struct Shown {
  double stiffness = 31.5e3;  ///< [N/m]
  double amplitude = 9e-3;    ///< of the motion [m]
  double torn = 100.0;        ///< [s]
  double noise = 3.0;         ///< peak [N]
  double hum = 0.0;           ///< at 50 Hz, of the cell that is torn [N]
  double kept = 0.0;          ///< gain that is left then
  double offset = 0.0;        ///< of the cell [N]
  double middle = 0.0;        ///< of the motion [m]
};

/// Seconds from the tear until the guard trips; 20: it does not within so long.
double noticed(const Parameters& rig, const Shown& shown, const firmware::Supervision& supervision = {},
               double period = h) {
  Cell cell(rig, supervision, period);
  for (int k = 0; period * k < 20.0; ++k) {
    const double t = period * k, swing = sine(t, shown.amplitude), force = shown.stiffness * swing;
    const bool torn = t >= shown.torn;
    const double cable = shown.offset + (torn ? shown.hum * std::sin(two_pi * 50.0 * t) : 0.0);
    const double seen = (torn ? shown.kept : 1.0) * force + cable + cell.noise(shown.noise);
    if (const auto trip = cell.follow(shown.middle + swing, seen)) {
      EXPECT_EQ(trip->reason, Reason::innovation);
      EXPECT_EQ(trip->channel, Channel::F);
      EXPECT_LT(trip->value, trip->limit);
      return t - shown.torn;
    }
  }
  return 20.0;
}

// Fault. A torn-off load cell, which no other guard sees, while the bench moves by ± 9 mm: within 1 s at whichever phase
// it tears, at any sample rate, with springs and coupling (86.5 kN/m) before; with ± 3 N of noise, ± 50 N, and a hum of
// 100 N; with an offset of 5 kN, 0.1 m off the middle. A gain that is lost but for a thirtieth is the same.
TEST(ForceGuard, NoticesATornOffCellWithinASecond) {
  const Parameters rig = paper_rig(RigKind::component_bench);
  for (const double period : {2e-3, 1e-3, 0.2e-3}) {
    for (const double torn : {5.0, 5.1, 5.2, 5.3, 5.4, 5.5, 5.6, 5.7}) {
      for (const double stiffness : {31.5e3, 86.5e3}) {
        for (const Shown& shown :
             {Shown{.stiffness = stiffness, .torn = torn}, Shown{.stiffness = stiffness, .torn = torn, .noise = 50.0},
              Shown{.stiffness = stiffness, .torn = torn, .hum = 100.0},
              Shown{.stiffness = stiffness, .torn = torn, .offset = 5e3, .middle = 0.1},
              Shown{.stiffness = stiffness, .torn = torn, .kept = 1.0 / 30.0}}) {
          const double after = noticed(rig, shown, {}, period);
          EXPECT_GT(after, 0.45);  // a block, but for some periods
          EXPECT_LT(after, 1.0) << period << " s, " << torn << " s, " << stiffness << " N/m, " << shown.noise << " N";
        }
      }
    }
  }
}

// Law. A sound cell never trips: be its spring a quarter of what is described, its noise ± 50 N, or what it carries a damper
// or a mass whose force is a quarter of the spring's.
TEST(ForceGuard, LeavesASoundCellAlone) {
  const Parameters rig = paper_rig(RigKind::component_bench);
  for (const double period : {2e-3, 1e-3, 0.2e-3}) {
    EXPECT_EQ(noticed(rig, {.stiffness = 0.25 * 31.5e3}, {}, period), 20.0);
    EXPECT_EQ(noticed(rig, {.stiffness = 0.25 * 31.5e3, .noise = 50.0}, {}, period), 20.0);
    EXPECT_EQ(noticed(rig, {.stiffness = 0.25 * 31.5e3, .offset = 5e3, .middle = 0.1}, {}, period), 20.0);
    Cell damper(rig, {}, period), mass(rig, {}, period);
    for (int k = 0; period * k < 20.0; ++k) {
      const double t = period * k, x = sine(t, 9e-3, 4.0), quarter_cycle_ahead = 9e-3 * std::cos(two_pi * 4.0 * t);
      ASSERT_FALSE(damper.follow(0.1 + x, 0.25 * 31.5e3 * quarter_cycle_ahead + damper.noise(3.0)))
          << period << " " << t;
      ASSERT_FALSE(mass.follow(x, -0.25 * 31.5e3 * x + mass.noise(3.0))) << period << " " << t;
    }
  }
}

// A small motion is not judged: at ± 2.5 mm (1.8 mm rms) friction may be most of the force. A cell that was never there is
// seen by the first block.
TEST(ForceGuard, WaitsForMotion) {
  const Parameters rig = paper_rig(RigKind::component_bench);
  EXPECT_EQ(noticed(rig, {.amplitude = 2.5e-3, .torn = 0.0}), 20.0);
  EXPECT_NEAR(noticed(rig, {.torn = 0.0}), 0.5, 2e-3);
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
  const Shown gone{.torn = 0.0};
  EXPECT_EQ(noticed(paper_rig(RigKind::quarter_car), gone), 20.0);
  Parameters rig = paper_rig(RigKind::component_bench);
  rig.suspension.stiffness = 0.0;
  EXPECT_EQ(noticed(rig, gone), 20.0);
  rig = paper_rig(RigKind::component_bench);
  rig.effects.get<model::Backlash>().active = true;
  rig.effects.get<model::Backlash>().effect.gap = 1e-3;
  EXPECT_EQ(noticed(rig, gone), 20.0);
  rig = paper_rig(RigKind::component_bench);
  rig.effects.get<model::TopMount>().active = true;
  rig.effects.get<model::TopMount>().effect.stiffness = 3.5e3;  // 3.15 kN/m in series: a tenth
  EXPECT_EQ(noticed(rig, {.stiffness = 3.0e3}), 20.0);
  EXPECT_LT(noticed(rig, {.stiffness = 3.0e3, .torn = 5.0}), 1.0);
  rig = paper_rig(RigKind::component_bench);
  EXPECT_LT(noticed(rig, {.stiffness = 3.0e3}) + 100.0, 1.0) << "without the mount that is implausible";
  firmware::Supervision off;
  off.force_share = 0.0;
  EXPECT_EQ(noticed(rig, gone, off), 20.0);
}

/// Why a run of a hil or bench rig ended at a sample rate: F tears off 2.1 s after its start, or never; then it lasts a
/// minute.
Trip end_of_run(RigKind kind, double period, bool tears, bool guarded) {
  Scene scene(kind);
  scene.settings.period = hal::seconds(period);
  const auto samples = static_cast<std::size_t>((tears ? 10.0 : 60.0) / period + 0.5);
  scene.reference = road(samples, 3.0, 0.0, period);
  if (tears) scene.deviations.force_torn_after = static_cast<std::uint64_t>(2.1 / period + 0.5);
  scene.deviations.force_noise = 3.0;
  if (!guarded) scene.settings.supervision.force_share = 0.0;
  Journey run{scene};
  run.loop.arm();
  run.loop.start();
  run.periods(samples + static_cast<std::size_t>(1.0 / period));
  return run.loop.trip();
}

// Fault. In the loop, at three sample rates: F tears off 2.1 s after the start of a run. Its force of a moment ago no
// longer moves the car; the run ends within 1 s by F, and the rig returns to rest. Without the guard nobody notices, and a
// sound minute goes to its end.
TEST(ForceGuard, EndsTheRunOfATornOffCell) {
  for (const RigKind kind : {RigKind::hil, RigKind::component_bench}) {
    for (const double period : {2e-3, 1e-3, 0.2e-3}) {
      const Trip torn = end_of_run(kind, period, true, true);
      EXPECT_EQ(torn.reason, Reason::innovation) << period << " " << name(torn.reason);
      EXPECT_EQ(torn.channel, Channel::F);
      EXPECT_GT(torn.time.seconds(), 2.1);
      EXPECT_LT(torn.time.seconds(), 3.15) << period;
      EXPECT_EQ(end_of_run(kind, period, true, false).reason, Reason::reference_ended) << period;
      EXPECT_EQ(end_of_run(kind, period, false, true).reason, Reason::reference_ended) << period;
    }
  }
}

}  // namespace
}  // namespace force_guard_test
