// Crossings, Padé, margins, critical damping and sensitivities: each against the definition it shortens.
#include "host_sim/stability/margins/margins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "host_sim/stability/margins/affine_family.hpp"
#include "host_sim/stability/margins/analysis.hpp"
#include "tests/host_sim/stability/rigs.hpp"

namespace {

using namespace host_sim::stability;
using stability_tests::described;
using stability_tests::fdva_rig;
using stability_tests::linear_rig;
using stability_tests::random_rig;
using stability_tests::Rig;

constexpr double pi = std::numbers::pi;

double rightmost(const DelayEquation& equation) { return characteristic_roots(equation, -60.0).rightmost().real(); }

// Point. ẋ = −a x(t − τ) loses its stability at τ = π/(2a) with ω = a, and again every 2π/a.
TEST(Crossings, OfTheSimplestLoop) {
  const double a = 3.0;
  const auto frequencies = crossing_frequencies({0.0, 1.0}, {a});
  ASSERT_EQ(frequencies.size(), 1U);
  EXPECT_NEAR(frequencies[0].omega, a, 1e-15 * a);
  EXPECT_NEAR(frequencies[0].first, pi / (2.0 * a), 1e-15);
  EXPECT_EQ(frequencies[0].direction, 1);
  const auto all = crossings(crossing_frequencies({0.0, 1.0}, {20.0}), 1.0);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_NEAR(all[2].delay - all[1].delay, 2.0 * pi / 20.0, 1e-15);
}

// Law. At every crossing a root is on the axis, and passes it in the direction that is given.
TEST(Crossings, PutARootOnTheAxisAndTellItsDirection) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const LinearRig rig = linearise(random_rig(seed, true));
    const auto frequencies = crossing_frequencies(rig.p, rig.q);
    for (const Crossing& c : crossings(frequencies, 0.06)) {
      const DelayEquation equation = rig.equation(c.delay);
      const Complex s(0.0, c.omega);
      EXPECT_LT(std::abs(equation(s)), 1e-14 * equation.scale(s));  // some roundings
      const Complex moves = -equation.by_delay(s) / equation.jet(s)[1];
      EXPECT_EQ(moves.real() > 0.0 ? 1 : -1, c.direction);
    }
  }
}

// Law. Inside a stable range the loop is stable, outside it is not.
TEST(Crossings, StableRangesAreThoseOfTheRoots) {
  for (unsigned seed = 1; seed <= 25; ++seed) {
    SCOPED_TRACE(seed);
    const LinearRig rig = linearise(random_rig(seed, false));
    const auto ranges = stable_ranges(rig.p, rig.q, crossing_frequencies(rig.p, rig.q));
    std::mt19937_64 random(seed);
    for (int i = 0; i < 6; ++i) {
      const double delay = std::uniform_real_distribution<double>(0.0, 0.06)(random);
      bool inside = false;
      for (const auto& range : ranges) inside = inside || (delay > range.from && delay < range.to);
      EXPECT_EQ(rightmost(rig.equation(delay)) < 0.0, inside) << delay;
    }
  }
}

// Point. Denominators of the approximations of order 1 and 2 as in every textbook.
TEST(Pade, HasTheTextbooksDenominators) {
  EXPECT_DOUBLE_EQ(pade_denominator(1)[1], 0.5);
  EXPECT_DOUBLE_EQ(pade_denominator(2)[1], 0.5);
  EXPECT_DOUBLE_EQ(pade_denominator(2)[2], 1.0 / 12.0);
  EXPECT_DOUBLE_EQ(pade_denominator(3)[3], 1.0 / 120.0);
}

