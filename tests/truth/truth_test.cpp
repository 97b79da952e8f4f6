#include "tests/truth/truth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/truth/rig.hpp"
#include "tests/truth/signal.hpp"

namespace {

using truth::Fineness;
using truth::Kind;
using truth::Motion;
using truth::Numbers;
using truth::Rig;
using truth::Signal;
using truth::Truth;
using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double fine = 5e-5;

Numbers paper_car() {
  Numbers n;
  n.body = 290.0;
  n.wheel = 40.0;
  n.tyre = 200e3;
  n.tyre_damping = 100.0;
  n.spring = 31500.0;
  n.damping = 1140.0;
  return n;
}

Signal sine(double amplitude, double omega, double duration) {
  std::vector<Motion> knots;
  for (int i = 0; i <= static_cast<int>(duration * 1000.0) + 2; ++i) {
    const double angle = omega * i * 1e-3;
    knots.push_back({amplitude * std::sin(angle), amplitude * omega * std::cos(angle),
                     -amplitude * omega * omega * std::sin(angle)});
  }
  return Signal(knots);
}

Signal silence() { return Signal(std::vector<Motion>(3)); }

Truth bench_with(truth::Effect effect) {
  Truth t;
  t.kind = Kind::component_bench;
  t.nominal = t.actual = {{"suspension.stiffness", 31500.0}, {"suspension.damping", 1140.0}};
  t.effects = {std::move(effect)};
  truth::RecordPlan plan;
  plan.duration = 3.0;
  plan.level = 0.006;
  t.records = {plan};
  return t;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double error = 0.0;
  double size = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    error += (a[i] - b[i]) * (a[i] - b[i]);
    size += b[i] * b[i];
  }
  return size > 0.0 ? std::sqrt(error / size) : std::sqrt(error);
}

// Law. In steady state the rig answers a sine with the closed form of equations (1)–(4), (6)–(8) without turbulence:
// D = k + b s + k_c Z/(k_c + Z), tyre k_t + b_t s. Transients have fallen to e^{−1.4·10} ~ 1e-6 of what remains.
TEST(TruthRig, AnswersASineWithTheClosedForm) {
  Numbers n = paper_car();
  n.fdva = true;
  n.coupling = 55e3;
  n.inertance = 21.768;
  n.laminar = 154.8;
  const double omega = 2.0 * pi * 9.0;
  const Signal signal = sine(1e-3, omega, 11.0);
  Rig rig(n, signal, fine, 11.0, nullptr);
  Complex wheel;
  Complex body;
  for (int node = 0; node < 220000; ++node) {
    if (node >= 200000) {
      const Complex turn = std::polar(2.0 / 20000.0 / 1e-3, -omega * node * fine) * Complex{0.0, 1.0};
      wheel += turn * rig.state()[Rig::zw];
      body += turn * rig.state()[Rig::zb];
    }
    rig.step();
  }
  const Complex s{0.0, omega};
  const Complex z = n.inertance * s * s + n.laminar * s;
  const Complex k = n.spring + n.damping * s + n.coupling * z / (n.coupling + z);
  const Complex tyre = n.tyre + n.tyre_damping * s;
  const Complex m_b = n.body * s * s + k;
  const Complex expected_wheel = tyre * m_b / (m_b * (n.wheel * s * s + tyre + k) - k * k);
  EXPECT_LT(std::abs(wheel / expected_wheel - 1.0), 1e-5);
  EXPECT_LT(std::abs(body / (expected_wheel * k / m_b) - 1.0), 1e-5);
}

