#include "model/rig/rig_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/reference_parameters.hpp"
#include "tests/support/reference_road.hpp"
#include "tests/support/without_heap.hpp"

namespace {

using model::Channel;
using model::CoreIndex;
using model::ModelledPart;
using model::Motion;
using model::RigKind;
using model::Signals;
using model::Stroke;
using Rig = model::RigModel<>;
using Parameters = model::RigParameters<double>;

constexpr double period = 1e-3;

double at(const Signals<double>& s, Channel channel) { return s[index(channel)]; }

/// Everything nonlinear of the first four effects, machine late by 10.3 ms.
Parameters everything(RigKind kind) {
  auto rig = support::fdva_rig(kind);
  rig.suspension.damping = 50.0;
  rig.effects.add(model::CoulombFriction<double>{30.0});
  if (kind != RigKind::component_bench) rig.effects.add(model::TyreLiftOff<double>{});
  if (kind == RigKind::quarter_car) {
    rig.effects.add(model::ForceSensorInertia<double>{5.0});
  } else {
    rig.effects.add(model::ActuatorDelay<double>{0.0103});
  }
  return rig;
}

constexpr RigKind kinds[] = {RigKind::quarter_car, RigKind::hil, RigKind::component_bench};

Rig::Input input_of(const Motion<double>& road) {
  Rig::Input in;
  in.foot_point = road;
  in.command = {road.position, road.velocity};
  return in;
}

// Law. The firmware computes the car, the rig the component: force received → car → deflection → machine. Together they
// are the closed rig, to the bit, so that one measurement can be replayed through either. The car that a controller
// carries, without the code and the memory of a whole rig, is that car.
TEST(RigModel, SplitsIntoCarAndMachineWithoutChangingABit) {
  for (const bool with_effects : {false, true}) {
    auto rig = with_effects ? everything(RigKind::hil) : support::fdva_rig(RigKind::hil);
    const Rig whole(rig, period), car(rig, period, ModelledPart::virtual_car),
        machine(rig, period, ModelledPart::test_machine);
    const model::VirtualCar<> alone(rig, period);
    auto x = whole.start(), c = car.start(), m = machine.start();
    auto a = alone.start();
    const auto road = support::random_road(256e-6, period, 5.0, 61);
    for (std::size_t k = 0; k < road.size(); ++k) {
      alone.receive_force(a, machine.measured(m)[index(Channel::F)]);
      alone.step(a, {.foot_point = road[k]});
      whole.step(x, input_of(road[k]));
      car.receive_force(c, machine.measured(m)[index(Channel::F)]);
      car.step(c, input_of(road[k]));
      Rig::Input command;
      command.command = car.deflection(c);
      machine.step(m, command);
      car.receive_force(c, machine.measured(m)[index(Channel::F)]);
      const auto closed = whole.measured(x), of_car = car.measured(c), of_machine = machine.measured(m);
      for (const Channel channel : {Channel::z_r, Channel::z_w, Channel::z_b, Channel::zdd_w, Channel::zdd_b,
                                    Channel::F_w, Channel::dz_b, Channel::x_cmd, Channel::F}) {
        ASSERT_EQ(at(closed, channel), at(of_car, channel)) << name(channel) << ", sample " << k << ", seed 61";
      }
      for (const Channel channel : {Channel::x_cmd, Channel::x_act, Channel::F}) {
        ASSERT_EQ(at(closed, channel), at(of_machine, channel)) << name(channel) << ", sample " << k << ", seed 61";
      }
      alone.receive_force(a, c.received_force);
      ASSERT_EQ(alone.signals(a), car.signals(c)) << "sample " << k << ", seed 61";
      ASSERT_EQ(alone.energy(a), car.energy(c)) << "sample " << k << ", seed 61";
    }
  }
}

// Memory. What a controller carries is small: a delay line alone has 8 KiB, a rig's matrices 33. Room for laws from
// tables is 40 KiB (8 curves of 33 points, a surface, 8 branches, as tables and as polynomials); a board that has no
// laws leaves it out.
using BareCar = model::RigModel<double, model::usual_delay_capacity, model::ModelVariant::virtual_car, model::no_laws>;
static_assert(sizeof(BareCar) + sizeof(BareCar::State) < 4096);
static_assert(sizeof(model::VirtualCar<>) + sizeof(model::VirtualCar<>::State) < 4096 + 40 * 1024);
static_assert(sizeof(Rig) + sizeof(Rig::State) > 40960);

// Law. A rig at rest stays at rest, on any level and with any deflection in its machine. (Not a hil rig with dry
// friction: its sharp law takes the sign of a velocity that is rounding, and the sampled loop answers with a small
// limit cycle.)
TEST(RigModel, StaysAtRest) {
  for (const RigKind kind : kinds) {
    auto rig = everything(kind);
    if (kind == RigKind::hil) rig.effects.get<model::CoulombFriction>().active = false;
    const Rig model(rig, period);
    auto x = model.start(kind == RigKind::component_bench ? 0.0 : 0.25, 0.03);
    const auto before = model.signals(x);
    Rig::Input in;
    in.foot_point.position = 0.25;
    in.command.position = 0.03;
    for (int k = 0; k < 1000; ++k) model.step(x, in);
    const auto after = model.signals(x);
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      // the level enters by 1 − (1 − …): rounding of k_t z_r = 5e4 N and its like
      EXPECT_NEAR(after[c], before[c], 1e-8 * std::fmax(1.0, std::fabs(before[c])))
          << name(kind) << " " << name(model::channel_at(c));
    }
  }
}

