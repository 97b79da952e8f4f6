// Every number of the physics document's section 6 that a linear delay system has.
#include <gtest/gtest.h>

#include <numbers>

#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using namespace host_sim::stability;
using stability_tests::described;
using stability_tests::fdva_rig;
using stability_tests::linear_rig;

/// Half a unit of the last published digit.
constexpr double four_digits = 0.5e-4 * 1.0001, three_digits = 0.5e-3 * 1.0001;

/// The root nearest to `expected`.
Complex near(const StabilityAnalysis& analysis, Complex expected) {
  Complex best = analysis.roots.roots.front();
  for (const Complex s : analysis.roots.roots) {
    if (std::abs(s - expected) < std::abs(best - expected)) best = s;
  }
  return best;
}

void expect_root(const StabilityAnalysis& analysis, double re, double im, double digits) {
  const Complex s = near(analysis, {re, im});
  EXPECT_NEAR(s.real(), re, digits);
  EXPECT_NEAR(s.imag(), im, digits);
}

// Golden. The three rows of poles of the linear component.
TEST(StabilityReference, PolesOfTheLinearComponent) {
  const StabilityAnalysis ideal = analyse(described(linear_rig(0.0)));
  expect_root(ideal, -15.988, 73.898, three_digits);
  expect_root(ideal, -1.477, 9.635, three_digits);
  const StabilityAnalysis late = analyse(described(linear_rig(0.010)));
  expect_root(late, -9.3847, 87.3599, four_digits);
  expect_root(late, -1.0753, 9.7797, four_digits);
  const StabilityAnalysis damped = analyse(described(linear_rig(0.010, 700.0)));
  expect_root(damped, -22.3409, 86.8166, four_digits);
  expect_root(damped, -2.0253, 9.7354, four_digits);
  for (const auto* analysis : {&ideal, &late, &damped}) {
    EXPECT_TRUE(analysis->stable);
    EXPECT_EQ(analysis->roots.count, 4);
    EXPECT_LT(analysis->roots.worst_residual, 100.0);
  }
}

// Golden. The critical delays, and what Padé approximations make of them: order 1 is 18 % off, on the unsafe side.
TEST(StabilityReference, CriticalDelaysExactAndAfterPade) {
  const StabilityAnalysis a = analyse(described(linear_rig(0.010)));
  ASSERT_TRUE(a.margins.critical_delay);
  EXPECT_NEAR(*a.margins.critical_delay, 15.2536e-3, 0.5e-7);
  EXPECT_NEAR(a.margins.critical_omega / (2.0 * std::numbers::pi), 14.01, 0.005);
  EXPECT_NEAR(*a.margins.delay_margin, 5.2536e-3, 0.5e-7);
  ASSERT_EQ(a.pade.size(), 5U);
  EXPECT_NEAR(*a.pade[0].critical_delay, 18.05e-3, 0.5e-5);
  EXPECT_NEAR(*a.pade[1].critical_delay, 15.316e-3, 0.5e-6);
  EXPECT_NEAR(*a.pade[2].critical_delay, 15.2544e-3, 0.5e-7);
  EXPECT_NEAR(*a.pade[0].error, 0.18, 0.005);
  for (const PadeResult& pade : a.pade) EXPECT_TRUE(pade.unsafe) << "order " << pade.order;

  const StabilityAnalysis damped = analyse(described(linear_rig(0.010, 700.0)));
  EXPECT_NEAR(*damped.margins.critical_delay, 23.646e-3, 0.5e-6);
}

// Golden. Without b_b it is the body mode that goes first, at 9.62 ms.
TEST(StabilityReference, BodyModeWithoutComponentDamping) {
  auto rig = linear_rig(0.005, 300.0);
  rig.suspension.damping = 0.0;
  const StabilityAnalysis a = analyse(described(rig));
  EXPECT_NEAR(*a.margins.critical_delay, 9.62e-3, 0.5e-5);
  EXPECT_LT(a.margins.critical_omega / (2.0 * std::numbers::pi), 2.0);  // 1.5 Hz, the wheel's is 14 Hz
}

// Golden. The FDVA explains what the paper saw: stable at 1140, unstable at 700, the border at 908.04 N s/m.
TEST(StabilityReference, FdvaGoesUnstableBetween700And1140) {
  const StabilityAnalysis stable = analyse(described(fdva_rig(0.010, 1140.0)));
  expect_root(stable, -2.3945, 83.902, three_digits);
  EXPECT_TRUE(stable.stable);
  const StabilityAnalysis unstable = analyse(described(fdva_rig(0.010, 700.0)));
  expect_root(unstable, 2.1685, 84.375, three_digits);
  EXPECT_FALSE(unstable.stable);
  for (const auto* analysis : {&stable, &unstable}) {
    ASSERT_TRUE(analysis->critical_damping);
    EXPECT_NEAR(analysis->critical_damping->value, 908.04, 0.005);
  }
  // On the axis indeed: the published figure has five digits, and Re changes by about 1e-2 1/s for each N s/m.
  const StabilityAnalysis border = analyse(described(fdva_rig(0.010, stable.critical_damping->value)));
  EXPECT_NEAR(border.roots.rightmost().real(), 0.0, 1e-9);
}

// Golden. The wheel load's highest response with delay over that without: "more than 400 %".
TEST(StabilityReference, PeakOfTheWheelLoadGrows473Times) {
  const LinearRig rig = linearise(fdva_rig());
  const Peak late = peak(RoadResponse(rig, 0.010, 0.010), model::Channel::F_w, 0.1, 100.0);
  const Peak ideal = peak(RoadResponse(rig, 0.0, 0.0), model::Channel::F_w, 0.1, 100.0);
  EXPECT_NEAR(late.magnitude / ideal.magnitude, 4.73, 0.005);
  EXPECT_NEAR(late.frequency_hz, 13.4, 0.1);
}

}  // namespace