// Law. The loop through machine, component and sensor: K becomes K e^{−sτ}, the virtual damping stays. An actuator's
// and a sensor's delay add up to one τ, and both histories are interpolated.
TEST(TruthRig, AnswersASineInTheDelayedLoopWithTheClosedForm) {
  Numbers n = paper_car();
  n.kind = Kind::hil;
  n.virtual_damping = 700.0;
  n.machine_delay = 6.0137e-3;
  Truth t;
  t.kind = Kind::hil;
  t.effects = {{"sensor_delay", "F", {{"delay", 3.9871e-3}}}};
  truth::Sensor sensor(t, "F", std::vector<double>(12000), 0.0, 20);
  const double omega = 2.0 * pi * 7.0;
  const Signal signal = sine(1e-3, omega, 11.0);
  Rig rig(n, signal, fine, 11.0, &sensor);
  Complex wheel;
  for (int node = 0; node < 220000; ++node) {
    if (node >= 200000)
      wheel += std::polar(2.0 / 20.0, -omega * node * fine) * Complex{0.0, 1.0} * rig.state()[Rig::zw];
    rig.step();
  }
  const Complex s{0.0, omega};
  const Complex k = (n.spring + n.damping * s) * std::exp(-s * 10.0008e-3) + n.virtual_damping * s;
  const Complex tyre = n.tyre + n.tyre_damping * s;
  const Complex m_b = n.body * s * s + k;
  EXPECT_LT(std::abs(wheel / (tyre * m_b / (m_b * (n.wheel * s * s + tyre + k) - k * k)) - 1.0), 1e-5);
}

// Law. Without losses on a road that stands still the energy in masses, springs and oil stays.
TEST(TruthRig, KeepsItsEnergyWithoutLosses) {
  Numbers n = paper_car();
  n.damping = n.tyre_damping = 0.0;
  n.fdva = true;
  n.coupling = 55e3;
  n.inertance = 21.768;
  n.cubic_spring = 2e7;
  const Signal still = silence();
  Rig rig(n, still, fine, 1.0, nullptr);
  rig.state()[Rig::zb] = 0.02;
  rig.state()[Rig::vw] = 0.5;
  const auto energy = [&] {
    const Rig::State& s = rig.state();
    const double e = s[Rig::zw] - s[Rig::zb];
    return 0.5 * (n.body * s[Rig::vb] * s[Rig::vb] + n.wheel * s[Rig::vw] * s[Rig::vw] +
                  n.tyre * s[Rig::zw] * s[Rig::zw] + n.spring * e * e + n.coupling * (e - s[Rig::y]) * (e - s[Rig::y]) +
                  n.inertance * s[Rig::vy] * s[Rig::vy]) +
           0.25 * n.cubic_spring * e * e * e * e;
  };
  const double begin = energy();
  for (int i = 0; i < 20000; ++i) rig.step();
  EXPECT_NEAR(energy() / begin, 1.0, 1e-8);
}

// Point. A body sliding on its guide alone stops after m v²/2F, and stays: the instant is found, not stepped over.
TEST(TruthRig, SlidesToAStopWhereTheWorkOfFrictionSaysAndSticks) {
  Numbers n;
  n.body = 290.0;
  n.wheel = 40.0;
  n.body_friction = 50.0;
  const Signal still = silence();
  Rig rig(n, still, fine, 1.0, nullptr);
  rig.state()[Rig::vb] = 0.0812345;
  for (int i = 0; i < 20000; ++i) rig.step();
  EXPECT_NEAR(rig.state()[Rig::zb], 290.0 * 0.0812345 * 0.0812345 / 100.0, 1e-11);
  EXPECT_NEAR(rig.state()[Rig::vb], 0.0, 1e-9);
}

// Law. Below its break-away force the friction of the suspension joins wheel and body to one mass on the tyre; its
// force is then what the body's inertia takes, not ± its largest.
TEST(TruthRig, MovesWheelAndBodyAsOneWhileTheSuspensionSticks) {
  Numbers n = paper_car();
  n.coulomb = 500.0;
  const Signal signal = sine(2e-4, 2.0 * pi * 2.0, 1.0);
  Rig rig(n, signal, fine, 1.0, nullptr);
  for (int i = 0; i < 20000; ++i) rig.step();
  EXPECT_NEAR(rig.state()[Rig::zw] - rig.state()[Rig::zb], 0.0, 1e-10);
  const Rig::Values v = rig.values();
  EXPECT_NEAR(v.force, n.body * v.zdd_b, 1e-6);
  EXPECT_NEAR(v.wheel_load, (n.body + n.wheel) * v.zdd_b, 1e-6);
  EXPECT_GT(std::abs(v.zdd_b), 1e-3);
}

