// Where a rig is cut, and delays that vary.
#include "host_sim/stability/margins/interface_location.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "host_sim/stability/margins/varying_delay.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using host_sim::stability::border_of;
using host_sim::stability::Complex;
using host_sim::stability::InterfaceLocation;
using host_sim::stability::linearise;
using host_sim::stability::located_loop;
using host_sim::stability::varying_delay;

/// The paper's linear component without virtual damping.
model::RigParameters<double> paper() {
  model::RigParameters<double> rig = stability_tests::linear_rig();
  rig.machine.virtual_damping = 0.0;
  rig.effects = {};
  return rig;
}

// Golden. The component alone is the loop of the other margins: 15.2536 ms.
TEST(InterfaceLocation, OfTheComponentIsTheUsualLoop) {
  const auto border = border_of(located_loop(paper(), InterfaceLocation::component));
  ASSERT_TRUE(border.critical_delay);
  EXPECT_NEAR(*border.critical_delay, 15.2536e-3, 1e-7);
}

// Law. On the border the equations of motion of body and wheel, written here as a matrix with each late interface, have
// a solution: their determinant vanishes against the product of its rows' sizes.
TEST(InterfaceLocation, BordersSolveTheEquationsOfMotion) {
  const auto rig = paper();
  const double m_b = rig.body.mass, m_w = rig.wheel.mass;
  for (const InterfaceLocation location : {InterfaceLocation::component_and_wheel, InterfaceLocation::below_body}) {
    const auto border = border_of(located_loop(rig, location));
    ASSERT_TRUE(border.stable_undelayed && border.critical_delay);
    const Complex s(0.0, border.omega), late = std::exp(-s * *border.critical_delay);
    const Complex k = rig.suspension.stiffness + rig.suspension.damping * s;
    const Complex z = rig.tyre.stiffness + rig.tyre.damping * s;
    // unknowns z_b, z_w; hardware sees late·z_b; with the tyre in the program its force is late, too
    const Complex tyre = location == InterfaceLocation::below_body ? z : late * z;
    Eigen::Matrix2cd motion;
    motion << m_b * s * s + k * late, -k, -k * late, m_w * s * s + k + tyre;
    EXPECT_LT(std::abs(motion.determinant()) / (motion.row(0).norm() * motion.row(1).norm()), 1e-8)
        << host_sim::stability::interface_names[static_cast<std::size_t>(location)];
  }
}

// Law. A softer component bears more delay at every cut where the component is what is late.
TEST(InterfaceLocation, OfASofterComponentBearsMoreDelay) {
  for (const InterfaceLocation location : {InterfaceLocation::component, InterfaceLocation::below_body}) {
    const auto soft = border_of(located_loop(paper(), location, 0.5)),
               stiff = border_of(located_loop(paper(), location, 2.0));
    EXPECT_GT(*soft.critical_delay, *stiff.critical_delay);
  }
}

// Golden. Between 8 and 12 ms every constant delay is stable, the worst is the longest; beyond 15.2536 ms it is not.
TEST(VaryingDelay, FindsTheWorstOfItsRange) {
  const auto rig = linearise(paper());
  const auto equation = rig.equation(0.010);
  const auto margins = host_sim::stability::margins(equation, true);
  const auto inside = varying_delay(equation, margins, 0.008, 0.012);
  EXPECT_TRUE(inside.stable);
  EXPECT_EQ(inside.worst_delay, 0.012);
  EXPECT_LT(inside.worst_root.real(), 0.0);
  const auto across = varying_delay(equation, margins, 0.008, 0.016);
  EXPECT_FALSE(across.stable);
  EXPECT_GT(across.worst_root.real(), 0.0);
  // What is proven at any speed cannot reach beyond the border of constant delays.
  ASSERT_TRUE(inside.at_any_speed);
  EXPECT_GT(*inside.at_any_speed, 0.0);
  EXPECT_LT(0.008 + *inside.at_any_speed, 15.2536e-3);
  EXPECT_TRUE(inside.stable_at_any_speed());
  EXPECT_FALSE(across.stable_at_any_speed());
}

/// In the paper's loop, without its delay.
model::RigParameters<double> on_air(double skyhook) { return stability_tests::air_spring_rig(0.0, 1140.0, skyhook); }

// Law. The component's response is that of spring and Maxwell branch, k − k_r/(1 + sT).
TEST(AirSpringInTheLoop, IsASpringWithAMaxwellBranch) {
  const auto rig = on_air(0.0);
  const auto [numerator, denominator] = linearise(rig).component_response();
  const double k = model::AirSpring<double>::stiffness(rig.air_spring, 1.4);
  const double branch = model::AirSpring<double>::heat_stiffness(rig.air_spring, 1.4);
  for (const double omega : {0.1, 0.5, 10.0}) {
    const Complex s(0.0, omega);
    EXPECT_LT(std::abs(numerator(s) / denominator(s) / (k - branch / (1.0 + 2.0 * s)) - 1.0), 1e-9);
  }
}

// Point. A skyhook adds c_sky ω/(s + ω) s z_b to the body's equation: characteristic polynomial by hand, no delay.
TEST(AirSpringInTheLoop, HasItsSkyhookInTheBodysEquation) {
  const auto rig = on_air(2000.0);
  const auto linear = linearise(rig);
  const double k = model::AirSpring<double>::stiffness(rig.air_spring, 1.4);
  const double branch = model::AirSpring<double>::heat_stiffness(rig.air_spring, 1.4), omega = 31.41592653589793;
  const auto equation = [&](Complex s) {
    const Complex spring = k - branch / (1.0 + 2.0 * s) + 1140.0 * s, tyre = 200e3 + 100.0 * s;
    const Complex sky = 2000.0 * s * omega / (s + omega);
    // sky acts between wheel and body, by the body's velocity
    return (290.0 * s * s + spring + sky) * (40.0 * s * s + tyre + spring) - spring * (spring + sky);
  };
  const Complex s(-0.3, 12.0), other(0.7, 80.0);
  const auto loop = [&](Complex at) { return linear.p(at) + linear.q(at); };
  const auto scale = [&](Complex at) { return (1.0 + 2.0 * at) * (at + omega) / 2.0 / (290.0 * 40.0); };
  EXPECT_LT(std::abs(loop(s) / (equation(s) * scale(s)) - 1.0), 1e-9);
  EXPECT_LT(std::abs(loop(other) / (equation(other) * scale(other)) - 1.0), 1e-9);
}

// Law. A lever of one ratio i is a component of i² times the force; a ratio that changes adds the spring F₀ di/dd.
TEST(LeverInTheLoop, ScalesTheComponent) {
  auto lever = paper(), scaled = paper();
  lever.lever.count = 2;
  lever.lever.at = {-0.1, 0.1};
  lever.lever.ratio = {0.8, 0.8};
  scaled.suspension.stiffness *= 0.64;
  scaled.suspension.damping *= 0.64;
  const Complex s(0.0, 30.0);
  const auto a = linearise(lever), b = linearise(scaled);
  EXPECT_LT(std::abs((a.p(s) + a.q(s)) / (b.p(s) + b.q(s)) - 1.0), 1e-9);
  lever.lever.ratio = {0.7, 0.9};
  const auto c = linearise(lever);
  EXPECT_GT(std::abs((c.p(s) + c.q(s)) / (b.p(s) + b.q(s)) - 1.0), 1e-3);
}

}  // namespace
