// Laws from tables in the steps of a rig.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "model/rig/rig_model.hpp"
#include "tests/support/reference_parameters.hpp"

namespace {

using model::Channel;
using model::LawOver;
using model::LawPlace;
using model::RigKind;
using Rig = model::RigModel<>;
using Parameters = model::RigParameters<double>;

void add_curve(Parameters& rig, LawPlace place, LawOver over, const std::vector<double>& at,
               const std::vector<double>& value) {
  auto& curve = rig.laws.curves[rig.laws.curve_count++];
  curve.place = place;
  curve.over = over;
  curve.count = static_cast<std::uint8_t>(at.size());
  std::copy(at.begin(), at.end(), curve.at.begin());
  std::copy(value.begin(), value.end(), curve.value.begin());
}

void add_line(Parameters& rig, LawPlace place, LawOver over, double slope) {
  add_curve(rig, place, over, {-1.0, 0.5, 1.0}, {-slope, 0.5 * slope, slope});
}

/// rms over 0.5 s of the difference between the channels of two rigs on the same wave, over that of the second rig.
double difference(const Parameters& a, double period_a, const Parameters& b, double period_b, Channel channel,
                  double frequency = 4.0) {
  const auto wave = [frequency](double t) {
    const double w = 2.0 * 3.14159265358979 * frequency;
    return model::Motion<double>{0.02 * std::sin(w * t), 0.02 * w * std::cos(w * t), -0.02 * w * w * std::sin(w * t)};
  };
  const auto next = [&](const Rig& rig, Rig::State& x, double t, double period) {
    const auto z = wave(t + period);
    rig.step(x, {.foot_point = z, .command = {z.position, z.velocity}});
  };
  const auto start = [&](const Rig& rig) {
    model::Column<double, 6> core = model::Column<double, 6>::Zero();
    return rig.start(core, wave(0.0), {wave(0.0).position, wave(0.0).velocity});
  };
  const Rig first(a, period_a), second(b, period_b);
  auto x = start(first), y = start(second);
  double error = 0.0, size = 0.0;
  constexpr double grid = 8e-3;
  const auto steps_a = std::lround(grid / period_a), steps_b = std::lround(grid / period_b);
  for (int i = 0; i < 62; ++i) {
    for (long k = 0; k < steps_a; ++k) next(first, x, grid * i + period_a * static_cast<double>(k), period_a);
    for (long k = 0; k < steps_b; ++k) next(second, y, grid * i + period_b * static_cast<double>(k), period_b);
    const double p = first.signals(x)[index(channel)], q = second.signals(y)[index(channel)];
    error += (p - q) * (p - q);
    size += q * q;
  }
  return std::sqrt(error / size);
}

struct Equal {
  const char* name;
  RigKind kind;
  std::function<void(Parameters&)> as_law, as_parameter;
  Channel channel;
};

// Law. A straight curve is the parameter that it stands for, at each place, but for the trapezium: (ωh)²/12 of a force,
// with the wheel mode of 80 1/s and h = 1 ms 6e-4, and a quarter of it for half the step.
TEST(LawsInSteps, StraightCurveIsTheParameterOfItsPlace) {
  const std::vector<Equal> places{
      {"damping", RigKind::quarter_car,
       [](Parameters& r) { add_line(r, LawPlace::suspension, LawOver::velocity, 800.0); },
       [](Parameters& r) { r.suspension.damping += 800.0; }, Channel::zdd_b},
      {"spring", RigKind::quarter_car,
       [](Parameters& r) { add_line(r, LawPlace::suspension, LawOver::deflection, 9e3); },
       [](Parameters& r) { r.suspension.stiffness += 9e3; }, Channel::zdd_b},
      {"tyre damping", RigKind::quarter_car,
       [](Parameters& r) { add_line(r, LawPlace::tyre, LawOver::velocity, 300.0); },
       [](Parameters& r) { r.tyre.damping += 300.0; }, Channel::F_w},
      {"tyre stiffness", RigKind::hil, [](Parameters& r) { add_line(r, LawPlace::tyre, LawOver::deflection, 4e4); },
       [](Parameters& r) { r.tyre.stiffness += 4e4; }, Channel::F_w},
      {"body guide", RigKind::quarter_car,
       [](Parameters& r) { add_line(r, LawPlace::body_guide, LawOver::velocity, 400.0); },
       [](Parameters& r) { r.effects.add(model::BodyGuideDamping<double>{400.0}); }, Channel::zdd_b},
      {"wheel guide", RigKind::quarter_car,
       [](Parameters& r) { add_line(r, LawPlace::wheel_guide, LawOver::velocity, 200.0); },
       [](Parameters& r) { r.effects.add(model::WheelGuideDamping<double>{200.0}); }, Channel::zdd_w},
      {"bench damping", RigKind::component_bench,
       [](Parameters& r) { add_line(r, LawPlace::suspension, LawOver::velocity, 800.0); },
       [](Parameters& r) { r.suspension.damping += 800.0; }, Channel::F},
      {"hil damping", RigKind::hil, [](Parameters& r) { add_line(r, LawPlace::suspension, LawOver::velocity, 300.0); },
       [](Parameters& r) { r.suspension.damping += 300.0; }, Channel::F},
  };
  for (const Equal& place : places) {
    Parameters law = support::linear_rig(place.kind), parameter = law;
    place.as_law(law);
    place.as_parameter(parameter);
    const double coarse = difference(law, 1e-3, parameter, 1e-3, place.channel);
    const double fine = difference(law, 5e-4, parameter, 5e-4, place.channel);
    EXPECT_LT(coarse, 2e-3) << place.name;
    EXPECT_LT(fine, 0.3 * coarse + 1e-9) << place.name;
    EXPECT_GT(difference(support::linear_rig(place.kind), 1e-3, parameter, 1e-3, place.channel), 0.02)
        << place.name << " matters";
  }
}

// Law. A Maxwell branch is the effect `relaxation`, which is exact.
TEST(LawsInSteps, MaxwellBranchIsTheRelaxation) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::component_bench}) {
    Parameters law = support::linear_rig(kind), effect = law;
    law.laws.branches[law.laws.branch_count++] = {
        .place = LawPlace::suspension, .stiffness = 4e4, .time_constant = 0.02};
    effect.effects.add(model::Relaxation<double>{4e4, 0.02});
    const Channel channel = kind == RigKind::component_bench ? Channel::F : Channel::zdd_b;
    const double coarse = difference(law, 1e-3, effect, 1e-3, channel);
    EXPECT_LT(coarse, 2e-3);
    EXPECT_LT(difference(law, 5e-4, effect, 5e-4, channel), 0.3 * coarse);
  }
}