// Point. The reference FDVA with two open ducts has the constants its source states: b, c, c₂ of equations (8), (9).
TEST(TruthNumbers, HaveTheStatedConstantsOfTheReferenceFdva) {
  Truth t;
  t.fdva = true;
  t.actual = {{"fdva.piston_area", 30e-4},       {"fdva.duct_diameter", 12e-3}, {"fdva.duct_length", 0.6361571127},
              {"fdva.oil_density", 860.0},       {"fdva.oil_viscosity", 32e-6}, {"fdva.minor_loss", 1.5},
              {"fdva.coupling_stiffness", 55e3}, {"fdva.open_ducts", 2.0}};
  const Numbers n = truth::numbers_of(t);
  EXPECT_NEAR(n.inertance, 21.768, 5e-4);
  EXPECT_NEAR(n.laminar, 154.80, 5e-3);
  EXPECT_NEAR(n.turbulent, 340.38, 5e-3);
}

// Law. On a bench each linear part has its closed form in a steady sine: a resonant machine, a relaxing branch, a mount
// in series with all of it.
TEST(TruthRig, AnswersASineOnTheBenchWithTheClosedForm) {
  const double omega = 2.0 * pi * 10.0;
  const Complex s{0.0, omega};
  const auto response = [&](const Numbers& n) {
    const Signal signal = sine(1e-3, omega, 4.0);
    Rig rig(n, signal, fine, 4.0, nullptr);
    Complex force;
    for (int node = 0; node < 80000; ++node) {
      if (node >= 60000) force += std::polar(2.0 / 20.0, -omega * node * fine) * Complex{0.0, 1.0} * rig.values().force;
      rig.step();
    }
    return force;
  };
  Numbers n = paper_car();
  n.kind = Kind::component_bench;
  const Complex plain = n.spring + n.damping * s;

  Numbers resonant = n;
  resonant.machine_turn = 2.0 * pi * 25.0;
  resonant.machine_ratio = 0.4;
  const double turn = resonant.machine_turn;
  EXPECT_LT(std::abs(response(resonant) / (plain * turn * turn / (s * s + 0.8 * turn * s + turn * turn)) - 1.0), 1e-6);

  Numbers relaxing = n;
  relaxing.maxwell = 8000.0;
  relaxing.maxwell_time = 0.03;
  const Complex relaxed = plain + 8000.0 * 0.03 * s / (1.0 + 0.03 * s);
  EXPECT_LT(std::abs(response(relaxing) / relaxed - 1.0), 1e-6);

  relaxing.mount = 2e5;
  EXPECT_LT(std::abs(response(relaxing) / (relaxed * 2e5 / (2e5 + relaxed)) - 1.0), 1e-6);

  Numbers undamped = n;  // where the mount's deflection follows at once
  undamped.damping = 0.0;
  undamped.mount = 2e5;
  EXPECT_LT(std::abs(response(undamped) / (31500.0 * 2e5 / (2e5 + 31500.0)) - 1.0), 1e-6);
}

// Point. The seal stops a free piston after b v²/2F, where it stays.
TEST(TruthRig, StopsThePistonWhereTheWorkOfItsSealSays) {
  Numbers n;
  n.kind = Kind::component_bench;
  n.fdva = true;
  n.inertance = 20.0;
  n.seal = 30.0;
  const Signal still = silence();
  Rig rig(n, still, fine, 1.0, nullptr);
  rig.state()[Rig::vy] = 0.3;
  for (int i = 0; i < 20000; ++i) rig.step();
  EXPECT_NEAR(rig.state()[Rig::y], 20.0 * 0.3 * 0.3 / 60.0, 1e-11);
}

// Point. The wheel that leaves the road carries nothing: F_w stops at minus the static load, (m_b + m_w) g, and reaches
// it.
TEST(TruthSimulation, NeverPullsTheWheelToTheRoad) {
  Truth t = truth::draw("single:quarter_car:tyre_lift_off", 1);
  t.records.resize(1);
  t.records[0].duration = 5.0;
  const std::vector<double> load = truth::simulate(t, {20, false})[0].channels["F_w"];
  EXPECT_DOUBLE_EQ(*std::min_element(load.begin(), load.end()),
                   -(t.actual["body.mass"] + t.actual["wheel.mass"]) * 9.81);
}

