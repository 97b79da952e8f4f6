// Map, border and sweep; and what a user may ask for.
#include "host_sim/stability/map/stability_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/description/text/input_error.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using namespace host_sim::stability;
using stability_tests::fdva_rig;
using stability_tests::linear_rig;
using stability_tests::random_rig;
using stability_tests::Rig;

double rightmost(const LoopFamily& family, const StabilityMap& map, double x, double y) {
  return characteristic_roots(family.at({{map.x.variable, x}, {map.y.variable, y}}), -60.0).rightmost().real();
}

/// The map's points are the roots found from nothing, to 1e-9.
void expect_exact(const LoopFamily& family, const StabilityMap& map, unsigned seed) {
  std::mt19937_64 random(seed);
  for (int i = 0; i < 60; ++i) {
    const std::size_t ix = random() % map.x.count, iy = random() % map.y.count;
    const double re = rightmost(family, map, map.x.value(ix), map.y.value(iy));
    EXPECT_NEAR(map.at(ix, iy), re, 1e-9 * (1.0 + std::abs(re))) << ix << ", " << iy << ", seed " << seed;
  }
}

/// Each point of a border has a root on the axis and none right of it.
void expect_border(const LoopFamily& family, const StabilityMap& map, std::size_t least) {
  std::size_t count = 0;
  for (const BoundaryCurve& curve : map.boundary) {
    for (const BoundaryPoint& point : curve.points) {
      EXPECT_GE(point.x, map.x.from);
      EXPECT_LE(point.x, map.x.to);
      EXPECT_GE(point.y, map.y.from * (1.0 - 1e-9) - 1e-9);
      EXPECT_LE(point.y, map.y.to * (1.0 + 1e-9));
      const DelayEquation equation = family.at({{map.x.variable, point.x}, {map.y.variable, point.y}});
      const Complex s(0.0, point.omega);
      EXPECT_LT(std::abs(equation(s)), 1e-9 * equation.scale(s)) << point.x << ", " << point.y;
      if (point.border && count++ % 7 == 0) {
        EXPECT_NEAR(rightmost(family, map, point.x, point.y), 0.0, 1e-6);
      }
    }
  }
  EXPECT_GE(count, least);
}

// Law. Following gives what finding from nothing gives, for the rigs of the paper over delay and virtual damping.
TEST(StabilityMap, IsExactOverDelayAndVirtualDamping) {
  for (const Rig& rig : {linear_rig(), fdva_rig()}) {
    const LoopFamily family(rig, 0.0);
    const StabilityMap map = stability_map(family, {"tau", 0.0, 0.03, 41}, {"virtual_damping", 0.0, 2000.0, 31}, 2);
    expect_exact(family, map, 1);
    expect_border(family, map, 100);
    // The delay on the other axis gives the same plane, turned over.
    const StabilityMap turned = stability_map(family, {"virtual_damping", 0.0, 2000.0, 31}, {"tau", 0.0, 0.03, 41}, 1);
    for (std::size_t i = 0; i < 41; ++i) {
      for (std::size_t k = 0; k < 31; ++k) EXPECT_EQ(map.at(i, k), turned.at(k, i));
    }
    EXPECT_EQ(map.boundary.size(), turned.boundary.size());
  }
}

// Golden. The border of the FDVA rig passes through 10 ms and 908.04 N s/m, and the map changes sign across it.
TEST(StabilityMap, BorderPassesThroughThePapersPoint) {
  const LoopFamily family(fdva_rig(), 0.0);
  const StabilityMap map = stability_map(family, {"tau", 0.0, 0.03, 31}, {"virtual_damping", 0.0, 2000.0, 21}, 1);
  double nearest = 1e300;
  for (const BoundaryCurve& curve : map.boundary) {
    EXPECT_TRUE(curve.connected);
    for (std::size_t i = 1; i < curve.points.size(); ++i) {
      const BoundaryPoint &a = curve.points[i - 1], &b = curve.points[i];
      // Neighbours are near enough to be joined by a straight line: a fiftieth of the plane.
      EXPECT_LT(std::hypot((a.x - b.x) / 0.03, (a.y - b.y) / 2000.0), 0.02);
      if ((a.x - 0.010) * (b.x - 0.010) > 0.0 || !a.border) continue;
      const double share = (0.010 - a.x) / (b.x - a.x);
      nearest = std::min(nearest, std::abs(a.y + share * (b.y - a.y) - 908.04));
    }
  }
  EXPECT_LT(nearest, 0.1);  // the chord's error, some 1e-5 of 2000 N s/m
}

// Law. Signs on the map and border agree: walking along a row of constant damping, stability changes between two points
// if and only if an odd number of border points lies between them.
TEST(StabilityMap, StabilityChangesAtTheBorderAndNowhereElse) {
  const LoopFamily family(fdva_rig(), 0.0);
  const StabilityMap map =
      stability_map(family, {"tau", 0.0, 0.03, 61}, {"fdva.coupling_stiffness", 20e3, 90e3, 15}, 1);
  for (std::size_t iy = 0; iy < map.y.count; ++iy) {
    for (std::size_t ix = 1; ix < map.x.count; ++ix) {
      int between = 0;
      for (const BoundaryPoint& p : map.boundary.front().points) {
        between += p.border && p.y == map.y.value(iy) && p.x > map.x.value(ix - 1) && p.x <= map.x.value(ix) ? 1 : 0;
      }
      EXPECT_EQ((map.at(ix - 1, iy) < 0.0) != (map.at(ix, iy) < 0.0), between % 2 == 1) << ix << ", " << iy;
    }
  }
}