// Law. A straight damper c behind a spring k is the effect `relaxation` with k and T = c/k, which is exact; a straight
// spring s is one of k s/(k + s).
TEST(LawsInSteps, StraightCurveBehindASpringIsAMaxwellBranchOrASofterSpring) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::component_bench}) {
    const Channel channel = kind == RigKind::component_bench ? Channel::F : Channel::zdd_b;
    const Parameters without = support::linear_rig(kind);
    for (const double stiffness : {4e4, 4.3e5}) {
      Parameters law = without, effect = without;
      add_line(law, LawPlace::suspension, LawOver::velocity, 800.0);
      law.laws.curves[0].behind = stiffness;
      effect.effects.add(model::Relaxation<double>{stiffness, 800.0 / stiffness});
      const double coarse = difference(law, 1e-3, effect, 1e-3, channel);
      EXPECT_LT(coarse, 5e-3) << stiffness;
      EXPECT_LT(difference(law, 5e-4, effect, 5e-4, channel), 0.3 * coarse) << stiffness;
      EXPECT_GT(difference(without, 1e-3, effect, 1e-3, channel), 0.05) << "it matters";
    }
    Parameters law = without, softer = without;
    add_line(law, LawPlace::suspension, LawOver::deflection, 3e4);
    law.laws.curves[0].behind = 1e4;
    add_line(softer, LawPlace::suspension, LawOver::deflection, 0.75e4);
    EXPECT_LT(difference(law, 1e-3, softer, 1e-3, channel), 1e-9);
  }
}