// Point. The mass between force sensor and wheel spring adds itself times z̈_r to F_w and changes nothing else.
TEST(TruthSimulation, AddsTheInertiaOfTheForceSensor) {
  Truth t = truth::draw("none:quarter_car", 1);
  t.records.resize(1);
  t.records[0].duration = 2.0;
  t.records[0].warm = 0.0;
  truth::Record without = truth::simulate(t, {20, false})[0];
  t.effects = {{"force_sensor_inertia", "", {{"mass", 3.0}}}};
  truth::Record with = truth::simulate(t, {20, false})[0];
  for (std::size_t i = 0; i < with.time.size(); ++i)
    ASSERT_NEAR(with.channels["F_w"][i], without.channels["F_w"][i] + 3.0 * without.channels["zdd_r"][i], 1e-9);
  EXPECT_EQ(with.channels["zdd_w"], without.channels["zdd_w"]);
}

// Point. The mass that moves in front of the load cell adds itself times ẍ_act to F, behind delay, lag and resonance
// too: held against the second difference of x_act at 20 kHz (its error: (ωh)²/12 = 5e-6 at 25 Hz).
TEST(TruthSimulation, AddsTheInertiaOfTheMovingMass) {
  const std::vector<std::vector<truth::Effect>> machines{
      {},
      {{"actuator_delay", "", {{"delay", 4e-3}}}},
      {{"actuator_delay", "", {{"delay", 4e-3}}}, {"actuator_lag", "", {{"time_constant", 5e-3}}}},
      {{"actuator_resonance", "", {{"frequency", 30.0}, {"damping_ratio", 0.5}}}}};
  for (const std::vector<truth::Effect>& machine : machines) {
    Truth t = bench_with({"sensor_gain", "x_act", {{"gain", 1.0}}});
    t.sample_rate = 20e3;
    t.records[0].duration = 1.5;
    t.effects = machine;
    truth::Record without = truth::simulate(t, {20, false})[0];
    t.effects.push_back({"moving_mass", "", {{"mass", 7.0}}});
    truth::Record with = truth::simulate(t, {20, false})[0];
    const std::vector<double>&x = with.channels["x_act"], &F = with.channels["F"], &F_0 = without.channels["F"];
    double worst = 0.0, largest = 0.0;
    for (std::size_t i = 2001; i + 1 < x.size(); ++i) {
      const double inertia = 7.0 * (x[i + 1] - 2.0 * x[i] + x[i - 1]) * 20e3 * 20e3;
      worst = std::max(worst, std::abs(F[i] - F_0[i] - inertia));
      largest = std::max(largest, std::abs(inertia));
    }
    EXPECT_GT(largest, 10.0);
    EXPECT_LT(worst, 1e-4 * largest);
  }
}

// Point. A delay in machine or sensor is that of the continuous motion: x_act is x_cmd at an instant between samples.
TEST(TruthSimulation, DelaysTheContinuousMotion) {
  const double delay = 7.3e-3;
  const Truth by_machine = bench_with({"actuator_delay", "", {{"delay", delay}}});
  const Truth by_sensor = bench_with({"sensor_delay", "x_act", {{"delay", delay}}});
  const Signal signal(by_machine.records[0], true);
  const std::vector<double> machine = truth::simulate(by_machine)[0].channels["x_act"];
  const std::vector<double> sensor = truth::simulate(by_sensor)[0].channels["x_act"];
  for (std::size_t i = 100; i < machine.size(); ++i) {
    const double expected = signal.at(static_cast<double>(i) * 1e-3 - delay).position;
    ASSERT_NEAR(machine[i], expected, 1e-15);
    ASSERT_NEAR(sensor[i], expected, 1e-10);  // four points 50 µs apart
  }
}

// Law. A first-order lag is the same in the machine (a state of the integrator) and in a sensor (an exact recursion).
TEST(TruthSimulation, LagsAlikeInMachineAndSensor) {
  const auto a = truth::simulate(bench_with({"actuator_lag", "", {{"time_constant", 4e-3}}}))[0].channels["x_act"];
  const auto b = truth::simulate(bench_with({"sensor_lag", "x_act", {{"time_constant", 4e-3}}}))[0].channels["x_act"];
  EXPECT_LT(difference(a, b), 2e-6);  // u linear over 50 µs: (ωh)²/12 = 5e-6 at the band's end, 25 Hz
}