/// All signals of a linear rig under an input, one after the other.
std::vector<double> response(const Rig& model, const std::vector<Motion<double>>& road, double factor) {
  auto x = model.start();
  std::vector<double> all;
  for (const auto& m : road) {
    Rig::Input in = input_of({factor * m.position, factor * m.velocity, factor * m.acceleration});
    in.actuator_force = model.parameters().kind == RigKind::quarter_car ? factor * 1e4 * m.velocity : 0.0;
    model.step(x, in);
    for (const double s : model.signals(x)) all.push_back(s);
  }
  return all;
}

// Law. Without nonlinear effects and minor losses a rig is linear: twice the input is twice the output to the bit
// (powers of two do not round), and the answer to a sum is the sum of the answers within rounding.
TEST(RigModel, IsLinearWithoutNonlinearEffects) {
  for (const RigKind kind : kinds) {
    auto rig = support::fdva_rig(kind);
    rig.fdva.minor_loss = 0.0;
    if (kind != RigKind::quarter_car) rig.effects.add(model::ActuatorDelay<double>{0.0047});
    const Rig model(rig, period);
    const auto a = support::random_road(64e-6, period, 2.0, 62), b = support::random_road(64e-6, period, 2.0, 63);
    std::vector<Motion<double>> sum(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      sum[k] = {a[k].position + b[k].position, a[k].velocity + b[k].velocity, a[k].acceleration + b[k].acceleration};
    }
    const auto of_a = response(model, a, 1.0), of_b = response(model, b, 1.0), of_sum = response(model, sum, 1.0),
               of_double = response(model, a, 2.0);
    for (std::size_t i = 0; i < of_a.size(); ++i) {
      EXPECT_EQ(of_double[i], 2.0 * of_a[i]) << name(kind) << ", seed 62";
      // accelerations come from forces of some 1e4 N over 40 kg, rounded a few hundred times
      EXPECT_NEAR(of_sum[i], of_a[i] + of_b[i], 1e-9) << name(kind) << ", seeds 62, 63";
    }
  }
}

// Law. Minor losses, lift-off and friction know no direction but their own: the mirrored road gives the mirrored answer
// to the bit, except where the tyre may push but not pull.
TEST(RigModel, IsSymmetricUpAndDown) {
  for (const RigKind kind : kinds) {
    auto rig = support::fdva_rig(kind);
    rig.effects.add(model::CoulombFriction<double>{30.0});
    const Rig model(rig, period);
    const auto road = support::random_road(256e-6, period, 3.0, 64);
    const auto up = response(model, road, 1.0), down = response(model, road, -1.0);
    for (std::size_t i = 0; i < up.size(); ++i) ASSERT_EQ(up[i], -down[i]) << name(kind) << ", seed 64";
  }
}

// Law. After start no step, no switching of ducts, no change of delay and no reading touches the heap.
TEST(RigModel, NeverTouchesTheHeap) {
  for (const RigKind kind : kinds) {
    const Rig model(everything(kind), period);
    const auto road = support::random_road(1024e-6, period, 1.0, 65);
    auto x = model.start();
    double sum = 0.0;
    support::without_heap([&] {
      for (std::size_t k = 0; k < road.size(); ++k) {
        if (k % 100 == 7) model.open_ducts(x, static_cast<model::OpenDucts>(k % 64));
        if (k == 500 && kind != RigKind::quarter_car) model.set_delay(x, 0.005);
        model.step(x, input_of(road[k]));
        sum += model.measured(x)[index(Channel::F_w)] + model.energy(x);
      }
    });
    EXPECT_EQ(sum, sum);
  }
}

