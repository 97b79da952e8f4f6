#include "firmware/loop/compensation/compensator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <deque>

#include "tests/support/without_heap.hpp"

namespace {

using Motion = model::Motion<double>;
using firmware::compensation::Coefficients;
using firmware::compensation::Compensator;
using firmware::compensation::Kind;
using firmware::compensation::Settings;

constexpr double period = 1e-3;

/// A wave with its derivatives.
Motion wave(double t, double omega) {
  return {1e-3 * std::sin(omega * t), 1e-3 * omega * std::cos(omega * t), -1e-3 * omega * omega * std::sin(omega * t)};
}

/// No ramp, no limit that acts.
Settings bare(Kind kind) {
  Settings s;
  s.kind = kind;
  s.start_ramp = 0.0;
  s.rate = 100.0;
  s.limit = 1.0;
  s.force_limit = 1e6;
  s.force_lead = 0.0;
  return s;
}

/// A wave of so many samples: sums over whole waves have no leakage.
double frequency(int samples) { return 6.283185307179586 / (samples * period); }

/// The command while a wave is wanted: amplitude and phase against the wanted wave, after the start has passed.
std::complex<double> response(Compensator& compensator, double omega) {
  firmware::Compensation& loop = compensator;
  loop.start(0.0);
  std::complex<double> out, in;
  const auto turns = static_cast<int>(std::lround(20.0 * 6.283185307179586 / omega / period));
  for (int k = 1; k <= 2 * turns; ++k) {
    const double t = k * period;
    const auto answer = loop.command({.wanted = wave(t, omega)});
    if (k <= turns) continue;
    out += answer.command.position * std::polar(1.0, -omega * t);
    in += wave(t, omega).position * std::polar(1.0, -omega * t);
  }
  return out / in;
}

// Point. The inverse of delay, lag and resonance by hand: (1 + τs + τ²s²/2)(1 + Ts)(1 + 2ζs/ω + s²/ω²).
TEST(Compensation, InverseSeriesIsTheProductOfTheMachinesParts) {
  const double tau = 0.01, lag = 0.004, omega = 2.0 * 3.141592653589793 * 50.0, zeta = 0.3;
  const Coefficients a = firmware::compensation::inverse_series(
      {.delay = tau, .lag = lag, .resonance_frequency = 50.0, .resonance_damping = zeta, .rate_limit = 0.0}, 1.0);
  const double r1 = 2.0 * zeta / omega, r2 = 1.0 / (omega * omega);
  const double e2 = tau * tau / 2.0, e3 = tau * tau * tau / 6.0;
  EXPECT_DOUBLE_EQ(a[0], 1.0);
  EXPECT_NEAR(a[1], tau + lag + r1, 1e-15);
  EXPECT_NEAR(a[2], e2 + r2 + tau * lag + tau * r1 + lag * r1, 1e-15);
  EXPECT_NEAR(a[3], e3 + e2 * (lag + r1) + tau * (r2 + lag * r1) + lag * r2, 1e-17);
}

// Point. Osaki's damping is k/ω sin ωτ; at a quarter turn it is k/ω.
TEST(Compensation, DampingAgainstADelayFollowsItsSine) {
  const double omega = 80.0;
  EXPECT_NEAR(firmware::compensation::damping_against_delay(86500.0, omega, 0.25 * 6.283185307179586 / omega),
              86500.0 / omega, 1e-9);
  EXPECT_NEAR(firmware::compensation::damping_against_delay(86500.0, omega, 0.01), 86500.0 / omega * std::sin(0.8),
              1e-9);
}

// Law. Horiuchi's error is |2 sin ωτ/2|^(n+1), behind the delay; the interpolation between samples is far below.
TEST(Compensation, PolynomialHasHoriuchisError) {
  const double delay = 0.0123, omega = frequency(157);
  for (const int degree : {1, 2, 3}) {
    Settings s = bare(Kind::polynomial);
    s.order = degree;
    s.machine.delay = delay;
    Compensator compensator(s, period);
    const auto behind = response(compensator, omega) * std::polar(1.0, -omega * delay);
    const double expected = std::pow(2.0 * std::sin(0.5 * omega * delay), degree + 1);
    EXPECT_NEAR(std::abs(behind - 1.0), expected, 1e-3 * expected + 1e-7) << degree;
  }
}

// Law. The inverse cut behind s² or s³ is that polynomial at s = jω; x⃛ is a difference, half a period late.
TEST(Compensation, InverseIsItsPolynomialAtEveryFrequency) {
  const double omega = frequency(209);
  const std::complex<double> s(0.0, omega);
  for (const int order : {1, 2, 3}) {
    Settings settings = bare(Kind::inverse);
    settings.order = order;
    settings.machine = {.delay = 0.01, .lag = 0.005, .resonance_frequency = 0, .resonance_damping = 0, .rate_limit = 0};
    Compensator compensator(settings, period);
    const Coefficients a = settings.assumed();
    const auto expected = a[0] + a[1] * s + a[2] * s * s + a[3] * s * s * s * std::polar(1.0, -0.5 * omega * period);
    EXPECT_LT(std::abs(response(compensator, omega) - expected), 1e-5) << order;
    if (order < 3) {
      EXPECT_EQ(a[3], 0.0);
    }
  }
}

/// A machine of lag and delay in samples, stepped here, that follows the commands of a compensator.
struct Tracking {
  double lag = 0.0;
  std::size_t delay = 0;
  double noise = 0.0;
  double error = 0.0, wanted = 0.0;  ///< rms² · samples of the last second