// Point. The machine never moves faster than its limit, follows while it can, and catches up.
TEST(TruthSimulation, LimitsTheVelocityOfTheMachine) {
  Truth t = bench_with({"actuator_rate_limit", "", {{"velocity", 0.15}}});
  truth::Record record = truth::simulate(t)[0];
  const std::vector<double>& x = record.channels["x_act"];
  const std::vector<double>& u = record.channels["x_cmd"];
  int following = 0;
  int limited = 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    ASSERT_LE(std::abs(x[i] - x[i - 1]), 0.15e-3 + 1e-12);
    if (x[i] == u[i]) ++following;
    if (std::abs(std::abs(x[i] - x[i - 1]) - 0.15e-3) < 1e-12) ++limited;
  }
  EXPECT_GT(following, 300);
  EXPECT_GT(limited, 300);
}

// Point. The laws of the component by hand: play without force, corners sharp, sign exact.
TEST(TruthSimulation, HasSharpLawsInTheComponent) {
  const auto check = [](const truth::Effect& effect, auto law) {
    const Truth t = bench_with(effect);
    const Signal signal(t.records[0], true);
    const std::vector<double> force = truth::simulate(t)[0].channels["F"];
    for (std::size_t i = 10; i < force.size(); ++i) {
      const Motion m = signal.at(static_cast<double>(i) * 1e-3);
      ASSERT_NEAR(force[i], law(m.position, m.velocity), 1e-7) << effect.name << " at sample " << i;
    }
  };
  const auto plain = [](double x, double v) { return 31500.0 * x + 1140.0 * v; };
  const auto sign = [](double v) { return v > 0.0 ? 1.0 : -1.0; };
  check({"backlash", "", {{"gap", 4e-3}}},
        [&](double x, double v) { return std::abs(x) < 2e-3 ? 0.0 : plain(x - 2e-3 * sign(x), v); });
  check({"coulomb_friction", "", {{"force", 50.0}}}, [&](double x, double v) { return plain(x, v) + 50.0 * sign(v); });
  check({"quadratic_damping", "", {{"coefficient", 400.0}}},
        [&](double x, double v) { return plain(x, v) + 400.0 * v * std::abs(v); });
  check({"viscous_damping", "", {{"damping", 200.0}}}, [&](double x, double v) { return plain(x, v) + 200.0 * v; });
  check({"progressive_spring", "", {{"cubic_stiffness", 3e7}}},
        [&](double x, double v) { return plain(x, v) + 3e7 * x * x * x; });
  check({"bump_stop", "", {{"clearance", 5e-3}, {"stiffness", 1e5}}},
        [&](double x, double v) { return plain(x, v) + 1e5 * std::max(0.0, std::abs(x) - 5e-3) * sign(x); });
  check({"sensor_gain", "F", {{"gain", 1.1}}}, [&](double x, double v) { return 1.1 * plain(x, v); });
  check({"sensor_offset", "F", {{"offset", -30.0}}}, [&](double x, double v) { return plain(x, v) - 30.0; });
  check({"sensor_saturation", "F", {{"limit", 200.0}}},
        [&](double x, double v) { return std::clamp(plain(x, v), -200.0, 200.0); });
}

