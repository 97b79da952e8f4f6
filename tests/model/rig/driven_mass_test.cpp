// A mass that a force drives: m ẍ + F_p = F.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "model/rig/rig_model.hpp"

namespace {

using model::Channel;
using model::RigKind;
using Rig = model::RigModel<>;

/// The Silverbox benchmark in newtons and metres (Wigren and Schoukens, 2013), sampled at its 610 Hz.
constexpr double mass = 0.5375, damping = 22.55, stiffness = 99.05e3, cubic = 3.94e9;
constexpr double rate = 610.35;

model::RigParameters<double> silverbox() {
  model::RigParameters<double> rig;
  rig.kind = RigKind::driven_mass;
  rig.body.mass = mass;
  rig.suspension.stiffness = stiffness;
  rig.suspension.damping = damping;
  return rig;
}

/// Three sines below, at and above the resonance of 68 Hz that begin at rest [N].
double force_at(double t) {
  double force = 0.0;
  for (const double f : {11.0, 61.0, 97.0}) {
    force += 40.0 * std::sin(2.0 * std::numbers::pi * f * t) * std::min(1.0, 20.0 * t * t);
  }
  return force;
}

double slope_of_force(double t) { return (force_at(t + 1e-6) - force_at(t - 1e-6)) / 2e-6; }

struct Samples {
  std::vector<double> position, acceleration;
};

Samples by_model(const model::RigParameters<double>& parameters, double period, double seconds) {
  const Rig rig(parameters, period);
  auto x = rig.start(model::Column<double, 6>::Zero(), {force_at(0.0), slope_of_force(0.0), 0.0}, {});
  Samples samples;
  for (int k = 0; k * period < seconds; ++k) {
    if (k > 0) rig.step(x, {.foot_point = {force_at(k * period), slope_of_force(k * period), 0.0}});
    const auto signals = rig.signals(x);
    samples.position.push_back(signals[index(Channel::x_act)]);
    samples.acceleration.push_back(signals[index(Channel::zdd_b)]);
    EXPECT_EQ(signals[index(Channel::F)], force_at(k * period));
  }
  return samples;
}

/// The equation of motion by a classical Runge–Kutta method in steps of 1/50 of a period; nothing of it is the model's.
Samples by_runge_kutta(double k3, double period, double seconds) {
  struct Motion {
    double x, v;
  };
  const auto acceleration = [k3](double t, const Motion& m) {
    return (force_at(t) - damping * m.v - stiffness * m.x - k3 * m.x * m.x * m.x) / mass;
  };
  constexpr int substeps = 50;
  const double h = period / substeps;
  Motion m{0.0, 0.0};
  Samples samples;
  for (int k = 0; k * period < seconds; ++k) {
    samples.position.push_back(m.x);
    samples.acceleration.push_back(acceleration(k * period, m));
    for (int i = 0; i < substeps; ++i) {
      const double t = k * period + i * h;
      const Motion k1{m.v, acceleration(t, m)};
      const Motion m2{m.x + 0.5 * h * k1.x, m.v + 0.5 * h * k1.v};
      const Motion k2{m2.v, acceleration(t + 0.5 * h, m2)};
      const Motion m3{m.x + 0.5 * h * k2.x, m.v + 0.5 * h * k2.v};
      const Motion k3rd{m3.v, acceleration(t + 0.5 * h, m3)};
      const Motion m4{m.x + h * k3rd.x, m.v + h * k3rd.v};
      const Motion k4{m4.v, acceleration(t + h, m4)};
      m.x += h / 6.0 * (k1.x + 2.0 * k2.x + 2.0 * k3rd.x + k4.x);
      m.v += h / 6.0 * (k1.v + 2.0 * k2.v + 2.0 * k3rd.v + k4.v);
    }
  }
  return samples;
}

double error_of(const std::vector<double>& values, const std::vector<double>& truth) {
  double squares = 0.0, all = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    squares += (values[k] - truth[k]) * (values[k] - truth[k]);
    all += truth[k] * truth[k];
  }
  return std::sqrt(squares / all);
}

