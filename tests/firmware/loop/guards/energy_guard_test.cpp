#include "firmware/loop/guards/energy_guard.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "model/effects/catalogue.hpp"
#include "tests/support/without_heap.hpp"

namespace energy_guard_test {
namespace {

using firmware::EnergyGuard;
using firmware::Limits;
using firmware::Reason;
using firmware::Trip;

constexpr double h = 1e-3;
constexpr double two_pi = 6.283185307179586;
constexpr double f = 12.5, w = two_pi * f;  // about that of a wheel; a cycle has 80 periods

/// A deflection a sin ωt behind which stands a spring k that is late by `delay`; its force is held for a period.
struct LateSpring {
  double amplitude = 10e-3;
  double stiffness = 80e3;
  double delay = 10e-3;
  double wheel_share = 0.0;  ///< of the deflection's way that the wheel goes
  double offset = 0.0;       ///< of the force sensor [N]

  [[nodiscard]] double deflection(int k) const { return amplitude * std::sin(w * h * k); }
  [[nodiscard]] double force(int k) const { return offset + stiffness * amplitude * std::sin(w * (h * k - delay)); }

  /// What it feeds for each joule that a damper b takes:   k sin ω(delay + h/2) / (ω b).
  [[nodiscard]] double ratio(double damping) const {
    return stiffness * std::sin(w * (delay + 0.5 * h)) / (w * damping);
  }