// Point. Laws outside the catalogue by hand, at 20 mm as they are drawn; and what drifts, bends and jumps in a sensor.
TEST(TruthSimulation, HasTheLawsOutsideTheCatalogue) {
  constexpr double stroke = 20e-3;
  const auto bench_outside = [](const std::map<std::string, double>& parameters, const char* channel = "") {
    Truth t = bench_with({});
    t.effects.clear();
    t.unknown = "something";
    t.unknown_channel = channel;
    t.unknown_parameters = parameters;
    return t;
  };
  const auto check = [&](const Truth& t, auto law) {
    const Signal signal(t.records[0], true);
    const std::vector<double> force = truth::simulate(t)[0].channels["F"];
    for (std::size_t i = 10; i < force.size(); ++i) {
      const double time = static_cast<double>(i) * 1e-3;
      const Motion m = signal.at(time);
      ASSERT_NEAR(force[i], law(m.position, m.velocity, time), 1e-7) << t.unknown_parameters.begin()->first << " " << i;
    }
  };
  const auto plain = [](double x, double v) { return 31500.0 * x + 1140.0 * v; };
  check(bench_outside({{"leaf_friction", 0.1}}),
        [&](double x, double v, double) { return plain(x, v) + 0.1 * 31500.0 * std::abs(x) * std::tanh(v / 1e-3); });
  check(bench_outside({{"lopsided", 0.2}}),
        [&](double x, double v, double) { return plain(x, v) + 0.2 * 31500.0 * x * x / stroke; });
  check(bench_outside({{"stroke_damping", 2.0}}),
        [&](double x, double v, double) { return plain(x, v) + 2.0 * 1140.0 * v * x * x / (stroke * stroke); });
  check(bench_outside({{"bypass", 0.5}, {"bypass_width", 4e-3}}),
        [&](double x, double v, double) { return plain(x, v) + 0.5 * 1140.0 * v * std::tanh(x / 4e-3); });
  check(bench_outside({{"machine_curve", 0.1}}), [&](double x, double v, double) {
    const double share = 0.1 * x * x / (stroke * stroke);
    return plain(x * (1.0 - share), v * (1.0 - 3.0 * share));
  });
  check(bench_outside({{"zero_drift", 3.0}}, "F"), [&](double x, double v, double t) { return plain(x, v) + 3.0 * t; });
  check(bench_outside({{"bend", 1e-8}}, "F"),
        [&](double x, double v, double) { return plain(x, v) * (1.0 + 1e-8 * plain(x, v) * plain(x, v)); });

  const Truth late = bench_outside({{"clock_drift", 2e-3}}, "x_act");
  const std::vector<double> position = truth::simulate(late)[0].channels["x_act"];
  const Signal signal(late.records[0], true);
  for (std::size_t i = 10; i < position.size(); ++i) {
    ASSERT_NEAR(position[i], signal.at(static_cast<double>(i) * 1e-3 * (1.0 - 2e-3)).position, 1e-10) << i;
  }
  const std::vector<double> spiky = truth::simulate(bench_outside({{"spikes", 1.0}}, "F"))[0].channels["F"];
  const std::vector<double> smooth = truth::simulate(bench_outside({{"spikes", 0.0}}, "F"))[0].channels["F"];
  int spikes = 0;
  for (std::size_t i = 0; i < spiky.size(); ++i) {
    const double off = std::abs(spiky[i] - smooth[i]);
    if (off == 0.0) continue;
    ++spikes;
    ASSERT_NEAR(off, 1.0, 1e-9);
  }
  EXPECT_NEAR(spikes, 10, 10);  // one in 300, three standard deviations
  EXPECT_GT(spikes, 0);
}

// Point. A sensor that resonates answers a sine with 1/(1 − r² + 2iζr), r = f/f₀; after 2 s transients are e^{−ζω·2}
// < 1e-7.
TEST(TruthSimulation, ResonatesInASensor) {
  Truth t;
  t.unknown = "a sensor on a bracket that resonates";
  t.unknown_channel = "F";
  t.unknown_parameters = {{"sensor_frequency", 60.0}, {"sensor_ratio", 0.05}};
  truth::Sensor sensor(t, "F", std::vector<double>(5000), 0.0, 20);
  const double omega = 2.0 * pi * 25.0;
  Complex answer;
  for (int node = 0; node < 80000; ++node) {
    sensor.push(std::sin(omega * node * fine));
    if (node >= 40000)
      answer += 2.0 / 40000.0 * std::polar(1.0, -omega * node * fine) * Complex{0.0, 1.0} * sensor.newest();
  }
  const double r = 25.0 / 60.0;
  EXPECT_LT(std::abs(answer * Complex{1.0 - r * r, 2.0 * 0.05 * r} - 1.0), 1e-4);  // u linear: (ωh)²/12 = 5e-6
}