// Law. What dies away ends at zero and never passes through denormal numbers, which cost a hundred times: left alone
// for an hour after a shake, at every moment every signal is zero or normal, and in the end all are zero.
TEST(RigModel, DiesAwayToZeroWithoutDenormalNumbers) {
  for (const RigKind kind : kinds) {
    auto rig = support::fdva_rig(kind);
    if (kind == RigKind::hil) rig.effects.add(model::ActuatorDelay<double>{0.010});
    const Rig model(rig, period);
    auto x = model.start();
    for (const auto& m : support::random_road(64e-6, period, 2.0, 66)) model.step(x, input_of(m));
    int denormal = 0;
    for (int k = 0; k < 3'600'000; ++k) {
      model.step(x, {});
      for (int i = 0; i < 6; ++i) denormal += std::fpclassify(x.core(i)) == FP_SUBNORMAL ? 1 : 0;
      for (const double load : {x.received_force, x.reached.position, x.reached.velocity, x.ducts.losses().now,
                                x.ducts.losses().earliest}) {
        denormal += std::fpclassify(load) == FP_SUBNORMAL ? 1 : 0;
      }
    }
    EXPECT_EQ(denormal, 0) << name(kind) << ", seed 66";
    for (int i = 0; i < 4; ++i) EXPECT_EQ(x.core(i), 0.0) << name(kind) << ", seed 66";
  }
}

// Law. Unconditionally stable in its linear part: steps of a second and a component a million times stiffer, and the
// car on a resting road ends where it must.
TEST(RigModel, IsStableForAnyStepAndStiffness) {
  for (const double factor : {1.0, 1e6}) {
    for (const double h : {1e-3, 0.01, 1.0}) {
      auto rig = support::fdva_rig(RigKind::quarter_car);
      rig.suspension = {31500.0 * factor, 1140.0 * factor};
      rig.fdva.minor_loss = 0.0;
      const Rig model(rig, h);
      auto x = model.start();
      Rig::Input in;
      in.foot_point.position = 0.1;
      for (int k = 0; k < static_cast<int>(100.0 / h); ++k) model.step(x, in);
      EXPECT_NEAR(x.core(CoreIndex::wheel_position), 0.1, 1e-8) << "step " << h << ", stiffness × " << factor;
      EXPECT_NEAR(x.core(CoreIndex::body_position), 0.1, 1e-8) << "step " << h << ", stiffness × " << factor;
    }
  }
}

// Order. The linear part is exact for any step: 1, 10 and 100 ms on the same cubic motion of the foot point (a cubic is
// its own Hermite polynomial) end at the same place. Rounding of some thousand steps: 1e-12.
TEST(RigModel, TakesLinearPartsExactlyWhateverTheStep) {
  auto rig = support::fdva_rig(RigKind::quarter_car);
  rig.fdva.minor_loss = 0.0;
  const auto end = [&rig](double h) {
    const Rig model(rig, h);
    auto x = model.start();
    const auto steps = static_cast<int>(std::lround(2.0 / h));
    for (int k = 1; k <= steps; ++k) {
      const double t = 2.0 * k / steps;
      Rig::Input in;
      in.foot_point = {0.05 * t * t * (1.5 - 0.5 * t), 0.05 * t * (3.0 - 1.5 * t), 0.05 * (3.0 - 3.0 * t)};
      in.actuator_force = 200.0 * t;
      model.step(x, in);
    }
    return x.core;
  };
  const auto exact = end(1e-3);
  for (const double h : {1e-2, 1e-1, 1.0}) EXPECT_LT((end(h) - exact).norm(), 1e-12) << "step " << h;
}

/// Distance, in the norm of the state, of a run with step h from one with a much finer step.
double error_of(const Parameters& rig, double h, double amplitude) {
  const auto run = [&](double step) {
    const Rig model(rig, step);
    auto x = model.start();
    const auto steps = static_cast<int>(std::lround(0.5 / step));
    for (int k = 1; k <= steps; ++k) {
      // From rest, smooth, and never turning: the flow does not cross zero, where q|q| has a corner.
      const double t = 0.5 * k / steps;
      Rig::Input in;
      in.foot_point = {amplitude * t * t * t * t, 4.0 * amplitude * t * t * t, 12.0 * amplitude * t * t};
      model.step(x, in);
    }
    return model::Column<double, 6>(x.core.head<6>());
  };
  return (run(h) - run(2.5e-5)).norm();
}

