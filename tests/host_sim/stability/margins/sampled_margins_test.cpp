// What is said of the sampled loop, against the sampled loop that has what is said.
#include "host_sim/stability/margins/sampled_margins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "host_sim/stability/margins/analysis.hpp"
#include "host_sim/stability/report/verdict.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace sampled_margins_test {
namespace {

using host_sim::stability::analyse;
using host_sim::stability::LoopResponse;
using host_sim::stability::sampled_part;
using host_sim::stability::spectral_radius;
using host_sim::stability::StabilityAnalysis;
using host_sim::stability::step_matrix;
using model::Channel;
using stability_tests::described;
using stability_tests::Rig;

constexpr double period = 1e-3;

double radius(const Rig& rig, double delay) { return spectral_radius(step_matrix(sampled_part(rig), period, delay)); }

// Law. On each border that is said an eigenvalue of the step with that gain of F, that virtual damping or that delay
// lies on the unit circle. 1e-6: the gain is bisected to the rounding of a determinant, whose slope is 1e-3 per unit.
TEST(SampledMargins, BordersAreThoseOfTheStep) {
  const Rig rig = stability_tests::fdva_rig();
  const StabilityAnalysis a = analyse(described(rig));
  ASSERT_TRUE(a.sampled && a.sampled_margins && a.sampled_damping && a.delay_left);
  Rig louder = rig;
  louder.effects.add(Channel::F, model::SensorGain<double>{a.sampled_margins->upper_gain->factor});
  EXPECT_NEAR(radius(louder, 0.010), 1.0, 1e-6);
  Rig damped = rig;
  damped.machine.virtual_damping = a.sampled_damping->value;
  EXPECT_NEAR(radius(damped, 0.010), 1.0, 1e-8);
  EXPECT_NEAR(radius(rig, 0.010 + *a.delay_left), 1.0, 1e-8);
  // Sampling and hold take from each of them.
  EXPECT_LT(*a.delay_left, *a.margins.delay_margin);
  EXPECT_LT(a.sampled_margins->upper_gain->factor, a.margins.upper_gain->factor);
  EXPECT_LT(*a.sampled_margins->phase_margin, *a.margins.phase_margin);
  EXPECT_GT(a.sampled_margins->sensitivity.value, a.sensitivity.value);
  EXPECT_GT(a.sampled_damping->value, a.critical_damping->value);
}

// Law. Far below the sample rate the sampled loop is the continuous one with half a step more delay. The next term of
// the hold is (ωT)²/24, and the step's inputs are of third order: 1e-4 at 13 Hz.
TEST(SampledMargins, ResponseIsThatOfTheDelayedLoop) {
  const Rig rig = stability_tests::linear_rig(0.010, 700.0);
  const LoopResponse loop(step_matrix(sampled_part(rig), period, 0.010), period);
  const auto late = host_sim::stability::linearise(rig).equation(0.010 + 0.5 * period);
  for (const double omega : {5.0, 20.0, 60.0, 90.0}) {
    const std::complex<double> s(0.0, omega), expected = late.q()(s) / late.p()(s) * late.delayed(s);
    EXPECT_LT(std::abs(loop(omega) - expected), 2e-3 * std::abs(expected)) << omega;
  }
}

// Law. A lever whose ratio has one slope below its rest and another above has no slope there. Both sides are analysed,
// each as a lever of that slope throughout, the worse decides, and both are said.
TEST(SidesOfRest, OfALeverWithAKinkBothAreSaidAndTheWorseDecides) {
  const auto with_lever = [](double below, double above) {
    Rig rig = stability_tests::air_spring_rig(0.010, 1140.0, 0.0);
    rig.air_spring.pressure /= 0.8;
    rig.lever.count = 3;
    rig.lever.at = {-0.08, 0.0, 0.08};
    rig.lever.ratio = {0.8 - 0.08 * below, 0.8, 0.8 + 0.08 * above};
    return rig;
  };
  const StabilityAnalysis kink = analyse(described(with_lever(0.5, 2.0)));
  const StabilityAnalysis below = analyse(described(with_lever(0.5, 0.5)));
  const StabilityAnalysis above = analyse(described(with_lever(2.0, 2.0)));
  ASSERT_EQ(kink.sides.size(), 2U);
  EXPECT_TRUE(below.sides.empty());
  ASSERT_TRUE(below.delay_left && above.delay_left && kink.delay_left);
  EXPECT_NEAR(*kink.sides[0].delay_left, *below.delay_left, 1e-7);
  EXPECT_NEAR(*kink.sides[1].delay_left, *above.delay_left, 1e-7);
  EXPECT_NEAR(*kink.delay_left, std::min(*below.delay_left, *above.delay_left), 1e-7);
  const std::string said = verdict(kink);
  EXPECT_NE(said.find("dz_b below rest: stable"), std::string::npos) << said;
  EXPECT_NE(said.find("dz_b above rest: stable"), std::string::npos) << said;
}

// Law. A damper of two slopes rests on their corner.
TEST(SidesOfRest, OfADamperOfTwoSlopesTheSofterSideDecides) {
  Rig rig = stability_tests::linear_rig(0.010, 0.0);
  rig.effects.add(model::AsymmetricDamper<double>{800.0});
  const StabilityAnalysis a = analyse(described(rig));
  ASSERT_EQ(a.sides.size(), 2U);
  Rig softer = stability_tests::linear_rig(0.010, 0.0);
  softer.suspension.damping = 740.0;
  EXPECT_EQ(*a.delay_left, *analyse(described(softer)).delay_left);
}

}  // namespace
}  // namespace sampled_margins_test
