// Energy: nothing of it appears from nowhere.
#include <gtest/gtest.h>

#include <cmath>

#include "model/rig/rig_model.hpp"
#include "tests/support/reference_parameters.hpp"
#include "tests/support/reference_road.hpp"

namespace {

using model::CoreIndex;
using model::RigKind;
using Rig = model::RigModel<>;
using Parameters = model::RigParameters<double>;

Parameters lossless() {
  auto rig = support::fdva_rig(RigKind::quarter_car);
  rig.tyre.damping = 0.0;
  rig.fdva.oil_viscosity = 0.0;
  rig.fdva.minor_loss = 0.0;
  return rig;
}

Rig::State kicked(const Rig& model, double v_w = 1.0, double v_b = -0.5) {
  model::Column<double, 6> core = model::Column<double, 6>::Zero();
  core(CoreIndex::wheel_velocity) = v_w;
  core(CoreIndex::body_velocity) = v_b;
  return model.start(core, {}, {});
}

// Law. Car, coil spring and oil without losses keep what they have: a million steps, each rounding the energy by some
// 1e-16 at random, the exponential by a fixed 1e-15 or so a step: 1e-9.
TEST(Energy, IsKeptWithoutLosses) {
  const Rig model(lossless(), 1e-3);
  auto x = kicked(model);
  const double energy = model.energy(x);
  EXPECT_NEAR(energy, 0.5 * 40.0 + 0.5 * 290.0 * 0.25, 1e-12);
  for (int k = 1; k <= 1'000'000; ++k) {
    model.step(x, {});
    if (k % 10'000 != 0) continue;
    EXPECT_NEAR(model.energy(x) / energy, 1.0, 1e-9) << "step " << k;
  }
}

// Law. With losses it falls by what the losses take: b_t v_w² in the tyre, b_b (v_w − v_b)² in the damper and
// Σ (R q + S q|q|) q in the ducts, summed by the trapezium. Its error h²/12 [d(power)/dt] is 1e-7 of the energy; that
// of the explicit losses less.
TEST(Energy, FallsByTheWorkOfTheLosses) {
  auto rig = support::fdva_rig(RigKind::quarter_car);
  rig.suspension.damping = 150.0;
  const double h = 1e-4;
  const Rig model(rig, h);
  auto x = kicked(model);
  const auto duct = model.equations().duct();
  const auto step = model::DuctFlows<double>::step_of(rig.fdva, duct, h);
  const auto power = [&] {
    const double relative = x.core(CoreIndex::wheel_velocity) - x.core(CoreIndex::body_velocity);
    double p = rig.tyre.damping * x.core(CoreIndex::wheel_velocity) * x.core(CoreIndex::wheel_velocity) +
               rig.suspension.damping * relative * relative;
    for (std::size_t j = 0; j < model::duct_capacity; ++j) {
      const double q = x.ducts.flow(j, x.core(CoreIndex::piston_velocity), step);
      p += duct.laminar_loss * q * q + duct.minor_loss * std::fabs(q) * q * q;
    }
    return p;
  };
  const double start = model.energy(x);
  double lost = 0.0, before = power();
  for (int k = 1; k <= 20'000; ++k) {
    model.step(x, {});
    const double now = power();
    lost += 0.5 * h * (before + now);
    before = now;
    if (k % 100 != 0) continue;
    EXPECT_NEAR((model.energy(x) + lost) / start, 1.0, 1e-6) << "step " << k;
  }
  EXPECT_LT(model.energy(x), 0.1 * start) << "there was something to lose";
}

// Law. The foot point brings in F_w v_r, and nothing else does. Trapezium: h²/12 of the power's rate, some
// 1 kN · 0.19 m/s · 85 1/s, is 1.3e-5 J; some ten joules come and go.
TEST(Energy, ComesInThroughTheFootPointOnly) {
  auto rig = lossless();
  const double h = 1e-4;
  const Rig model(rig, h);
  auto x = model.start();
  double work = 0.0, before = 0.0, largest = 0.0;
  for (int k = 1; k <= 20'000; ++k) {
    const double t = k * h, w = 2.0 * 3.14159265358979 * 3.0;
    const model::Motion<double> foot{0.01 * (1.0 - std::cos(w * t)), 0.01 * w * std::sin(w * t),
                                     0.01 * w * w * std::cos(w * t)};
    model.step(x, {.foot_point = foot});
    const double now = model.signals(x)[index(model::Channel::F_w)] * foot.velocity;
    work += 0.5 * h * (before + now);
    before = now;
    EXPECT_NEAR(model.energy(x), work, 2e-5) << "step " << k;
    largest = std::fmax(largest, work);
  }
  EXPECT_GT(largest, 5.0);
}

// Law. Dry friction only takes: beside a lossless car, which keeps its energy, every step with friction in the
// suspension, the seal or the guides ends with no more than it began with; only where a contact turns round may the
// mean force of the step miss up to f (f h/m) h/8, with 80 N and 40 kg 2e-5 J of 56 J, and up to four contacts.
TEST(Energy, OnlyFallsByDryFriction) {
  for (int which = 0; which < 4; ++which) {
    auto rig = lossless();
    if (which == 0 || which == 3) rig.effects.add(model::CoulombFriction<double>{80.0});
    if (which == 1 || which == 3) rig.effects.add(model::SealFriction<double>{60.0});
    if (which == 2 || which == 3) {
      rig.effects.add(model::BodyGuideFriction<double>{40.0});
      rig.effects.add(model::WheelGuideFriction<double>{30.0});
    }
    const Rig model(rig, 1e-3);
    auto x = kicked(model);
    const double start = model.energy(x);
    double before = start;
    for (int k = 1; k <= 5000; ++k) {
      model.step(x, {});
      const double now = model.energy(x);
      EXPECT_LE(now, before + 1e-4) << "case " << which << ", step " << k;
      before = now;
    }
    EXPECT_LT(before, 0.5 * start) << "case " << which;
  }
}

// Law. Ducts opened and closed at random in a lossless rig: switching itself may only take energy, the steps between
// keep it (1e-12 a step).
TEST(Energy, NeverRisesByOpeningAndClosingDucts) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::component_bench}) {
    for (const std::uint64_t seed : {51U, 52U, 53U}) {
      auto rig = lossless();
      rig.kind = kind;
      const Rig model(rig, 1e-3);
      auto x = kicked(model);
      if (kind == RigKind::component_bench) x.core(CoreIndex::piston_travel) = 0.01;  // its coil spring is tensioned
      support::NormalNoise noise(seed);
      double before = model.energy(x);
      const double start = before;
      for (int k = 0; k < 20'000; ++k) {
        if (noise.uniform() < 0.05) {
          model.open_ducts(x, static_cast<model::OpenDucts>(noise.uniform() * 64.0));
          EXPECT_LE(model.energy(x), before * (1.0 + 1e-14)) << name(kind) << ", seed " << seed << ", step " << k;
          before = model.energy(x);
        }
        model.step(x, {});
        EXPECT_NEAR(model.energy(x), before, 1e-12 * start) << name(kind) << ", seed " << seed << ", step " << k;
        before = model.energy(x);
      }
      EXPECT_LT(before, start) << name(kind) << ", seed " << seed;
    }
  }
}

// Law. No duct open: the piston is locked where it is, F_c = k_c (dz_b − y), however the rig is shaken.
TEST(Energy, OfTheOilIsNoneWithALockedPiston) {
  auto rig = support::fdva_rig(RigKind::quarter_car);
  const Rig model(rig, 1e-3);
  auto x = model.start();
  const auto road = support::random_road(64e-6, 1e-3, 4.0, 54);
  for (std::size_t k = 0; k < 2000; ++k) model.step(x, {.foot_point = road[k]});
  model.open_ducts(x, 0);
  const double y = x.core(CoreIndex::piston_travel);
  EXPECT_NE(y, 0.0);
  for (std::size_t k = 2000; k < road.size(); ++k) {
    model.step(x, {.foot_point = road[k]});
    EXPECT_EQ(x.core(CoreIndex::piston_travel), y) << "seed 54";
    EXPECT_EQ(x.core(CoreIndex::piston_velocity), 0.0) << "seed 54";
    const auto d = model.deflection(x);
    EXPECT_NEAR(model.suspension_force(x), 31500.0 * d.position + 55e3 * (d.position - y), 1e-9) << "seed 54";
  }
}

}  // namespace