// Law. With the approximation in place of the delay, the polynomial has a root on the axis there and is stable before.
TEST(Pade, CriticalDelayIsThatOfThePolynomial) {
  for (const Rig& rig : {linear_rig(), fdva_rig(0.010, 1140.0), random_rig(7, true)}) {
    const LinearRig linear = linearise(rig);
    const auto frequencies = crossing_frequencies(linear.p, linear.q);
    const auto exact = crossings(frequencies, longest_delay).front().delay;
    for (int order = 1; order <= 5; ++order) {
      SCOPED_TRACE(order);
      const PadeResult pade = pade_critical_delay(order, frequencies, exact);
      ASSERT_TRUE(pade.critical_delay);
      EXPECT_NEAR(*pade.error, *pade.critical_delay / exact - 1.0, 1e-12);
      EXPECT_EQ(pade.unsafe, *pade.critical_delay > exact);
      const auto highest = [&](double delay) {
        const Polynomial d = pade_denominator(order).stretched(delay);
        double re = -1e300;
        for (const Complex s : roots(linear.p * d + linear.q * d.mirrored())) {
          // Only the pair in question: Padé's own poles are far away.
          if (std::abs(std::abs(s.imag()) - pade.omega) < 0.2 * pade.omega) re = std::max(re, s.real());
        }
        return re;
      };
      EXPECT_NEAR(highest(*pade.critical_delay), 0.0, 1e-6);
      EXPECT_LT(highest(0.98 * *pade.critical_delay), 0.0);
      EXPECT_GT(highest(1.02 * *pade.critical_delay), 0.0);
    }
  }
}

// Law. Each margin, applied, leads to the border: the gain as a factor of Q, phase and delay as what they are.
TEST(Margins, LeadToTheBorder) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const LinearRig rig = linearise(random_rig(seed, true));
    const DelayEquation equation = rig.equation(rig.delay());
    const bool stable = rightmost(equation) < 0.0;
    const Margins m = margins(equation, stable);
    const double size = 1e-8 * 100.0;  // of the root: 1e-8 of its modulus, which is below 100 1/s or so
    if (m.delay_margin) {
      EXPECT_NEAR(rightmost(rig.equation(rig.delay() + *m.delay_margin)), 0.0, size);
      EXPECT_EQ(stable || *m.delay_margin > 0.0, *m.delay_margin > 0.0);
    }
    for (const auto& gain : {m.upper_gain, m.lower_gain}) {
      if (!gain) continue;
      EXPECT_NEAR(rightmost({rig.p, gain->factor * rig.q, rig.delay()}), 0.0, size) << gain->factor;
    }
    EXPECT_GT(m.upper_gain.value_or(GainMargin{2.0, 0.0}).factor, 1.0);
    EXPECT_LT(m.lower_gain.value_or(GainMargin{0.5, 0.0}).factor, 1.0);
    if (stable && m.upper_gain) {  // the border that is given is the first
      for (const double share : {0.2, 0.5, 0.8}) {
        const double factor = 1.0 + share * (m.upper_gain->factor - 1.0);
        EXPECT_LT(rightmost({rig.p, factor * rig.q, rig.delay()}), 0.0);
      }
    }
    if (m.phase_margin && stable) {
      // L turned by −φ has its −1: P − … the loop Q e^{−sτ} e^{−jφ} on the axis.
      const Complex s(0.0, m.phase_margin_omega);
      const Complex turned = equation.q()(s) * equation.delayed(s) * std::polar(1.0, -*m.phase_margin);
      EXPECT_LT(std::abs(equation.p()(s) + turned), 1e-9 * equation.scale(s));
    }
  }
}

// Point. s² + 5s + 2500 + 8s e^{−sτ} crosses where |2500 − ω²| = √(8² − 5²) ω and cos ωτ = −5/8: it is lost at the
// upper frequency, won back at the lower one, and lost again. From the second range the next border counts, not the
// first.
TEST(Margins, LookAheadFromASecondStableRange) {
  const double half = std::sqrt(39.0) / 2.0, upper = half + std::sqrt(half * half + 2500.0), lower = upper - 2.0 * half;
  const double angle = std::acos(-5.0 / 8.0);
  const double lost = angle / upper, won = (2.0 * pi - angle) / lower, lost_again = (angle + 2.0 * pi) / upper;
  const DelayEquation equation({2500.0, 5.0, 1.0}, {0.0, 8.0}, 0.1);
  EXPECT_LT(rightmost(equation), 0.0);
  const Margins m = margins(equation, true);
  EXPECT_NEAR(*m.critical_delay, lost, 1e-14);
  EXPECT_NEAR(*m.delay_margin, lost_again - 0.1, 1e-14);
  EXPECT_NEAR(m.delay_margin_omega, upper, 1e-12);
  ASSERT_GE(m.stable_delays.size(), 2U);
  EXPECT_EQ(m.stable_delays[0].from, 0.0);
  EXPECT_NEAR(m.stable_delays[0].to, lost, 1e-14);
  EXPECT_NEAR(m.stable_delays[1].from, won, 1e-14);
  EXPECT_NEAR(m.stable_delays[1].to, lost_again, 1e-14);
  // In the gap between, less delay is nearer to stability than more.
  const Margins unstable = margins({equation.p(), equation.q(), 0.05}, false);
  EXPECT_NEAR(*unstable.delay_margin, lost - 0.05, 1e-14);
  EXPECT_NEAR(unstable.delay_margin_omega, upper, 1e-12);
}