// Point. The linear part is exact and the force a cubic between samples: its error is (ω h)⁴/384 = 3e-3 of the highest
// sine at the rate of the benchmark and a sixteenth of that at twice the rate, here with the weaker sines below it.
TEST(DrivenMass, LinearFollowsItsEquationOfMotion) {
  for (const double times : {1.0, 2.0}) {
    const double period = 1.0 / (times * rate), allowed = 3e-3 / std::pow(times, 4.0);
    const Samples model = by_model(silverbox(), period, 0.5), truth = by_runge_kutta(0.0, period, 0.5);
    EXPECT_LT(error_of(model.position, truth.position), allowed);
    EXPECT_LT(error_of(model.acceleration, truth.acceleration), allowed);
  }
}

// Order. The cubic spring is an explicit law of third order: half the period leaves an eighth of the error, here at
// least a fifth. It is a tenth of the force, so that at four times the benchmark's rate less than 1 % is left.
TEST(DrivenMass, CubicSpringConvergesWithThirdOrder) {
  auto rig = silverbox();
  rig.effects.add(model::ProgressiveSpring<double>{cubic});
  std::vector<double> errors;
  for (const double times : {4.0, 8.0}) {
    const double period = 1.0 / (times * rate);
    const Samples truth = by_runge_kutta(cubic, period, 0.5);
    errors.push_back(error_of(by_model(rig, period, 0.5).position, truth.position));
    EXPECT_GT(error_of(by_model(silverbox(), period, 0.5).position, truth.position), 0.02) << "the spring matters";
  }
  EXPECT_LT(errors[0], 0.01);
  EXPECT_LT(errors[1], errors[0] / 5.0);
}

// Law. A mass that dry friction holds stays, and moves as soon as the force is larger than friction and spring. Friction
// takes the velocity at the end of a step: what the force moves in the first one, less than F h²/m, is left, and nothing
// creeps after it.
TEST(DrivenMass, FrictionHoldsTheMass) {
  auto parameters = silverbox();
  parameters.effects.add(model::CoulombFriction<double>{50.0});
  constexpr double h = 1e-3;
  const Rig rig(parameters, h);
  for (const double force : {49.0, 60.0}) {
    auto x = rig.start();
    double soon = 0.0;
    for (int k = 0; k < 2000; ++k) {
      rig.step(x, {.foot_point = {force, 0.0, 0.0}});
      if (k == 10) soon = rig.signals(x)[index(Channel::x_act)];
    }
    const double reached = rig.signals(x)[index(Channel::x_act)];
    if (force < 50.0) {
      EXPECT_LT(std::abs(reached), force * h * h / mass);
      EXPECT_NEAR(reached, soon, 1e-12);
    } else {  // it stops where spring and friction bear the force, or on its swing back with friction against it
      EXPECT_GT(reached, 0.99 * (force - 50.0) / stiffness);
      EXPECT_LT(reached, (force + 50.0) / stiffness);
    }
  }
}

// Fault. A rig without its mass, with a machine, or with a wheel is none.
TEST(DrivenMass, RefusesWhatItHasNot) {
  const auto fault_of = [](const model::RigParameters<double>& rig) { return model::find_fault(rig, 1e-3, 100); };
  EXPECT_FALSE(fault_of(silverbox()));
  auto rig = silverbox();
  rig.body.mass = 0.0;
  ASSERT_TRUE(fault_of(rig));
  EXPECT_EQ(fault_of(rig)->table, "body");
  rig = silverbox();
  rig.wheel.mass = 40.0;
  ASSERT_TRUE(fault_of(rig));
  EXPECT_EQ(fault_of(rig)->table, "wheel");
  rig = silverbox();
  rig.effects.add(model::ActuatorDelay<double>{0.01});
  ASSERT_TRUE(fault_of(rig));
  EXPECT_EQ(fault_of(rig)->table, "actuator_delay");
}

}  // namespace