// Law. Any two parameters of the rig span a map, with every linear effect in the rig.
TEST(StabilityMap, TakesAnyTwoParameters) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    const LoopFamily family(random_rig(seed, true), 0.001);
    const StabilityMap map =
        stability_map(family, {"suspension.stiffness", 1e4, 1e5, 21}, {"virtual_damping", 0.0, 3000.0, 17}, 1);
    expect_exact(family, map, seed);
    expect_border(family, map, 0);
  }
  const LoopFamily family(fdva_rig(), 0.0);
  expect_border(
      family, stability_map(family, {"suspension.stiffness", 1e4, 1e5, 21}, {"virtual_damping", 0.0, 2000.0, 21}), 10);
}

// Law. The number of threads changes nothing, and progress ends at 1.
TEST(StabilityMap, IsTheSameOnAnyNumberOfThreads) {
  const LoopFamily family(fdva_rig(), 0.0);
  const Axis x{"tau", 0.0, 0.03, 25}, y{"virtual_damping", 0.0, 2000.0, 25};
  double share = 0.0;
  const StabilityMap one = stability_map(family, x, y, 1, [&](double s) { share = s; });
  EXPECT_EQ(share, 1.0);
  const StabilityMap four = stability_map(family, x, y, 4);
  EXPECT_EQ(one.rightmost, four.rightmost);
  EXPECT_EQ(one.frequency, four.frequency);
}

// Law. Following is what makes the map fast: roots are found anew at a small share of its points.
TEST(RootTracker, SeldomSearches) {
  const LoopFamily family(fdva_rig(), 0.0);
  const StabilityMap map = stability_map(family, {"tau", 0.0, 0.03, 200}, {"virtual_damping", 0.0, 2000.0, 20}, 1);
  EXPECT_LT(map.searches, map.rightmost.size() / 20);
}

// Fault. A root that comes from the left unseen is noticed: the tracker follows one equation and is given another.
TEST(RootTracker, NoticesARootThatItDidNotFollow) {
  RootTracker tracker;
  EXPECT_NEAR(tracker.rightmost({{2.0, 1.0}, {}, 0.0}).real(), -2.0, 1e-12);
  EXPECT_NEAR(tracker.rightmost({{2.0, 3.0, 1.0}, {}, 0.0}).real(), -1.0, 1e-12);
  EXPECT_NEAR(tracker.rightmost({{-10.0, 3.0, 6.0, 1.0}, {}, 0.0}).real(), 1.0, 1e-12);
}

// Law. A sweep holds the roots of each value.
TEST(PoleSweep, HoldsTheRootsOfEachValue) {
  const LoopFamily family(fdva_rig(), 0.0);
  const PoleSweep sweep = pole_sweep(family, {"virtual_damping", 700.0, 1140.0, 3}, -60.0);
  ASSERT_EQ(sweep.roots.size(), 3U);
  EXPECT_NEAR(sweep.roots[0][0].real(), 2.1685, 1e-4);
  EXPECT_EQ(sweep.axis.value(1), 920.0);
  for (const auto& roots : sweep.roots) EXPECT_EQ(roots.size(), 3U);
}

// Fault. Each wrong range is one line that says what is wrong.
TEST(MapText, RefusesWhatIsNoMap) {
  const Rig rig = fdva_rig();
  const auto message = [&](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_map(text, rig, 1e-3));
    } catch (const firmware::UsageError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string good = ",virtual_damping=0:2000:200";
  EXPECT_EQ(message("tau=0:0.03:200" + good), "accepted");
  const auto says = [&](const std::string& text, const std::string& what) {
    EXPECT_NE(message(text).find(what), std::string::npos) << text << " → " << message(text);
  };
  says("tau=0.03:0:200" + good, "runs backwards");
  says("tau=0.03:0.03:200" + good, "runs backwards or is empty");
  says("tau=0:0.03" + good, "is not a range");
  says("tau=0:0.03:2:2" + good, "is not a range");
  says("tau=0:0.03:1" + good, "whole number in 2");
  says("tau=0:0.03:2.5" + good, "whole number in 2");
  says("tau=0:0.03:1e9" + good, "whole number in 2");
  says("tau=0:x:20" + good, "'x' is not a number");
  says("tau=0:nan:20" + good, "'nan' is not a number");
  says("tau=-0.1:0.03:20" + good, "out of range");
  says("tau=0:1.5:20" + good, "out of range");
  says("tua=0:0.03:20" + good, "did you mean 'tau'");
  says("body.mas=100:200:20" + good, "did you mean 'body.mass'");
  says("effects.actuator_lag.time_constant=0:0.01:20" + good, "no variable");
  says("body.mass=0:200:20" + good, "no rig has body.mass");
  says("effects.actuator_delay.delay=0:0.9:20" + good, "no rig has effects.actuator_delay.delay");
  says("tau=0:0.03:20", "is not a map");
  says("tau=0:0.03:20,tau=0:0.02:20", "one variable");
  says("machine.virtual_damping=0:10:20" + good, "one variable");
  says("tau=0:0.03:20" + good + good, "is not a map");
  const Axis axis = parse_axis("effects.actuator_delay.delay=0.001:0.02:5", rig, 1e-3);
  EXPECT_EQ(axis.count, 5U);
  EXPECT_EQ(axis.value(0), 0.001);
  EXPECT_EQ(axis.value(4), 0.02);
}

}  // namespace