// Law. The sensitivity peak is max |P/f| on the axis.
TEST(Margins, SensitivityPeakIsTheHighest) {
  const LinearRig rig = linearise(fdva_rig());
  const DelayEquation equation = rig.equation(0.010);
  const SensitivityPeak peak = sensitivity_peak(equation);
  double highest = 0.0;
  for (double omega = 1.0; omega < 200.0; omega += 1e-3) {
    const Complex s(0.0, omega);
    highest = std::max(highest, std::abs(equation.p()(s) / equation(s)));
  }
  EXPECT_NEAR(peak.value, highest, 1e-6 * highest);
}

// Law. All zeros of a trigonometric polynomial, close and distant ones, and no others; a double zero counts as one.
TEST(TrigonometricPolynomial, HasAllItsZeros) {
  const TrigonometricPolynomial cosine{{-0.5}, {1.0}, {}, 3.0};  // cos 3x = 1/2
  const auto found = zeros(cosine, 0.0, 10.0);
  ASSERT_EQ(found.size(), 9U);  // ±π/9 + 2πk/3
  EXPECT_NEAR(found[0], pi / 9.0, 1e-14);
  EXPECT_NEAR(found[1], 2.0 * pi / 3.0 - pi / 9.0, 1e-14);
  const TrigonometricPolynomial twice{{-1.0}, {1.0}, {}, 1.0};  // cos x = 1 touches at 2π
  EXPECT_EQ(zeros(twice, 1.0, 10.0).size(), 1U);
  const TrigonometricPolynomial close{{(1.0 - 1e-3) * (1.0 + 1e-3), -2.0, 1.0}, {}, {}, 0.0};
  ASSERT_EQ(zeros(close, 0.0, 5.0).size(), 2U);
  EXPECT_NEAR(zeros(close, 0.0, 5.0)[0], 0.999, 1e-12);
  const TrigonometricPolynomial g{{1.0, 2.0}, {0.5, 0.0, 1.0}, {-1.0, 0.3}, 4.0};
  const auto slope = g.derivative();
  for (const double x : {-1.0, 0.4, 2.0}) {
    EXPECT_NEAR(slope(x), (g(x + 1e-6) - g(x - 1e-6)) / 2e-6, 1e-7);
    for (const double t : {-0.2, -0.1, 0.05, 0.2})
      EXPECT_LE(std::abs(g(x + t) - g(x)), g.variation(x, 0.2) * (1 + 1e-12));
  }
}

// Law. Every virtual damping with a root on the axis is found: between them the number of unstable roots stays, at
// each it changes.
TEST(CriticalDamping, AllBordersAreFound) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Rig rig = random_rig(seed, true);
    const auto equation = [&](double damping) {
      rig.machine.virtual_damping = damping;
      const LinearRig linear = linearise(rig);
      return linear.equation(linear.delay());
    };
    const AffineFamily family = affine_family(
        [&](double damping) {
          const DelayEquation e = equation(damping);
          return LoopPolynomials{e.p(), e.q()};
        },
        1024.0);
    const double delay = linearise(rig).delay();
    const auto found = axis_values(family, delay, 0.0, 10'000.0);
    const auto unstable = [&](double damping) { return equation(damping).roots_right_of(1e-7); };
    for (const AxisValue& v : found) {
      const Complex s(0.0, v.omega);
      EXPECT_LT(std::abs(equation(v.value)(s)), 1e-10 * equation(v.value).scale(s));
      const double beside = 1e-4 * (1.0 + v.value);
      if (v.value > beside) {
        EXPECT_EQ(std::abs(unstable(v.value + beside) - unstable(v.value - beside)), 2) << v.value;
        EXPECT_EQ(v.border, unstable(v.value + beside) == 0 || unstable(v.value - beside) == 0);
      }
    }
    std::size_t next = 0;
    int count = unstable(0.0);
    for (int i = 1; i <= 100; ++i) {
      const double damping = 100.0 * i;
      bool passed = false;
      for (; next < found.size() && found[next].value < damping; ++next) passed = true;
      const int now = unstable(damping);
      EXPECT_TRUE(passed || now == count) << damping;
      count = now;
    }
  }
}

