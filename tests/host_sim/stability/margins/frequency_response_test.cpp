// Bode and Nyquist data against formulas written by hand.
#include "host_sim/stability/margins/frequency_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/stability/roots/characteristic_roots.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using namespace host_sim::stability;
using model::Channel;
using stability_tests::fdva_rig;
using stability_tests::linear_rig;
using stability_tests::random_rig;
using stability_tests::Rig;

constexpr double turn = 2.0 * std::numbers::pi;

// Law. Every output is that of equations (1)–(3) solved by hand: with D the complex stiffness between wheel and body,
// z_w (m_w s² + b_t s + k_t + D) − D z_b = (k_t + b_t s) z_r and z_b (m_b s² + D) = D z_w.
TEST(RoadResponse, SolvesTheQuarterCarWithTheDelayedComponent) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const Rig rig = random_rig(seed, seed % 2 == 0);
    if (rig.effects.get<model::TopMount>().active) continue;  // settled within 0.1 µs, not exact
    const LinearRig linear = linearise(rig);
    const double extra = 0.001, delay = linear.delay() + extra;
    const RoadResponse response(linear, delay, linear.machine_delay);
    for (const double hz : {0.3, 1.5, 8.0, 14.0, 60.0}) {
      const Complex s(0.0, turn * hz);
      const Complex behind = std::exp(-s * (delay - linear.machine_delay));
      const Complex k = stability_tests::component_by_hand(rig, s);
      Rig machine_only = rig;
      machine_only.effects.get<model::SensorLag>(Channel::F).active = false;
      machine_only.effects.get<model::SensorGain>(Channel::F).active = false;
      const Complex machine = stability_tests::path_by_hand(machine_only, s) * std::exp(-s * linear.machine_delay);
      const Complex sensor = stability_tests::path_by_hand(rig, s) / stability_tests::path_by_hand(machine_only, s);
      const Complex d = k * machine * sensor * behind + rig.machine.virtual_damping * s;
      const Complex road = rig.tyre.stiffness + rig.tyre.damping * s;
      const Complex b_over_w = d / (rig.body.mass * s * s + d);
      const Complex z_w = road / (rig.wheel.mass * s * s + road + d - d * b_over_w), z_b = b_over_w * z_w;
      const auto expect = [&](Channel channel, Complex expected) {
        EXPECT_LT(std::abs(response(channel, turn * hz) - expected), 1e-9 * std::abs(expected))
            << model::name(channel) << " at " << hz;
      };
      expect(Channel::z_w, z_w);
      expect(Channel::z_b, z_b);
      expect(Channel::zdd_w, s * s * z_w);
      expect(Channel::zdd_b, s * s * z_b);
      expect(Channel::dz_w, 1.0 - z_w);
      expect(Channel::dz_b, z_w - z_b);
      expect(Channel::x_cmd, z_w - z_b);
      expect(Channel::F_w, road * (1.0 - z_w));
      expect(Channel::x_act, machine * (z_w - z_b));
      expect(Channel::F, k * machine * (z_w - z_b));
    }
  }
}

// Law. The unwrapped phase is that of the response up to whole turns, and follows a delay beyond any of them: behind
// the loop's own 10 ms, x_act lags x_cmd by 360° · f · τ.
TEST(Bode, UnwrapsThePhaseOfALongDelay) {
  const double delay = 0.3;
  const LinearRig rig = linearise(linear_rig(delay, 1140.0));
  const BodeData data = bode(rig, delay, delay, frequencies(0.1, 100.0, 200, {}));
  const auto output = [&](const std::string& name) {
    for (const auto& curve : data.outputs) {
      if (curve.name == name) return curve;
    }
    throw std::out_of_range(name);
  };
  const ResponseCurve command = output("x_cmd"), reached = output("x_act");
  ASSERT_EQ(data.outputs.size(), 10U);
  const RoadResponse response(rig, delay, delay);
  for (std::size_t i = 0; i < data.frequency_hz.size(); ++i) {
    const double hz = data.frequency_hz[i];
    EXPECT_NEAR(reached.phase[i] - command.phase[i] + turn * hz * delay,
                std::round((reached.phase[i] - command.phase[i] + turn * hz * delay) / turn) * turn, 1e-8);
    EXPECT_NEAR(reached.phase[i] - command.phase[i] - (reached.phase[0] - command.phase[0]),
                -turn * (hz - data.frequency_hz[0]) * delay, 1e-7);
    EXPECT_NEAR(std::abs(std::polar(reached.magnitude[i], reached.phase[i]) - response(Channel::x_act, turn * hz)), 0.0,
                1e-9);
  }
}

// Point. The grid has the ends that were asked for, ascends, and is finer around a weakly damped root.
TEST(Bode, GridIsFinerAroundWeaklyDampedRoots) {
  const auto hz = frequencies(0.1, 100.0, 100, {Complex(-0.5, turn * 13.4), Complex(-80.0, 90.0)});
  EXPECT_DOUBLE_EQ(hz.front(), 0.1);
  EXPECT_NEAR(hz.back(), 100.0, 1e-10);
  EXPECT_TRUE(std::is_sorted(hz.begin(), hz.end()));
  EXPECT_EQ(hz.size(), 161U);
  int close = 0;
  for (const double f : hz) close += std::abs(f - 13.4) < 0.5 / turn ? 1 : 0;
  EXPECT_GT(close, 10);
}

// Law. Encirclements counted on the curve and poles of L give the unstable roots that the argument principle counts.
TEST(Nyquist, CountsTheUnstableRoots) {
  int unstable = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const LinearRig rig = linearise(random_rig(seed, true));
    const DelayEquation equation = rig.equation(seed % 3 == 0 ? 0.05 : rig.delay());
    const RootSet set = characteristic_roots(equation, -60.0);
    const NyquistData data = nyquist(equation, set.roots);
    EXPECT_EQ(data.closed_loop_unstable, equation.roots_right_of(1e-7));
    EXPECT_EQ(data.closed_loop_unstable, data.open_loop_unstable - data.encirclements);
    unstable += data.closed_loop_unstable > 0 ? 1 : 0;
    for (std::size_t i = 0; i < data.loop.size(); i += 50) {
      const Complex s(data.offset, data.omega[i]);
      EXPECT_LT(std::abs(data.loop[i] * equation.p()(s) - equation.q()(s) * equation.delayed(s)),
                1e-10 * equation.scale(s));
    }
  }
  EXPECT_GT(unstable, 10);  // both kinds were among them
  EXPECT_LT(unstable, 50);
}

}  // namespace