// Point. An imbalance is a force on the wheel, a relaxing tyre a spring more at once and none in the end: the wheel's
// load at rest and after a step of the road held still.
TEST(TruthRig, HasAPeriodicForceAndARelaxingTyre) {
  Numbers n = paper_car();
  n.imbalance = 40.0;
  n.imbalance_turn = 2.0 * pi * 12.0;
  const Signal still = silence();
  Rig shaken(n, still, fine, 1.0, nullptr);
  for (int i = 0; i < 20; ++i) shaken.step();
  EXPECT_NEAR(shaken.values().zdd_w * n.wheel, 40.0 * std::sin(n.imbalance_turn * 1e-3), 0.05);  // + forces of 1 µm

  Numbers tyre = paper_car();
  tyre.tyre_maxwell = 3e4;
  tyre.tyre_time = 10e-3;
  Rig relaxing(tyre, still, fine, 1.0, nullptr);
  relaxing.state()[Rig::zw] = -1e-3;
  EXPECT_NEAR(relaxing.values().wheel_load, (tyre.tyre + 3e4) * 1e-3, 1e-9);
  relaxing.state()[Rig::tyre_x] = 1e-3;
  EXPECT_NEAR(relaxing.values().wheel_load, tyre.tyre * 1e-3, 1e-9);
}

// Point. A held channel repeats itself and holds its noise too: with a period of 5 ms one sample in five is new.
TEST(TruthSimulation, HoldsSignalAndNoise) {
  Truth t = bench_with({"sensor_hold", "F", {{"period", 5e-3}}});
  t.noise["F"] = 10.0;
  const std::vector<double> force = truth::simulate(t)[0].channels["F"];
  int renewals = 0;
  for (std::size_t i = 1; i < force.size(); ++i) renewals += force[i] != force[i - 1] ? 1 : 0;
  EXPECT_NEAR(renewals, 600, 1);
}

// Law. The noise is white, as strong as said and independent of what hides: it is what a run without noise lacks.
TEST(TruthSimulation, AddsTheNoiseItSays) {
  Truth t = truth::draw("none:quarter_car", 3);
  t.records.resize(1);
  t.records[0].duration = 4.0;
  t.records[0].warm = 0.0;
  truth::Record with = truth::simulate(t)[0];
  truth::Record without = truth::simulate(t, {20, false})[0];
  for (const auto& [channel, rms] : t.noise) {
    double power = 0.0;
    double neighbours = 0.0;
    double last = 0.0;
    for (std::size_t i = 0; i < with.time.size(); ++i) {
      const double noise = (with.channels[channel][i] - without.channels[channel][i]) / rms;
      power += noise * noise;
      neighbours += noise * last;
      last = noise;
    }
    const double count = static_cast<double>(with.time.size());
    EXPECT_NEAR(power / count, 1.0, 5.0 * std::sqrt(2.0 / count)) << channel;
    EXPECT_NEAR(neighbours / count, 0.0, 5.0 / std::sqrt(count)) << channel;
  }
}

// Order. Halving the step moves no channel by more than 1e-4 of itself, for the laws with corners and events on every
// rig. Without corners the two runs agree to 1e-8.
TEST(TruthSimulation, IsFineEnoughForCornersAndEvents) {
  for (const char* group :
       {"none:quarter_car", "none:hil", "single:quarter_car:coulomb_friction", "single:quarter_car:backlash",
        "single:quarter_car:body_guide_friction", "single:quarter_car:seal_friction",
        "single:quarter_car:tyre_lift_off", "single:quarter_car:bump_stop", "single:quarter_car:top_mount",
        "single:quarter_car:sensor_hold:zdd_r", "single:hil:coulomb_friction", "single:hil:actuator_rate_limit",
        "single:hil:sensor_hold:F", "single:hil:sensor_lag:F", "single:hil:actuator_delay",
        "single:component_bench:actuator_rate_limit", "unknown:quarter_car:stribeck_friction",
        "unknown:quarter_car:leaf_friction", "unknown:component_bench:sensor_resonance"}) {
    Truth t = truth::draw(group, 5);
    t.records.resize(1);
    t.records[0].duration = 3.0;
    t.records[0].warm = 0.0;
    const truth::Record coarse = truth::simulate(t, {20, false})[0];
    truth::Record half = truth::simulate(t, {40, false})[0];
    const double bound = std::string(group).starts_with("none") ? 1e-8 : 1e-4;
    for (const auto& [channel, values] : coarse.channels)
      EXPECT_LT(difference(values, half.channels[channel]), bound) << group << " " << channel;
  }
}