// Fault. A parameter that does not enter linearly is not taken for one that does.
TEST(AffineFamily, RefusesACurve) {
  EXPECT_THROW(static_cast<void>(affine_family(
                   [](double k) {
                     return LoopPolynomials{{1.0, 1.0 + k * k, 1.0}, {1.0}};
                   },
                   1.0)),
               std::logic_error);
}

// Law. Sensitivities are what roots and critical delay do when the parameter is changed and everything found anew.
TEST(Sensitivity, IsTheChangeOfTheRootsFoundAnew) {
  Rig rig = fdva_rig();
  rig.effects.add(model::ActuatorLag<double>{0.001});
  rig.effects.add(model::Channel::F, model::SensorDelay<double>{0.0005});
  auto description = described(rig);
  description.delay_budget.transport = 0.0005;
  const StabilityAnalysis a = analyse(description);
  EXPECT_GE(a.parameters.size(), 16U);
  for (const ParameterSensitivity& s : a.parameters) {
    SCOPED_TRACE(s.path);
    EXPECT_LT(s.error, 1e-6);
    if (s.path == "loop delay") continue;
    const double h = 1e-4;
    const auto at = [&](double relative) {
      auto changed = description;
      *firmware::find_parameter(changed.rig, s.path) *= 1.0 + relative;
      return analyse(changed);
    };
    const StabilityAnalysis up = at(h), down = at(-h);
    const Complex difference = (up.roots.rightmost() - down.roots.rightmost()) / (2.0 * h);
    EXPECT_LT(std::abs(difference - s.root_change), 1e-4 * (std::abs(difference) + 0.1));
    const Complex critical = (up.critical_root - down.critical_root) / (2.0 * h);
    EXPECT_LT(std::abs(critical - s.critical_root_change), 1e-4 * (std::abs(critical) + 0.1));
    const double later = (*up.margins.critical_delay - *down.margins.critical_delay) / (2.0 * h);
    EXPECT_NEAR(later, s.critical_delay_change, 1e-4 * std::abs(later) + 1e-9);
  }
  // The loop delay's own, against the delay of the machine, which is a part of it.
  const auto of = [&](const std::string& path) {
    return *std::find_if(a.parameters.begin(), a.parameters.end(), [&](const auto& s) { return s.path == path; });
  };
  const Complex machine = of("effects.actuator_delay.delay").root_change / 0.010;
  EXPECT_LT(std::abs(of("loop delay").root_change / 0.011 - machine), 1e-6 * std::abs(machine));
  EXPECT_EQ(of("fdva.minor_loss").root_change, Complex());
  const Complex critical = of("effects.actuator_delay.delay").critical_root_change / 0.010;
  EXPECT_LT(std::abs(of("loop delay").critical_root_change / 0.011 - critical), 1e-6 * std::abs(critical));
}

// Point. The paper's rig is not threatened by its rightmost root, the body mode, but by the wheel mode of physics.md
// section 6; where the loop is unstable already, the critical root is the unstable one.
TEST(CriticalRoot, IsTheOneThatGoes) {
  const StabilityAnalysis stable = analyse(described(fdva_rig()));
  EXPECT_NEAR(stable.critical_root.real(), -2.3945, 5e-5);
  EXPECT_NEAR(stable.critical_root.imag(), 83.902, 5e-4);
  Rig rig = fdva_rig();
  rig.machine.virtual_damping = 700.0;
  const StabilityAnalysis unstable = analyse(described(rig));
  EXPECT_NEAR(unstable.critical_root.real(), 2.1685, 5e-5);
  EXPECT_LT(std::abs(unstable.critical_root - unstable.roots.rightmost()), 1e-9);
}