  /// `periods` from period `first` on; the first hazard, and in `at` its period. A run begins at rest, where the force
  /// is the offset alone.
  std::optional<Trip> drive(EnergyGuard& guard, int first, int periods, int* at = nullptr) const {
    if (first == 0) static_cast<void>(guard.follow(offset, 0.0, 0.0));
    for (int k = first; k < first + periods; ++k) {
      const double way = deflection(k + 1) - deflection(k);
      const auto hazard = guard.follow(force(k), deflection(k + 1), wheel_share * way);
      if (!hazard) continue;
      if (at != nullptr) *at = k;
      return hazard;
    }
    return std::nullopt;
  }
};

// Point: (1), (2) against the closed form of a late spring, over 50 whole cycles. The held force is late by half a
// period more; ways between samples are too short for the velocity by (ωh)²/24 = 3e-4 of it.
TEST(EnergyGuard, FollowsALateSpringInClosedForm) {
  for (const double delay : {2e-3, 10e-3, 25e-3}) {
    LateSpring spring;
    spring.delay = delay;
    const double damping = 2.0 * std::abs(spring.ratio(1.0));  // takes twice what is fed, so nothing trips
    Limits limits;
    limits.energy_memory = 1e6;
    EnergyGuard guard(limits, damping, 0.0, h);
    EXPECT_FALSE(spring.drive(guard, 0, 4000));
    EXPECT_NEAR(guard.fed() / guard.taken() / spring.ratio(damping), 1.0, 1e-3) << delay;
  }
}

// (6): after a memory's time the past weighs 1/e. While the deflection stands still its mean comes closer, by
// (1 − λ) y a period: together a share of 1 − λ = 0.4 % of the first way's energy, hence the tolerance.
TEST(EnergyGuard, ForgetsByItsMemory) {
  Limits limits;
  limits.energy_memory = 0.25;
  EnergyGuard guard(limits, 1000.0, 0.0, h);
  static_cast<void>(guard.follow(0.0, 0.0, 0.0));
  static_cast<void>(guard.follow(-100.0, 1e-3, 0.0));
  const double rest = 1.0 - h / 0.25;  // of a change, after the mean has followed it for a period
  const double fed = guard.fed(), taken = guard.taken();
  EXPECT_NEAR(fed, 0.1 * rest * rest, 1e-12) << "(1), (2), (3)";
  EXPECT_NEAR(taken, 1000.0 * 1e-6 * rest * rest / h, 1e-12) << "(2), (4)";
  for (int k = 0; k < 250; ++k) static_cast<void>(guard.follow(-100.0, 1e-3, 0.0));
  EXPECT_NEAR(guard.taken() / taken, std::exp(-1.0), 4e-3);
}

// Law. The border of stability: 3 % more than the dampers take trips, 3 % less never does; each of the two dampers
// counts.
TEST(EnergyGuard, TripsWhereTheInterfaceOutweighsTheDampers) {
  LateSpring spring;
  spring.wheel_share = 0.8;
  for (const double tyre : {0.0, 200.0}) {
    const double border = spring.ratio(1.0) - 0.64 * tyre;  // virtual damping that takes what is left
    EnergyGuard stable(Limits{}, 1.03 * border, tyre, h);
    EXPECT_FALSE(spring.drive(stable, 0, 20'000));
    EnergyGuard unstable(Limits{}, 0.97 * border, tyre, h);
    const auto hazard = spring.drive(unstable, 0, 20'000);
    ASSERT_TRUE(hazard) << tyre;
    EXPECT_EQ(hazard->reason, Reason::energy);
    EXPECT_GT(hazard->value, 1.0);
    EXPECT_EQ(hazard->limit, 1.0);
  }
}

// A component without delay only takes, whatever its stiffness; also where nothing else damps.
TEST(EnergyGuard, BelievesAComponentThatTakes) {
  LateSpring spring;
  spring.delay = -2e-3;  // early: a damper of k sin(ω · 2 ms)/ω
  EnergyGuard guard(Limits{}, 0.0, 0.0, h);
  EXPECT_FALSE(spring.drive(guard, 0, 20'000));
  EXPECT_LT(guard.fed(), 0.0);
}

// Three cycles in a row: the first begins with the first turn, so the hazard comes in the fourth turn at the latest –
// and not before the third.
TEST(EnergyGuard, WaitsForCyclesInARow) {
  const LateSpring spring;
  for (const int cycles : {1, 3, 6}) {
    Limits limits;
    limits.energy_cycles = cycles;
    EnergyGuard guard(limits, 0.2 * spring.ratio(1.0), 0.0, h);
    int at = 0;
    ASSERT_TRUE(spring.drive(guard, 0, 20'000, &at));
    EXPECT_NEAR(at * h * f, cycles - 0.25, 1.1 * h * f) << "turns lie at ¾ of each cycle of a sine";
  }
}

// One wide cycle and two quiet ones, and again: seen from turn to turn never more than two wide ones in a row.
TEST(EnergyGuard, BeginsToCountAgainAfterAQuietCycle) {
  LateSpring wide, quiet;
  quiet.amplitude = 0.1e-3;
  EnergyGuard guard(Limits{}, 0.2 * wide.ratio(1.0), 0.0, h);
  for (int cycle = 0; cycle < 60; ++cycle) {
    const LateSpring& spring = cycle % 3 == 0 ? wide : quiet;
    EXPECT_FALSE(spring.drive(guard, 80 * cycle, 80)) << cycle;
  }
}

// What is too small to do harm, sensor noise at rest above all, never trips.
TEST(EnergyGuard, LeavesQuietCyclesAlone) {
  LateSpring spring;
  spring.amplitude = 0.49 * Limits{}.energy_quiet;
  EnergyGuard guard(Limits{}, 0.0, 0.0, h);
  EXPECT_FALSE(spring.drive(guard, 0, 20'000));
  spring.amplitude = 0.51 * Limits{}.energy_quiet;
  EnergyGuard awake(Limits{}, 0.0, 0.0, h);
  const auto hazard = spring.drive(awake, 0, 20'000);
  ASSERT_TRUE(hazard);
  EXPECT_TRUE(std::isfinite(hazard->value)) << "nothing takes anything: still a number for the record";
}

// An offset of the force sensor does work on every way there and gives it back on the way back.
TEST(EnergyGuard, IsBlindToAnOffsetOfTheForce) {
  LateSpring spring;
  spring.offset = 500.0;
  EnergyGuard guard(Limits{}, 1.2 * spring.ratio(1.0), 0.0, h);
  EXPECT_FALSE(spring.drive(guard, 0, 20'000));
}

// 1000 N that nobody tared: the body sinks by 1000 N/k and swings about its new place. A stable loop with that offset
// must not trip. (The mean of the force starts with the first sample and follows as the mean of the deflection does.)
TEST(EnergyGuard, LetsABodySinkUnderAnOffset) {
  const double stiffness = 31.5e3, mass = 290.0, damping = 1140.0;
  for (const double offset : {-1000.0, 300.0, 1000.0, 3000.0}) {
    EnergyGuard guard(Limits{}, damping, 0.0, h);
    double body = 0.0, velocity = 0.0;
    for (int k = 0; k < 10'000; ++k) {
      const double force = offset - stiffness * body;  // deflection x = −z_b: the wheel stands
      const auto hazard = guard.follow(force, -body, 0.0);
      EXPECT_FALSE(hazard) << offset << " N, " << name(hazard->reason) << " after " << k * h << " s";
      if (hazard) break;
      velocity += h * (force - damping * velocity) / mass;
      body += h * velocity;
    }
  }
}

// A wrong sign of the force: the deflection grows without ever turning. It has no turning point to be judged at.
TEST(EnergyGuard, TripsWhenADeflectionGrowsWithoutTurning) {
  const double stiffness = 31.5e3, mass = 290.0, damping = 1140.0;
  for (const double offset : {0.0, 1000.0}) {
    for (const double side : {1.0, -1.0}) {
      EnergyGuard guard(Limits{}, damping, 0.0, h);
      double body = side * 1e-4, velocity = 0.0;
      std::optional<Trip> hazard;
      for (int k = 0; k < 2000 && !hazard; ++k) {
        const double force = offset + stiffness * body;
        hazard = guard.follow(force, -body, 0.0);
        velocity += h * (force - offset - damping * velocity) / mass;
        body += h * velocity;
      }
      ASSERT_TRUE(hazard) << offset;
      EXPECT_EQ(hazard->reason, Reason::growth);
      EXPECT_GT(hazard->value, 1.0);
      // The mean follows with 0.5 s, so y = 0.81 x at a growth of s = 8.6 1/s: 2 mm of y are 2.5 mm of x, and
      // growth_time later x is e^0.86 times that, 5.8 mm.
      EXPECT_LT(std::abs(body), 10e-3) << offset;
    }
  }
}

// A new run owes nothing to the last one.
TEST(EnergyGuard, StartsAnew) {
  const LateSpring spring;
  EnergyGuard guard(Limits{}, 0.2 * spring.ratio(1.0), 0.0, h);
  int first = 0, second = 0;
  ASSERT_TRUE(spring.drive(guard, 0, 20'000, &first));
  static_cast<void>(spring.drive(guard, first + 1, 100));
  guard.start(0.0);
  EXPECT_EQ(guard.fed(), 0.0);
  ASSERT_TRUE(spring.drive(guard, 0, 20'000, &second));
  EXPECT_EQ(second, first);
}

// The guard counts the dampers that a virtual car can have. Guides would take energy as well, but in a hil rig body and
// wheel are numbers without any: were such an effect admitted there one day, the guard would have to know it.
TEST(EnergyGuard, KnowsEveryDamperOfAVirtualCar) {
  using model::RigKind;
  EXPECT_FALSE(model::BodyGuideDamping<double>::card.rigs.contains(RigKind::hil));
  EXPECT_FALSE(model::WheelGuideDamping<double>::card.rigs.contains(RigKind::hil));
  EXPECT_FALSE(model::BodyGuideFriction<double>::card.rigs.contains(RigKind::hil));
  EXPECT_FALSE(model::WheelGuideFriction<double>::card.rigs.contains(RigKind::hil));
}

TEST(EnergyGuard, TakesNoHeap) {
  const LateSpring spring;
  EnergyGuard guard(Limits{}, 2.0 * spring.ratio(1.0), 0.0, h);
  EXPECT_FALSE(support::without_heap([&] { return spring.drive(guard, 0, 1000); }));
}

}  // namespace
}  // namespace energy_guard_test