// Order. Quadratic losses: fourth. Halving the step divides the error by 16; the first steps, for which there are only
// samples of rest, cost nothing because the motion starts with its fourth power.
TEST(RigModel, IsOfFourthOrderInTheDuctLosses) {
  auto rig = support::fdva_rig(RigKind::quarter_car);
  rig.tyre.damping = 2000.0;  // well damped: the wheel follows
  rig.suspension.damping = 3000.0;
  const double ratio = error_of(rig, 2e-3, 2.0) / error_of(rig, 1e-3, 2.0);
  EXPECT_GT(ratio, 13.0);
  EXPECT_LT(ratio, 19.0);
}

// Order. Laws of the suspension: third.
TEST(RigModel, IsOfThirdOrderInTheLawsOfTheSuspension) {
  auto rig = support::linear_rig(RigKind::quarter_car);
  rig.tyre.damping = 2000.0;
  rig.effects.add(model::ProgressiveSpring<double>{2e7});
  const double ratio = error_of(rig, 2e-3, 2.0) / error_of(rig, 1e-3, 2.0);
  EXPECT_GT(ratio, 6.5);
  EXPECT_LT(ratio, 9.5);
}

// Point. What each channel is, from one state of each kind: (3), (4), the law of Coulomb, z̈_r on the sensor's mass.
TEST(RigModel, ShowsTheSignalsOfAQuarterCar) {
  auto rig = support::linear_rig(RigKind::quarter_car);
  rig.effects.add(model::ForceSensorInertia<double>{5.0});
  const Rig model(rig, period);
  model::Column<double, 6> core;
  core << 0.02, 0.5, 0.01, 0.3, 0.0, 0.0;
  const auto x = model.start(core, {0.03, 1.0, 7.0}, {});
  const auto s = model.signals(x);
  const double load = 2e5 * 0.01 + 100.0 * 0.5, force = 31500.0 * 0.01 + 1140.0 * 0.2;
  EXPECT_EQ(at(s, Channel::z_r), 0.03);
  EXPECT_EQ(at(s, Channel::z_w), 0.02);
  EXPECT_EQ(at(s, Channel::z_b), 0.01);
  EXPECT_EQ(at(s, Channel::zdd_r), 7.0);
  EXPECT_NEAR(at(s, Channel::dz_w), 0.01, 1e-17);
  EXPECT_NEAR(at(s, Channel::dz_b), 0.01, 1e-17);
  EXPECT_NEAR(at(s, Channel::F_w), load, 1e-11);
  EXPECT_NEAR(at(s, Channel::zdd_w), (load - force) / 40.0, 1e-12);
  EXPECT_NEAR(at(s, Channel::zdd_b), force / 290.0, 1e-13);
  EXPECT_NEAR(model.suspension_force(x), force, 1e-11);
  EXPECT_NEAR(at(model.measured(x), Channel::F_w), load + 35.0, 1e-11);
  EXPECT_EQ(at(s, Channel::F), 0.0);
  EXPECT_EQ(at(s, Channel::x_cmd), 0.0);
}

// Point. The mass between load cell and component adds itself times ẍ_act to the measured force, not to the true one: a
// sine of 25 Hz, 1 kHz. (2) of StrokeAcceleration errs by (ωh)³/20 = 1.9e-4 of the acceleration. A machine that is 3.4
// ms late moves the mass late; the velocity that its delay line reads between two samples, w = 0.4 from the nearest,
// errs by w(1−w)(1−2w) h³x⁗/12, which is 6/h times as much of the acceleration: 5.9e-4.
TEST(RigModel, AddsTheInertiaOfTheMovingMass) {
  for (const RigKind kind : {RigKind::component_bench, RigKind::hil}) {
    for (const double delay : {0.0, 3.4e-3}) {
      auto rig = support::fdva_rig(kind);
      rig.effects.add(model::MovingMass<double>{4.0});
      if (delay > 0.0) rig.effects.add(model::ActuatorDelay<double>{delay});
      const Rig model(rig, period, kind == RigKind::hil ? ModelledPart::test_machine : ModelledPart::whole_rig);
      const double omega = 2.0 * std::numbers::pi * 25.0, amplitude = 0.01;
      auto x = model.start(0.0, amplitude);
      for (int k = 1; k <= 400; ++k) {
        const double t = k * period;
        Rig::Input in;
        in.command = {amplitude * std::cos(omega * t), -amplitude * omega * std::sin(omega * t)};
        model.step(x, in);
        if (k < 50) continue;  // the line of the delay began at rest
        const double inertia = -4.0 * amplitude * omega * omega * std::cos(omega * (t - delay));
        ASSERT_NEAR(at(model.measured(x), Channel::F) - at(model.signals(x), Channel::F), inertia,
                    (delay > 0.0 ? 8e-4 : 2e-4) * 4.0 * amplitude * omega * omega)
            << k;
      }
    }
  }
}

