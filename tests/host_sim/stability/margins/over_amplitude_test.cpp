// Describing functions against their closed forms, and a predicted limit cycle against the model in time.
#include "host_sim/stability/margins/over_amplitude.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/description/text/input_error.hpp"
#include "model/rig/rig_model.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace over_amplitude_test {
namespace {

using host_sim::stability::equivalent_rig;
using host_sim::stability::over_amplitude;
using model::LawOver;
using model::LawPlace;
using stability_tests::Rig;

constexpr double pi = std::numbers::pi;
constexpr double amplitude = 0.012, omega = 60.0;  // [m], [rad/s]

// 720 points of a turn: the rule's error at a kink is (2π/720)²/12 of the force, 6e-6; smooth forces are exact.
constexpr double at_kinks = 2e-5;

// Law. Closed forms of Gelb and Vander Velde, Appendix B: dry friction 4F/(πAω), square 8cωA/(3π), cube ¾ k₃A².
TEST(OverAmplitude, HasTheClosedFormsOfEffects) {
  Rig rig = stability_tests::linear_rig();
  rig.effects.add(model::CoulombFriction<double>{30.0});
  rig.effects.add(model::QuadraticDamping<double>{500.0});
  rig.effects.add(model::ProgressiveSpring<double>{4e6});
  const auto found = equivalent_rig(rig, amplitude, omega);
  const double friction = 4.0 * 30.0 / (pi * amplitude * omega);
  const double square = 8.0 * 500.0 * omega * amplitude / (3.0 * pi);
  EXPECT_NEAR(found.suspension.damping / (friction + square), 1.0, at_kinks);
  EXPECT_NEAR(found.suspension.stiffness / (0.75 * 4e6 * amplitude * amplitude), 1.0, at_kinks);
  EXPECT_FALSE(found.rig.effects.get<model::CoulombFriction>().active);
  EXPECT_NEAR(found.rig.suspension.damping, rig.suspension.damping + found.suspension.damping, 1e-9);
}

// Law. Two slopes count with their mean, which is the damping described. Friction that has fallen to its sliding force
// counts with that. A Bouc–Wen element is its stiffness at small amplitudes, dry friction of F_h at large ones: half a
// turn loses 2 F_h A, less 3/2 F_h²/k while it unloads and F_h²/k while it builds up.
TEST(OverAmplitude, CountsLawsOfTheCatalogueWithShapesOfTheirOwn) {
  Rig damper = stability_tests::linear_rig(), friction = damper, hysteresis = damper;
  damper.effects.add(model::AsymmetricDamper<double>{120.0});
  const auto slopes = equivalent_rig(damper, amplitude, omega);
  EXPECT_NEAR(slopes.suspension.damping, 0.0, 60.0 * at_kinks);
  friction.effects.add(model::StribeckFriction<double>{30.0, 0.8, 1e-3});
  const auto slides = equivalent_rig(friction, amplitude, omega);
  EXPECT_NEAR(slides.suspension.damping / (4.0 * 30.0 / (pi * amplitude * omega)), 1.0, 2e-3);
  const double k = 50e3, f = 10.0;
  hysteresis.effects.add(model::BoucWen<double>{k, f, 0.0});
  EXPECT_NEAR(equivalent_rig(hysteresis, 1e-3 * f / k, omega).suspension.stiffness / k, 1.0, 2e-3);
  const auto yields = equivalent_rig(hysteresis, amplitude, omega).suspension;
  EXPECT_NEAR(yields.damping * omega / (4.0 * f / (pi * amplitude)), 1.0 - 1.25 * f / k / amplitude, 1e-4);
  EXPECT_FALSE(equivalent_rig(hysteresis, amplitude, omega).rig.effects.get<model::BoucWen>().active);
}

// Law. An elastic slider beyond its slip: with cos θ = 1 − 2 s/(k A) its loop has k_eq = k (θ − ½ sin 2θ)/π and
// ω c_eq = 4 s (1 − s/(k A))/(π A) (Jenkins element). Below its slip it is a spring. A Maxwell branch is linear.
TEST(OverAmplitude, HasTheClosedFormsOfBranches) {
  Rig rig = stability_tests::linear_rig();
  const double k = 10e3, s = 25.0;
  rig.laws.branches[0] = {.stiffness = k, .slip_force = s};
  rig.laws.branch_count = 1;
  const double theta = std::acos(1.0 - 2.0 * s / (k * amplitude));
  const auto slips = equivalent_rig(rig, amplitude, omega).suspension;
  EXPECT_NEAR(slips.stiffness / (k * (theta - 0.5 * std::sin(2.0 * theta)) / pi), 1.0, 1e-4);
  EXPECT_NEAR(slips.damping * omega / (4.0 * s * (1.0 - s / (k * amplitude)) / (pi * amplitude)), 1.0, 1e-4);
  const auto sticks = equivalent_rig(rig, 0.9 * s / k, omega).suspension;
  EXPECT_NEAR(sticks.stiffness / k, 1.0, 1e-9);
  EXPECT_NEAR(sticks.damping * omega / k, 0.0, 1e-9);

  // What a cycle takes, 4 s (A − s/k − g/2), is π ω c A²; inside its play it is nothing.
  const double gap = 0.4 * amplitude;
  rig.laws.branches[0] = {.stiffness = k, .slip_force = s, .gap = gap};
  const auto plays = equivalent_rig(rig, amplitude, omega).suspension;
  const double work = 4.0 * s * (amplitude - s / k - 0.5 * gap);
  EXPECT_NEAR(plays.damping * omega * pi * amplitude * amplitude / work, 1.0, 1e-4);
  EXPECT_EQ(equivalent_rig(rig, 0.4 * gap, omega).suspension.stiffness, 0.0);

  rig.laws.branches[0] = {.stiffness = k, .time_constant = 0.02};
  const std::complex<double> turns(0.0, omega * 0.02), exact = k * turns / (1.0 + turns);
  const auto relaxes = equivalent_rig(rig, amplitude, omega).suspension;
  EXPECT_NEAR(relaxes.stiffness, exact.real(), 1e-9 * k);
  EXPECT_NEAR(relaxes.damping * omega, exact.imag(), 1e-9 * k);
}

// Law. A straight curve is the parameter at every amplitude; at the tyre, too. A digressive one loses damping.
TEST(OverAmplitude, CurvesCountAtTheirOwnPlace) {
  Rig rig = stability_tests::linear_rig();
  rig.laws.curves[0] = {LawPlace::tyre, LawOver::velocity, {}, 2, {-1.0, 1.0}, {-70.0, 70.0}};
  rig.laws.curves[1] = {LawPlace::suspension, LawOver::velocity, {}, 5, {-1.0, -0.1, 0.0, 0.1, 1.0}, {}};
  rig.laws.curves[1].value = {-300.0, -200.0, 0.0, 200.0, 300.0};
  rig.laws.curve_count = 2;
  const auto small = equivalent_rig(rig, 1e-4, omega), large = equivalent_rig(rig, 0.012, omega);
  for (const auto& found : {small, large}) {
    EXPECT_NEAR(found.tyre.damping, 70.0, 1e-9);
    EXPECT_NEAR(found.tyre.stiffness, 0.0, 1e-9);
  }
  EXPECT_GT(small.suspension.damping, 1.5 * large.suspension.damping);
  EXPECT_EQ(large.rig.laws.curve_count, 0);
}

// Journey. A loop that is unstable at rest ends in the limit cycle that is predicted, where its damping has grown with
// the amplitude. Still larger oscillations grow again: damping that comes late drives. The first harmonic alone is a
// bound on the agreement: the third of a quadratic damper is a fifth of its first and passes the masses reduced by 9 at
// least, 2 % of the motion; the cycle's size is found within 5 %.
void expect_cycle(double sample_rate) {
  Rig rig = stability_tests::fdva_rig(0.0145);
  rig.fdva.minor_loss = 0.0;
  rig.effects.add(model::QuadraticDamping<double>{4000.0});
  const auto description = stability_tests::described(rig, sample_rate);
  const auto found = over_amplitude(description, 0.02);
  ASSERT_EQ(found.limit_cycles.size(), 2U);
  EXPECT_FALSE(found.limit_cycles[1].attracts);
  const auto& cycle = found.limit_cycles[0];
  EXPECT_TRUE(cycle.attracts);
  EXPECT_FALSE(found.rows.front().stable());
  EXPECT_NEAR(cycle.at.root.real(), 0.0, 1e-3);

  const model::RigModel<> model(rig, description.period());
  auto x = model.start();
  model::RigModel<>::Input in;
  double largest = 0.0;
  int crossings = 0;
  double before = 0.0;
  const int periods = static_cast<int>(60.0 * sample_rate);
  for (int i = 0; i < periods; ++i) {
    const double t = i * description.period();
    in.foot_point.position = t < 0.05 ? 1e-3 * std::sin(pi * t / 0.05) : 0.0;
    in.foot_point.velocity = t < 0.05 ? 1e-3 * pi / 0.05 * std::cos(pi * t / 0.05) : 0.0;
    model.step(x, in);
    if (i < periods / 6 * 5) continue;  // the last 10 s
    const double deflection = model.deflection(x).position;
    largest = std::max(largest, std::abs(deflection));
    crossings += before < 0.0 && deflection >= 0.0 ? 1 : 0;
    before = deflection;
  }
  EXPECT_NEAR(largest / cycle.at.amplitude, 1.0, 0.05) << cycle.at.amplitude;
  EXPECT_NEAR(crossings / 10.0, cycle.at.omega / (2.0 * pi), 0.15);  // whole turns in 10 s, and 1 % of the frequency
}
TEST(OverAmplitude, PredictsTheLimitCycle) { expect_cycle(16'000.0); }
// The same sampled at 1 kHz: the loop that runs holds the force for a period, half a step of delay, which belongs to
// the cycle.
TEST(OverAmplitude, PredictsTheLimitCycleOfTheLoopThatRuns) { expect_cycle(1000.0); }

// Point. Another kind of rig, and laws that leave no loop, are refused in one line.
TEST(OverAmplitude, RefusesWhatIsNoLoop) {
  Rig rig = stability_tests::linear_rig();
  rig.kind = model::RigKind::quarter_car;
  EXPECT_THROW(static_cast<void>(over_amplitude(stability_tests::described(rig), 0.01)), firmware::InputError);
}

}  // namespace
}  // namespace over_amplitude_test