// Journey. Every group draws a rig inside its tolerances whose effect can be seen, and simulates to finite numbers.
TEST(TruthGroups, AllDrawAndSimulate) {
  const std::vector<std::string> all = truth::groups();
  EXPECT_GE(
      std::count_if(all.begin(), all.end(), [](const std::string& g) { return g.starts_with("unknown:quarter_car"); }),
      8);
  for (const std::string& group : all) {
    Truth t = truth::draw(group, 7);
    for (const auto& [path, value] : t.nominal) {
      const double allowed = t.tolerance.contains(path) ? t.tolerance.at(path) : 0.0;
      EXPECT_LE(std::abs(t.actual.at(path) - value), allowed * value * (1.0 + 1e-12)) << group << " " << path;
    }
    if (t.group != "none") {
      EXPECT_GT(t.size, 2.0) << group;
      EXPECT_LT(t.size, 400.0) << group;
    }
    EXPECT_EQ(t.unknown.empty(), t.group != "unknown");
    t.records.resize(1);
    t.records[0].duration = 1.0;
    t.records[0].warm = 0.0;
    const truth::Record record = truth::simulate(t, {4, true})[0];
    ASSERT_EQ(record.time.size(), 1000U);
    for (const std::string& channel : truth::channels_of(t.kind)) {
      ASSERT_EQ(record.channels.at(channel).size(), 1000U) << group << " " << channel;
      EXPECT_TRUE(std::all_of(record.channels.at(channel).begin(), record.channels.at(channel).end(),
                              [](double x) { return std::isfinite(x); }))
          << group << " " << channel;
    }
  }
}

// Law. A seed is a recording: same group and seed, same bytes; another seed, another rig.
TEST(TruthGroups, GiveTheSameBytesForTheSameSeed) {
  const auto all_of_it = [](std::uint64_t seed) {
    Truth t = truth::draw("pair", seed);
    for (truth::RecordPlan& plan : t.records) plan.duration = 1.0;
    return truth::rig_toml(t) + truth::truth_json(t) + truth::csv(t, truth::simulate(t)[0]);
  };
  EXPECT_EQ(all_of_it(11), all_of_it(11));
  EXPECT_NE(all_of_it(11), all_of_it(12));
}

// Point. Weak effects amount to 30 … 100 σ over all channels and samples.
TEST(TruthGroups, CanBeWeak) {
  const Truth t = truth::draw("single:quarter_car:viscous_damping", 1, {true, 30.0});
  EXPECT_GT(t.size * std::sqrt(30000.0), 10.0);
  EXPECT_LT(t.size * std::sqrt(30000.0), 100.0);
}

// Law. Varied rigs differ in what is promised, by what is promised; and simulate to finite numbers at their rate.
TEST(TruthGroups, CanBeOtherRigsRoadsAndSensors) {
  std::set<double> rates, masses;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Truth usual = truth::draw("none:quarter_car", seed);
    Truth varied = truth::draw("none:quarter_car", seed, {false, 1.0, true});
    rates.insert(varied.sample_rate);
    masses.insert(varied.nominal.at("body.mass"));
    for (const auto& [channel, rms] : varied.noise) {
      EXPECT_LT(std::abs(std::log(rms / usual.noise.at(channel))), std::log(3.02)) << seed << " " << channel;
    }
    for (const auto& [path, value] : varied.nominal) {
      EXPECT_LT(std::abs(std::log(value / usual.nominal.at(path))), std::log(1.52)) << seed << " " << path;
    }
    varied.records.resize(1);
    varied.records[0].warm = 0.0;
    const truth::Record record = truth::simulate(varied)[0];
    ASSERT_EQ(static_cast<double>(record.time.size()), varied.records[0].duration * varied.sample_rate) << seed;
    for (const auto& [channel, values] : record.channels) {
      EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); })) << channel;
    }
  }
  EXPECT_EQ(rates, (std::set<double>{500.0, 1000.0, 2000.0}));
  EXPECT_EQ(masses.size(), 8U);
}

// Fault. A group there is not, and an effect on a rig that has no such part, are refused.
TEST(TruthGroups, RefuseWhatDoesNotExist) {
  EXPECT_THROW((void)truth::draw("single:ghost", 1), std::invalid_argument);
  EXPECT_THROW((void)truth::draw("single:quarter_car:actuator_delay", 1), std::invalid_argument);
  EXPECT_THROW((void)truth::simulate(bench_with({"body_guide_friction", "", {{"force", 1.0}}})), std::invalid_argument);
}

}  // namespace