/// A damper with a knee and the gas of 70 N, behind a spring.
Parameters kneed_behind(RigKind kind, double stiffness) {
  Parameters rig = support::linear_rig(kind);
  rig.suspension = {};
  add_curve(rig, LawPlace::suspension, LawOver::velocity, {-1.0, -0.1, -0.02, 0.0, 0.03, 0.1, 1.0},
            {-1370.0, -520.0, -400.0, 0.0, 600.0, 700.0, 2000.0});
  rig.laws.curves[0].behind = stiffness;
  return rig;
}

// Law. The same from the other end, worked out here: with x_i(t) prescribed, x = x_i + f(ẋ_i)/k is what moves a bench
// whose force is f(ẋ_i), whatever the knee. The error falls with h².
TEST(LawsInSteps, CurveBehindASpringSharesItsForce) {
  const Parameters rig = kneed_behind(RigKind::component_bench, 4.3e5);
  const auto& table = rig.laws.curves[0];
  const model::Curve<double> curve(table.at, table.value, table.count);
  const auto inside = [](double t) { return 0.02 * std::sin(25.0 * t) * std::sin(2.0 * t); };
  const auto velocity = [](double t) {
    return 0.5 * std::cos(25.0 * t) * std::sin(2.0 * t) + 0.04 * std::sin(25.0 * t) * std::cos(2.0 * t);
  };
  const auto outside = [&](double t) { return inside(t) + curve(velocity(t)) / 4.3e5; };
  const auto error = [&](double h) {
    const Rig model(rig, h);
    auto x = model.start();
    double squares = 0.0, size = 0.0;
    for (double t = h; t < 1.5; t += h) {
      model.step(x, {.command = {outside(t), (outside(t + 1e-6) - outside(t - 1e-6)) / 2e-6}});
      const double force = model.signals(x)[index(Channel::F)];
      squares += std::pow(force - curve(velocity(t)), 2);
      size += force * force;
    }
    return std::sqrt(squares / size);
  };
  EXPECT_LT(error(1e-3), 0.01);
  EXPECT_LT(error(2.5e-4), 0.15 * error(1e-3));
}

// Limit. Behind a very stiff spring the curve is itself; behind none that carries anything, nothing.
TEST(LawsInSteps, VeryStiffSpringHidesNothing) {
  const Parameters itself = kneed_behind(RigKind::quarter_car, 0.0), stiff = kneed_behind(RigKind::quarter_car, 1e10);
  const double coarse = difference(stiff, 1e-3, itself, 1e-3, Channel::F_w);
  EXPECT_LT(coarse, 0.01);
  EXPECT_LT(difference(stiff, 2.5e-4, itself, 2.5e-4, Channel::F_w), 0.5 * coarse);
  Parameters none = itself;
  none.laws = {};
  EXPECT_LT(difference(kneed_behind(RigKind::quarter_car, 1e-3), 1e-3, none, 1e-3, Channel::F_w), 1e-3);
}

// Law. A curve with points on v|v| is the effect quadratic_damping, but for the curve between its points.
TEST(LawsInSteps, CurveIsTheEffectThatItWasTakenFrom) {
  Parameters law = support::linear_rig(RigKind::quarter_car), effect = law;
  std::vector<double> at, value;
  for (int i = -16; i <= 16; ++i) {
    at.push_back(0.1 * i);
    value.push_back(600.0 * at.back() * std::abs(at.back()));
  }
  add_curve(law, LawPlace::suspension, LawOver::velocity, at, value);
  effect.effects.add(model::QuadraticDamping<double>{600.0});
  EXPECT_LT(difference(law, 1e-3, effect, 1e-3, Channel::zdd_b), 2e-3);
}

/// All at once, curved: second order.
Parameters curved() {
  Parameters rig = support::fdva_rig(RigKind::quarter_car);
  std::vector<double> at, value, stop;
  for (int i = -16; i <= 16; ++i) {
    at.push_back(0.125 * i);
    value.push_back(900.0 * std::tanh(2.0 * at.back()));
    stop.push_back(4e4 * at.back() * at.back() * at.back());
  }
  add_curve(rig, LawPlace::suspension, LawOver::velocity, at, value);
  add_curve(rig, LawPlace::tyre, LawOver::deflection, at, stop);
  add_curve(rig, LawPlace::piston, LawOver::velocity, at, value);
  add_curve(rig, LawPlace::body_guide, LawOver::velocity, at, value);
  return rig;
}