// Law. On its way from the border each step ends on a root; without delay on one of the polynomial's.
TEST(CriticalRoot, IsFollowedToNoDelay) {
  const LinearRig linear = linearise(linear_rig(0.010));
  const StabilityAnalysis a = analyse(described(linear_rig(0.010)));
  const auto root = critical_root(linear.equation(*a.margins.critical_delay), a.margins.critical_omega, 0.0, -60.0);
  ASSERT_TRUE(root);
  EXPECT_LT(std::abs(linear.equation(0.0)(*root)), 1e-12 * linear.equation(0.0).scale(*root));
  EXPECT_NEAR(root->real(), -15.988, 5e-4);  // physics.md section 6
  EXPECT_NEAR(root->imag(), 73.898, 5e-4);
  EXPECT_FALSE(critical_root(linear.equation(*a.margins.critical_delay), a.margins.critical_omega, 0.0, -10.0));
}

// Point. τ is what the description says is there; half a step is in the total, lags are shown and not added.
TEST(DelayBalance, SumsWhatTheDescriptionGives) {
  Rig rig = linear_rig(0.010);
  auto description = described(rig);
  const StabilityAnalysis plain = analyse(description);
  EXPECT_EQ(plain.delay, 0.010);
  EXPECT_NEAR(plain.balance.total, 0.0105, 1e-15);
  EXPECT_NEAR(*plain.balance.left, 15.2535703e-3 - 0.0105, 1e-9);

  description.delay_budget = {0.0005, 0.001, 0.0015};
  description.rig.effects.add(model::Channel::F, model::SensorDelay<double>{0.0004});
  description.rig.effects.add(model::ActuatorLag<double>{0.001});
  const StabilityAnalysis a = analyse(description);
  EXPECT_NEAR(a.delay, 0.0134, 1e-15);
  EXPECT_NEAR(a.balance.total, 0.0139, 1e-15);
  EXPECT_EQ(a.machine_delay, 0.010);
  double sum = 0.0, lag = 0.0;
  for (const DelayPart& part : a.balance.parts) {
    sum += part.in_loop_delay ? part.seconds : 0.0;
    if (part.name.starts_with("lags of the machine")) lag = part.seconds;
  }
  EXPECT_NEAR(sum, a.delay, 1e-15);
  // Group delay of a first-order lag: T/(1 + ω²T²).
  const double turns = 0.001 * a.margins.critical_omega;
  EXPECT_NEAR(lag, 0.001 / (1.0 + turns * turns), 1e-12);
  // The same loop with all of it in the actuator has the same roots.
  auto together = described(linear_rig(0.0134));
  together.rig.effects.add(model::ActuatorLag<double>{0.001});
  EXPECT_LT(std::abs(analyse(together).roots.rightmost() - a.roots.rightmost()), 1e-10);
}

// Law. The card of an effect says whether it is linear; the analysis follows.
TEST(LinearRig, LeavesOutWhatHasNoLinearPartAndSaysSo) {
  Rig rig = fdva_rig();
  const LinearRig before = linearise(rig);
  EXPECT_EQ(before.left_out, std::vector<std::string>{"fdva.minor_loss"});
  rig.effects.add(model::CoulombFriction<double>{100.0});
  rig.effects.add(model::TyreLiftOff<double>{});
  rig.effects.add(model::Backlash<double>{1e-3});
  rig.effects.add(model::ActuatorRateLimit<double>{0.5});
  rig.effects.add(model::BumpStop<double>{0.01, 1e5});
  rig.effects.add(model::Channel::F, model::SensorHold<double>{0.005});
  rig.effects.add(model::Channel::z_w, model::SensorDelay<double>{0.005});
  const LinearRig after = linearise(rig);
  EXPECT_EQ(after.left_out.size(), 7U);
  EXPECT_EQ(after.outside_loop, std::vector<std::string>{"sensor_delay.z_w"});
  EXPECT_EQ(after.delay(), before.delay());
  for (std::size_t k = 0; k < before.p.size(); ++k) {
    EXPECT_EQ(after.p[k], before.p[k]);
    EXPECT_EQ(after.q[k], before.q[k]);
  }
  rig.kind = model::RigKind::component_bench;
  EXPECT_THROW(static_cast<void>(linearise(rig)), UnfitLoop);
}

}  // namespace