// Order. (2) of StrokeAcceleration errs by h³ x⁽⁵⁾/20: half the step, an eighth of the error.
TEST(StrokeAcceleration, IsOfThirdOrder) {
  const auto error = [](double h) {
    model::StrokeAcceleration<double> acceleration;
    double worst = 0.0;
    for (int k = 1; k * h < 2.0; ++k) {
      const auto at = [&](int i) { return Stroke<double>{std::sin(i * h), std::cos(i * h)}; };
      acceleration.step(at(k - 1), at(k), h);
      if (k > 3) worst = std::max(worst, std::abs(acceleration.value() + std::sin(k * h)));
    }
    return worst;
  };
  EXPECT_NEAR(error(0.02), std::pow(0.02, 3) / 20.0, 0.05 * std::pow(0.02, 3) / 20.0);
  EXPECT_NEAR(error(0.04) / error(0.02), 8.0, 0.4);
}

TEST(RigModel, ShowsTheSignalsOfABench) {
  auto rig = support::fdva_rig(RigKind::component_bench);
  rig.suspension.damping = 100.0;
  const Rig model(rig, period);
  model::Column<double, 6> core = model::Column<double, 6>::Zero();
  core(CoreIndex::piston_travel) = 0.004;
  const auto x = model.start(core, {}, {0.01, 0.2});
  const auto s = model.signals(x);
  EXPECT_EQ(at(s, Channel::x_act), 0.01);
  EXPECT_EQ(at(s, Channel::x_cmd), 0.01);
  EXPECT_NEAR(at(s, Channel::F), 31500.0 * 0.01 + 100.0 * 0.2 + 55e3 * 0.006, 1e-11);
  EXPECT_EQ(at(s, Channel::F_w), 0.0);
  EXPECT_EQ(at(s, Channel::z_w), 0.0);
}

// Point. Machine path: x_act is x_cmd, τ later; the bench's command passes through, position and velocity.
TEST(RigModel, ReachesTheCommandOneDelayLater) {
  auto rig = support::linear_rig(RigKind::component_bench);
  rig.effects.add(model::ActuatorDelay<double>{0.010});
  const Rig model(rig, period);
  auto x = model.start();
  for (int k = 1; k <= 100; ++k) {
    Rig::Input in;
    in.command = {1e-4 * k, 0.1};
    model.step(x, in);
    EXPECT_EQ(at(model.signals(x), Channel::x_act), k <= 10 ? 0.0 : 1e-4 * (k - 10)) << "sample " << k;
    EXPECT_EQ(at(model.signals(x), Channel::x_cmd), 1e-4 * k);
  }
}

// Law. Noise on the force sensor goes around the loop of a hil rig: the car feels it one step later, and the true force
// of the component does not have it.
TEST(RigModel, FeedsTheNoiseOfTheForceSensorBack) {
  const Rig model(support::linear_rig(RigKind::hil), period);
  auto quiet = model.start(), noisy = model.start();
  Signals<double> noise{};
  noise[index(Channel::F)] = 100.0;
  Rig::Input in;
  in.noise = &noise;
  model.step(noisy, in);
  model.step(quiet, {});
  EXPECT_EQ(at(model.measured(noisy, &noise), Channel::F) - at(model.measured(quiet), Channel::F), 100.0);
  EXPECT_EQ(at(model.signals(noisy), Channel::F), at(model.signals(quiet), Channel::F));
  EXPECT_EQ(noisy.core(CoreIndex::body_velocity), quiet.core(CoreIndex::body_velocity));
  model.step(noisy, {});
  EXPECT_NEAR(noisy.core(CoreIndex::body_velocity), 100.0 / 290.0 * period,
              1e-3 * 100.0 / 290.0 * period);  // held for a period
}

// Fault. Ducts that are not there, an FDVA that is not there, half a rig that has no halves: broken assumptions.
TEST(RigModelDeathTest, StopsAtWhatItDoesNotHave) {
  const Rig with(support::fdva_rig(RigKind::quarter_car), period), without(support::linear_rig(RigKind::hil), period);
  auto x = with.start(), y = without.start();
  EXPECT_DEATH(with.open_ducts(x, 64), "");
  EXPECT_DEATH(without.open_ducts(y, 1), "");
  EXPECT_DEATH(Rig(support::linear_rig(RigKind::quarter_car), period, ModelledPart::virtual_car), "");
  auto broken = support::linear_rig(RigKind::quarter_car);
  broken.body.mass = -1.0;
  EXPECT_DEATH(Rig(broken, period), "");
}

}  // namespace