// Order. Against 25 µs the error falls with h².
TEST(LawsInSteps, AreOfSecondOrder) {
  const Parameters rig = curved();
  const double coarse = difference(rig, 2e-3, rig, 2.5e-5, Channel::zdd_b);
  const double fine = difference(rig, 1e-3, rig, 2.5e-5, Channel::zdd_b);
  const double finer = difference(rig, 5e-4, rig, 2.5e-5, Channel::zdd_b);
  EXPECT_GT(coarse / fine, 3.2);
  EXPECT_GT(fine / finer, 3.2);
  EXPECT_LT(fine, 5e-3);
}

// Law. However stiff a law that only takes energy, free vibration never grows: a step of 1 ms with a damper of 1e7 N
// s/m (λh = −250), a kink of 2 kN within 0.1 mm/s, sliders and Maxwell branches of 1e9 N/m.
TEST(LawsInSteps, TakeEnergyHoweverSteepTheyAre) {
  using Add = std::function<void(Parameters&)>;
  const std::vector<Add> laws{
      [](Parameters& r) { add_line(r, LawPlace::suspension, LawOver::velocity, 1e7); },
      [](Parameters& r) {
        add_curve(r, LawPlace::suspension, LawOver::velocity, {-1.0, -1e-4, 1e-4, 1.0}, {-2100.0, -2e3, 2e3, 2100.0});
      },
      [](Parameters& r) {
        add_curve(r, LawPlace::suspension, LawOver::velocity, {-1.0, -1e-4, 1e-4, 1.0}, {-2100.0, -2e3, 2e3, 2100.0});
        r.laws.curves[0].behind = 1e9;
      },
      [](Parameters& r) { add_line(r, LawPlace::tyre, LawOver::velocity, 1e7); },
      [](Parameters& r) { add_line(r, LawPlace::body_guide, LawOver::velocity, 1e8); },
      [](Parameters& r) { r.laws.branches[r.laws.branch_count++] = {.stiffness = 1e9, .slip_force = 300.0}; },
      [](Parameters& r) { r.laws.branches[r.laws.branch_count++] = {.stiffness = 1e9, .time_constant = 1e-4}; },
      [](Parameters& r) {
        for (int i = 0; i < 8; ++i) {
          r.laws.branches[r.laws.branch_count++] = {.stiffness = 1e4 * std::pow(5.0, i), .slip_force = 20.0 * (i + 1)};
        }
      },
  };
  for (std::size_t l = 0; l < laws.size(); ++l) {
    Parameters rig = support::linear_rig(RigKind::quarter_car);
    laws[l](rig);
    const Rig model(rig, 1e-3);
    model::Column<double, 6> core = model::Column<double, 6>::Zero();
    core(model::CoreIndex::wheel_velocity) = 1.0;
    core(model::CoreIndex::body_velocity) = -0.5;
    auto x = model.start(core, {}, {});
    const double before = model.energy(x);
    double later = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      model.step(x, {});
      ASSERT_LT(model.energy(x), before * 1.001) << "law " << l << ", step " << k;
      if (k == 3000) later = model.energy(x);
    }
    EXPECT_LT(later, 0.5 * before) << "law " << l;
    EXPECT_LE(model.energy(x), later * 1.001 + 1e-3) << "law " << l;
  }
}