  void run(Compensator& compensator, double seconds) {
    firmware::Compensation& loop = compensator;
    loop.start(0.0);
    std::deque<double> line(delay + 1, 0.0);
    double reached = 0.0, commanded = 0.0;
    std::uint32_t random = 1;
    const auto steps = static_cast<int>(seconds / period);
    for (int k = 0; k < steps; ++k) {
      random = random * 1664525U + 1013904223U;
      const double disturbance = noise * (static_cast<double>(random >> 8U) / 16777216.0 - 0.5);
      const Motion a = wave((k + 1) * period, 20.0), b = wave((k + 1) * period, 60.0);
      const Motion x{a.position + b.position, a.velocity + b.velocity, a.acceleration + b.acceleration};
      const auto answer =
          loop.command({.wanted = x, .commanded = commanded, .reached = reached + disturbance, .measured = true});
      line.push_back(answer.command.position);
      const double before = line.front();
      line.pop_front();
      const double now = line.front();
      // The lag's exact answer to an input that goes straight from sample to sample.
      if (lag > 0.0) {
        const double e = std::exp(-period / lag), slope = (now - before) / period;
        reached = now - slope * lag + e * (reached - before + slope * lag);
      } else {
        reached = now;
      }
      commanded = answer.command.position;
      if (k < steps - 1000) continue;
      error += (reached - x.position) * (reached - x.position);
      wanted += x.position * x.position;
    }
  }
  [[nodiscard]] double nrmse() const { return std::sqrt(error / wanted); }
};

Settings assumed_wrongly(Kind kind) {
  Settings s = bare(kind);
  s.order = 3;
  s.machine.delay = 0.006;
  s.limit = 0.1;
  return s;
}

// Law. A machine that is twice as late as assumed is found by the time series from its own motion, the noise of the
// position sensor (0.02 mm of 1 mm) does not bias it; the fixed inverse keeps the error of 6 ms at 60 rad/s.
TEST(Compensation, TimeSeriesFindsTheMachineThatTheInverseDoesNot) {
  Compensator fixed(assumed_wrongly(Kind::inverse), period),
      adaptive(assumed_wrongly(Kind::adaptive_time_series), period);
  Tracking with_fixed{.delay = 12, .noise = 4e-5}, with_adaptive = with_fixed;
  with_fixed.run(fixed, 8.0);
  with_adaptive.run(adaptive, 8.0);
  EXPECT_GT(with_fixed.nrmse(), 0.2);
  EXPECT_LT(with_adaptive.nrmse(), 0.01);
  EXPECT_NEAR(adaptive.values()[1], 0.012, 1e-3);  // four coefficients from two tones, noise of a second: 0.5 ms
}

// Law. Feedback of the tracking error reduces what the assumed machine lacks at low frequencies.
TEST(Compensation, FeedbackReducesASteadyError) {
  Settings s = bare(Kind::feedforward_feedback);
  s.machine.delay = 0.006;
  Compensator compensator(s, period);
  firmware::Compensation& loop = compensator;
  loop.start(0.0);
  double commanded = 0.0;
  for (int k = 0; k < 5000; ++k) {  // a machine of gain 0.9, at rest at 1 mm
    commanded =
        loop.command({.wanted = {1e-3, 0.0, 0.0}, .commanded = commanded, .reached = 0.9 * commanded, .measured = true})
            .command.position;
  }
  EXPECT_NEAR(0.9 * commanded, 1e-3, 1e-8);
}

// Law. Smith's force is that of the component at the wanted deflection less that at the deflection one delay before.
TEST(Compensation, SmithAddsTheForceOfTheMissingDeflection) {
  Settings s = bare(Kind::smith);
  s.machine.delay = 0.008;
  s.component = {.stiffness = 3e4, .damping = 200.0, .has_fdva = false, .fdva = {}};
  Compensator compensator(s, period);
  firmware::Compensation& loop = compensator;
  loop.start(0.0);
  for (int k = 1; k < 400; ++k) {
    const double t = k * period;
    EXPECT_EQ(loop.command({.wanted = wave(t, 30.0)}).command.position, wave(t, 30.0).position);
    if (k < 20) continue;
    const Motion now = wave(t, 30.0), before = wave(t - 0.008, 30.0);
    EXPECT_NEAR(loop.force(50.0),
                50.0 + 3e4 * (now.position - before.position) + 200.0 * (now.velocity - before.velocity), 1e-9);
  }
}

// Law. The predicted force is held for a period too: force_lead extrapolates it with the measured one.
TEST(Compensation, ForceLeadExtrapolatesWhatSmithAdds) {
  Settings s = bare(Kind::smith);
  s.machine.delay = 0.008;
  s.component = {.stiffness = 3e4, .damping = 0.0, .has_fdva = false, .fdva = {}};
  s.force_lead = 0.5;
  Compensator compensator(s, period);
  firmware::Compensation& loop = compensator;
  loop.start(0.0);
  EXPECT_DOUBLE_EQ(loop.force(0.0), 0.0);
  (void)loop.command({.wanted = {1e-3, 0.0, 0.0}});  // 30 N that the machine has not reached yet
  EXPECT_NEAR(loop.force(0.0), 45.0, 1e-9);
}

// Law. Over a held piston the FDVA is its spring; over an open duct at rest it lets go.
TEST(Compensation, SmithsFdvaLocksWithoutDuctsAndYieldsWithThem) {
  Settings s = bare(Kind::smith);
  s.machine.delay = 0.008;
  s.component = {.stiffness = 0.0,
                 .damping = 0.0,
                 .has_fdva = true,
                 .fdva = {30e-4, 12e-3, 0.6361571127, 860.0, 32e-6, 1.5, 55e3, 6, 2}};
  for (const int open : {0, 2}) {
    Compensator compensator(s, period);
    firmware::Compensation& loop = compensator;
    loop.start(0.0);
    double most = 0.0;
    for (int k = 1; k < 8; ++k) {  // a step that the machine has not followed yet
      (void)loop.command({.wanted = {1e-3, 0.0, 0.0}, .open_ducts = open});
      most = loop.force(0.0);
    }
    if (open == 0) {
      EXPECT_NEAR(most, 55.0, 1e-9);
    }
    if (open == 2) {
      EXPECT_LT(most, 54.9);
    }
  }
}

// Law. The constant damper adds b ẋ; the adaptive one adds nothing while the interface takes energy, and rises to b
// within damping_time while it feeds.
TEST(Compensation, AdaptiveDampingActsOnlyAgainstAFedInterface) {
  for (const double sign : {1.0, -1.0}) {  // a damper takes, its opposite feeds
    Settings s = bare(Kind::adaptive_virtual_damping);
    s.damping = 500.0;
    Compensator compensator(s, period);
    firmware::Compensation& loop = compensator;
    loop.start(0.0);
    double most = 0.0;
    for (int k = 0; k < 2000; ++k) {
      const Motion x = wave(k * period, 60.0);
      (void)loop.force(sign * 300.0 * x.velocity);
      most = std::max(most, compensator.state().damper.damping);
      (void)loop.command({.wanted = wave((k + 1) * period, 60.0)});
    }
    if (sign > 0.0) {
      EXPECT_EQ(most, 0.0);
    }
    if (sign < 0.0) {
      EXPECT_GT(most, 250.0);
    }
    EXPECT_LE(most, 500.0);
  }
  Settings s = bare(Kind::virtual_damping);
  s.damping = 500.0;
  Compensator constant(s, period);
  firmware::Compensation& loop = constant;
  loop.start(0.0);
  (void)loop.command({.wanted = {1e-3, 0.2, 0.0}});
  EXPECT_DOUBLE_EQ(loop.force(10.0), 10.0 + 500.0 * 0.2);
}

// Point. force_lead extrapolates the force straight on.
TEST(Compensation, ForceLeadExtrapolates) {
  Settings s = bare(Kind::inverse);
  s.force_lead = 1.5;
  Compensator compensator(s, period);
  firmware::Compensation& loop = compensator;
  loop.start(0.0);
  EXPECT_DOUBLE_EQ(loop.force(100.0), 100.0);  // the first force has no past
  EXPECT_DOUBLE_EQ(loop.force(110.0), 125.0);
  EXPECT_DOUBLE_EQ(loop.force(110.0), 110.0);
}

// Law. A car that moves from its first period on gets no step of the command: the addition begins at zero and changes
// by at most rate · h a period.
TEST(Compensation, StartsWithoutAJumpAndKeepsItsRate) {
  for (const Kind kind : {Kind::polynomial, Kind::inverse, Kind::adaptive_time_series, Kind::feedforward_feedback}) {
    Settings s;
    s.kind = kind;
    s.machine.delay = 0.01;
    s.rate = 0.05;
    Compensator compensator(s, period);
    firmware::Compensation& loop = compensator;
    loop.start(0.0);
    double before = 0.0;
    for (int k = 0; k < 500; ++k) {
      const Motion x{2e-3, 0.3, 5.0};  // a motion that is there at once
      const double added = loop.command({.wanted = x, .reached = 0.0, .measured = true}).command.position - x.position;
      if (k == 0) {
        EXPECT_EQ(added, 0.0) << name(kind);
      }
      EXPECT_LE(std::abs(added - before), 0.05 * period * (1.0 + 1e-9)) << name(kind);
      before = added;
    }
    if (kind != Kind::polynomial) {
      EXPECT_GT(before, 1e-3) << name(kind);
    }
  }
}

// Fault. An addition beyond its limit ends the run, of the command and of the force; so does a number that is none.
TEST(Compensation, SaysWhenItAddsMoreThanItMay) {
  Settings s = bare(Kind::inverse);
  s.machine.delay = 0.01;
  s.limit = 1e-3;
  Compensator compensator(s, period);
  firmware::Compensation& loop = compensator;
  loop.start(0.0);
  EXPECT_FALSE(loop.command({.wanted = {0.0, 0.09, 0.0}}).excess);
  const auto beyond = loop.command({.wanted = {0.0, 0.2, 0.0}});
  ASSERT_TRUE(beyond.excess);
  EXPECT_NEAR(beyond.excess->value, 2e-3, 1e-12);
  EXPECT_EQ(beyond.excess->limit, 1e-3);
  EXPECT_TRUE(loop.command({.wanted = {0.0, std::nan(""), 0.0}}).excess);

  Settings f = bare(Kind::virtual_damping);
  f.damping = 1000.0;
  f.force_limit = 100.0;
  Compensator damper(f, period);
  firmware::Compensation& force = damper;
  force.start(0.0);
  (void)force.command({.wanted = {0.0, 0.2, 0.0}});
  (void)force.force(0.0);
  EXPECT_TRUE(force.command({.wanted = {0.0, 0.2, 0.0}}).excess);
}

// Fault. Without samples of x_act the coefficients stay as they are.
TEST(Compensation, LostPositionsTeachNothing) {
  Compensator compensator(assumed_wrongly(Kind::adaptive_time_series), period);
  firmware::Compensation& loop = compensator;
  loop.start(0.0);
  const Coefficients before = compensator.values();
  for (int k = 0; k < 1000; ++k) (void)loop.command({.wanted = wave(k * period, 60.0), .measured = false});
  EXPECT_EQ(compensator.values(), before);
}

// Law. No period takes memory from the heap.
TEST(Compensation, TakesNoHeap) {
  for (std::size_t i = 0; i < firmware::compensation::kind_names.size(); ++i) {
    Settings s = bare(static_cast<Kind>(i));
    s.machine.delay = 0.01;
    s.damping = 100.0;
    Compensator compensator(s, period);
    firmware::Compensation& loop = compensator;
    support::without_heap([&] {
      loop.start(0.0);
      for (int k = 0; k < 100; ++k) {
        (void)loop.force(10.0);
        (void)loop.command({.wanted = wave(k * period, 60.0), .measured = true, .open_ducts = 2});
      }
      return 0;
    });
  }
}

// Fault. Settings that make no sense are named.
TEST(Compensation, NamesSettingsThatDoNotFit) {
  EXPECT_TRUE(Settings{}.check().empty());
  const auto with = [](auto change) {
    Settings s;
    change(s);
    return std::string(s.check().substr(0, s.check().find(':')));
  };
  EXPECT_EQ(with([](Settings& s) { s.machine.delay = std::nan(""); }), "compensation.delay");
  EXPECT_EQ(with([](Settings& s) { s.order = 4; }), "compensation.order");
  EXPECT_EQ(with([](Settings& s) { s.limit = 0.0; }), "compensation.limit");
  EXPECT_EQ(with([](Settings& s) { s.force_lead = -1.0; }), "compensation.force_lead");
  EXPECT_EQ(with([](Settings& s) { s.damping = 1e9; }), "compensation.damping");
  Settings s;
  s.kind = Kind::polynomial;
  s.order = 3;
  s.machine.delay = 0.1;
  EXPECT_FALSE(Compensator::fits(s, period));
  EXPECT_TRUE(Compensator::fits(s, 2e-3));
}

}  // namespace