// Law. A spring from a table never feeds, however stiff: to ωh = 1.6 and 50 (1e8, 1e11 N/m on the wheel). At a usual
// stiffness (ωh = 0.1) it does not take either: within 10 % over 1600 swings.
TEST(LawsInSteps, SpringKeepsItsEnergy) {
  for (const double stiffness : {4e5, 1e8, 1e11}) {
    Parameters rig = support::linear_rig(RigKind::quarter_car);
    rig.tyre.damping = rig.suspension.damping = 0.0;
    add_line(rig, LawPlace::tyre, LawOver::deflection, stiffness);
    const Rig model(rig, 1e-3);
    model::Column<double, 6> core = model::Column<double, 6>::Zero();
    core(model::CoreIndex::wheel_velocity) = 1.0;
    auto x = model.start(core, {}, {});
    const auto energy = [&] {
      const double z = x.core(model::CoreIndex::wheel_position);
      return model.energy(x) + 0.5 * stiffness * z * z;
    };
    const double before = energy();
    double lowest = before, highest = before;
    for (int k = 0; k < 100'000; ++k) {
      model.step(x, {});
      if (k < 50'000) continue;
      lowest = std::min(lowest, energy());
      highest = std::max(highest, energy());
    }
    EXPECT_LT(highest, 1.1 * before) << stiffness;
    EXPECT_GT(lowest, stiffness < 1e6 ? 0.9 * before : 0.0) << stiffness;
  }
}

// Limit. A law that holds the piston is a rig with all ducts closed.
TEST(LawsInSteps, HeldPistonIsAClosedDuct) {
  Parameters held = support::fdva_rig(RigKind::quarter_car, 2), closed = support::fdva_rig(RigKind::quarter_car, 0);
  add_line(held, LawPlace::piston, LawOver::velocity, 1e9);
  EXPECT_LT(difference(held, 1e-3, closed, 1e-3, Channel::zdd_b), 1e-3);
}

// Law. Behind a top mount the law acts on e. A steep law makes component and mount one spring, the mount's.
TEST(LawsInSteps, ActBehindTheTopMount) {
  for (const RigKind kind : {RigKind::quarter_car, RigKind::component_bench}) {
    const Channel channel = kind == RigKind::component_bench ? Channel::F : Channel::zdd_b;
    Parameters mount = support::linear_rig(kind);
    mount.effects.add(model::TopMount<double>{3e5});
    Parameters law = mount, spring = mount;
    add_line(law, LawPlace::suspension, LawOver::deflection, 2e4);
    spring.suspension.stiffness += 2e4;
    EXPECT_LT(difference(law, 1e-3, spring, 1e-3, channel), 2e-3);
    Parameters damper = mount, damping = mount;
    add_line(damper, LawPlace::suspension, LawOver::velocity, 900.0);
    damping.suspension.damping += 900.0;
    EXPECT_LT(difference(damper, 1e-3, damping, 1e-3, channel), 0.03) << "first order";
    EXPECT_LT(difference(damper, 2.5e-4, damping, 2.5e-4, channel), 0.01);
  }
}

// Law. A run that begins in mid-motion: what is behind a mount moves along with what is before it, so a damper carries
// c v from the first sample on. Bound: the rounding of 800 N in Newton's differences of 1e-7 m.
TEST(LawsInSteps, BeginInMidMotionBehindTheTopMount) {
  constexpr double v = 0.4, spring = 3e5;
  Parameters damper = support::linear_rig(RigKind::component_bench);
  damper.suspension.stiffness = 0.0;
  Parameters mount = damper, law = damper, bent = damper;
  for (Parameters* const rig : {&mount, &law, &bent}) rig->effects.add(model::TopMount<double>{spring});
  add_line(law, LawPlace::suspension, LawOver::velocity, 900.0);
  bent.effects.add(model::QuadraticDamping<double>{500.0});
  const double c = damper.suspension.damping;
  for (const auto& [rig, force] :
       {std::pair(&mount, c * v), std::pair(&law, (c + 900.0) * v), std::pair(&bent, c * v + 500.0 * v * v)}) {
    const Rig model(*rig, 1e-3);
    auto x = model.start(model::Column<double, 6>::Zero(), {0.01, v, 0.0}, {0.01, v});
    for (int k = 1; k <= 20; ++k) {
      EXPECT_NEAR(model.signals(x)[index(Channel::F)], force, 1e-5) << k;
      model.step(x, {.command = {0.01 + 1e-3 * k * v, v}});
    }
  }
}

// Law. Inside the free play a law sees nothing.
TEST(LawsInSteps, SeeNothingInsideTheFreePlay) {
  Parameters gap = support::linear_rig(RigKind::component_bench);
  gap.effects.add(model::Backlash<double>{0.1});
  Parameters law = gap;
  add_line(law, LawPlace::suspension, LawOver::deflection, 1e6);
  const Rig model(law, 1e-3);
  auto x = model.start();
  for (int k = 1; k <= 100; ++k) model.step(x, {.command = {0.0004 * k, 0.4}});
  EXPECT_DOUBLE_EQ(model.signals(x)[index(Channel::F)], 0.0);
  for (int k = 101; k <= 200; ++k) model.step(x, {.command = {0.0004 * k, 0.4}});
  EXPECT_NEAR(model.signals(x)[index(Channel::F)], (1e6 + 31500.0) * 0.03 + 1140.0 * 0.4, 1e-6);
}

// Point. A sensor with a curve shows the curve of the true value; in a hil rig the car gets what is shown.
TEST(LawsInSteps, SensorShowsItsCurve) {
  Parameters rig = support::linear_rig(RigKind::quarter_car);
  add_curve(rig, LawPlace::sensor, {}, {-1e-3, 0.0, 1e-3}, {-2e-3, 0.0, 3e-3});
  rig.laws.curves[0].channel = Channel::dz_w;
  const Rig model(rig, 1e-3);
  auto x = model.start();
  model.step(x, {.foot_point = {0.01, 1.0, 0.0}});
  const double truth = model.signals(x)[index(Channel::dz_w)];
  EXPECT_GT(truth, 2e-3);
  EXPECT_NEAR(model.measured(x)[index(Channel::dz_w)], 3.0 * truth, 1e-12);

  Parameters hil = support::linear_rig(RigKind::hil), gain = hil;
  add_line(hil, LawPlace::sensor, {}, 1.1);
  hil.laws.curves[0].channel = Channel::F;
  gain.effects.add(Channel::F, model::SensorGain<double>{1.1});
  EXPECT_LT(difference(hil, 1e-3, gain, 1e-3, Channel::z_w), 1e-9);
  EXPECT_GT(difference(hil, 1e-3, support::linear_rig(RigKind::hil), 1e-3, Channel::z_w), 1e-3);
}

// Point. What is not a law is refused with its key.
TEST(LawsInSteps, WhatIsNoLawIsAFault) {
  const auto key = [](const std::function<void(Parameters&)>& change, RigKind kind = RigKind::quarter_car) {
    Parameters rig = support::linear_rig(kind);
    add_line(rig, LawPlace::suspension, LawOver::velocity, 100.0);
    change(rig);
    const auto fault = model::find_fault(rig, 1e-3, 512);
    return fault ? std::string(fault->key) : std::string("none");
  };
  EXPECT_EQ(key([](Parameters&) {}), "none");
  EXPECT_EQ(key([](Parameters& r) { r.laws.curves[0].at[1] = -1.0; }), "at");
  EXPECT_EQ(key([](Parameters& r) { r.laws.curves[0].count = 1; }), "at");
  EXPECT_EQ(key([](Parameters& r) { r.laws.curves[0].value[1] = NAN; }), "value");
  EXPECT_EQ(key([](Parameters& r) { r.laws.curves[0].place = LawPlace::piston; }), "place");
  EXPECT_EQ(key([](Parameters& r) { r.laws.curves[0].place = LawPlace::body_guide; }, RigKind::hil), "place");
  EXPECT_EQ(key([](Parameters& r) { r.laws.branches[r.laws.branch_count++] = {.stiffness = 1.0}; }), "time_constant");
  EXPECT_EQ(key([](Parameters& r) { r.laws.branches[r.laws.branch_count++] = {.slip_force = 1.0}; }), "stiffness");
  const auto branch = [&](const model::BranchNumbers<double>& numbers) {
    return key([&](Parameters& r) { r.laws.branches[r.laws.branch_count++] = numbers; });
  };
  EXPECT_EQ(branch({.stiffness = 1.0, .slip_force = 1.0, .gap = -1.0}), "gap");
  EXPECT_EQ(branch({.stiffness = 1.0, .time_constant = 1.0, .gap = 1.0}), "gap");
  EXPECT_EQ(branch({.stiffness = 1.0, .slip_force = 1.0, .gap = 1.0}), "none");
}

}  // namespace
