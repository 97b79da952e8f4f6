// Growth or decay and frequency of the modes that a rig shows when it is left alone: the numbers of physics.md
// section 6.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <vector>

#include "model/rig/rig_model.hpp"
#include "tests/support/reference_parameters.hpp"

namespace {

using model::Channel;
using model::CoreIndex;
using model::RigKind;
using Complex = std::complex<double>;
using Parameters = model::RigParameters<double>;

/// The poles of a free response that consists of n exponentials: linear prediction by least squares, then the roots.
std::vector<Complex> poles_of(const std::vector<double>& y, int n, double dt) {
  const auto rows = static_cast<Eigen::Index>(y.size()) - n;
  Eigen::MatrixXd past(rows, n);
  Eigen::VectorXd now(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (int j = 0; j < n; ++j) past(i, j) = y[static_cast<std::size_t>(i + n - 1 - j)];
    now(i) = y[static_cast<std::size_t>(i + n)];
  }
  const Eigen::VectorXd weights = past.colPivHouseholderQr().solve(now);
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  companion.row(0) = weights.transpose();
  for (int i = 1; i < n; ++i) companion(i, i - 1) = 1.0;
  std::vector<Complex> poles;
  for (const Complex& z : companion.eigenvalues()) {
    if (z.imag() > 1e-9) poles.push_back(std::log(z) / dt);
  }
  return poles;
}

Complex nearest(const std::vector<Complex>& poles, Complex to) {
  return *std::min_element(poles.begin(), poles.end(),
                           [to](Complex a, Complex b) { return std::abs(a - to) < std::abs(b - to); });
}

constexpr double fine = 50e-6;

/// Poles of a rig kicked at the wheel and left alone on a flat road: samples every 8 ms, from 0.3 s on, when the faster
/// modes that a delay brings along (decaying with 150 1/s and more) are below 1e-19 of the kick.
std::vector<Complex> poles_of(const Parameters& rig, int count, double period = fine) {
  const model::RigModel<> model(rig, period);
  model::Column<double, 6> kicked = model::Column<double, 6>::Zero();
  kicked(1) = 1.0;
  kicked(3) = -0.2;
  auto x = model.start(kicked, {}, {});
  const auto every = static_cast<int>(std::lround(8e-3 / period)), first = static_cast<int>(std::lround(0.3 / period));
  std::vector<double> y;
  for (int k = 0; k < first + 150 * every; ++k) {
    if (k >= first && (k - first) % every == 0) {
      const auto s = model.signals(x);
      y.push_back(s[index(Channel::z_w)] - 0.3 * s[index(Channel::z_b)]);
    }
    model.step(x, {});
  }
  return poles_of(y, count, 8e-3);
}

/// A hil rig whose loop delay is τ: the force held for a period adds half of one, which the line leaves out.
Parameters with_loop_delay(Parameters rig, double tau) {
  if (tau > 0.0) rig.effects.add(model::ActuatorDelay<double>{tau - 0.5 * fine});
  return rig;
}

Parameters linear_hil(double tau, double virtual_damping) {
  auto rig = support::linear_rig(RigKind::hil);
  rig.machine.virtual_damping = virtual_damping;
  return with_loop_delay(rig, tau);
}

/// Linear losses only.
Parameters fdva_hil(double tau, double virtual_damping) {
  auto rig = support::fdva_rig(RigKind::hil);
  rig.fdva.minor_loss = 0.0;
  rig.machine.virtual_damping = virtual_damping;
  return with_loop_delay(rig, tau);
}

// Tolerance of a pole: half a unit of its last printed digit (5e-5 or 5e-4) and what is left of the hold when half a
// period is taken out, (ωh)²/24 ≈ 1e-6 of the loop's force, 1e-4 1/s.
constexpr double tolerance = 6e-4;

void expect_pole(const std::vector<Complex>& poles, Complex expected) {
  const Complex found = nearest(poles, expected);
  EXPECT_NEAR(found.real(), expected.real(), tolerance);
  EXPECT_NEAR(found.imag(), expected.imag(), tolerance);
}

// Golden. No delay: the quarter car itself, exact for any period.
TEST(Poles, OfTheLinearCarWithoutDelay) {
  for (const double period : {fine, 1e-3, 4e-3}) {
    const auto poles = poles_of(support::linear_rig(RigKind::quarter_car), 4, period);
    expect_pole(poles, {-15.988, 73.898});
    expect_pole(poles, {-1.477, 9.635});
  }
}

// Golden. Linear component behind 10 ms: wheel and body mode.
TEST(Poles, OfTheLinearComponentBehindTenMilliseconds) {
  const auto bare = poles_of(linear_hil(0.010, 0.0), 4);
  expect_pole(bare, {-9.3847, 87.3599});
  expect_pole(bare, {-1.0753, 9.7797});
  const auto damped = poles_of(linear_hil(0.010, 700.0), 4);
  expect_pole(damped, {-22.3409, 86.8166});
  expect_pole(damped, {-2.0253, 9.7354});
}

// Golden. FDVA, two ducts, linear losses: stable with b̃ = 1140, unstable with 700, as the paper's authors saw.
TEST(Poles, OfTheFdvaBehindTenMilliseconds) {
  expect_pole(poles_of(fdva_hil(0.010, 1140.0), 6), {-2.3945, 83.902});
  expect_pole(poles_of(fdva_hil(0.010, 700.0), 6), {2.1685, 84.375});
}

// Golden. On the axis at b̃ = 908.04 (half a N s/m beside it is ±0.005 1/s).
TEST(Poles, OfTheFdvaReachTheAxisAtTheCriticalVirtualDamping) {
  const Complex wheel(0.0, 84.1);
  EXPECT_GT(nearest(poles_of(fdva_hil(0.010, 907.54), 6), wheel).real(), 0.0);
  EXPECT_LT(nearest(poles_of(fdva_hil(0.010, 908.54), 6), wheel).real(), 0.0);
}

// Golden. Critical delays, bracketed within 3 µs: 15.2536 ms at b̃ = 0, 23.646 ms at 700, both of the wheel mode; and
// 9.62 ms (its last digit: 5 µs) of the body mode without damper at b̃ = 300.
TEST(Poles, ReachTheAxisAtTheCriticalDelays) {
  for (const auto& [virtual_damping, critical] : {std::pair{0.0, 0.0152536}, std::pair{700.0, 0.023646}}) {
    const auto rightmost = [&, b = virtual_damping](double tau) {
      double largest = -1e9;
      for (const Complex& pole : poles_of(linear_hil(tau, b), 6)) largest = std::max(largest, pole.real());
      return largest;
    };
    EXPECT_LT(rightmost(critical - 3e-6), 0.0) << "b̃ " << virtual_damping;
    EXPECT_GT(rightmost(critical + 3e-6), 0.0) << "b̃ " << virtual_damping;
  }
  const auto body = [](double tau) {
    auto rig = support::linear_rig(RigKind::hil);
    rig.suspension.damping = 0.0;
    rig.machine.virtual_damping = 300.0;
    return nearest(poles_of(with_loop_delay(rig, tau), 4), {0.0, 9.7}).real();
  };
  EXPECT_LT(body(9.61e-3), 0.0);
  EXPECT_GT(body(9.63e-3), 0.0);
}

// Law. What the hold adds: with 1 ms steps and a held force the loop of the linear component at b̃ = 0 is stable with 14
// samples of delay (14.5 ms) and unstable with 15 (15.5 ms; critical 15.25 ms).
TEST(Poles, OfAOneMillisecondLoopTellThatTheHoldAddsHalfAStep) {
  const auto rms_at = [](double delay, double from) {
    auto rig = support::linear_rig(RigKind::hil);
    rig.effects.add(model::ActuatorDelay<double>{delay});
    const model::RigModel<> model(rig, 1e-3);
    model::Column<double, 6> kicked = model::Column<double, 6>::Zero();
    kicked(1) = 1.0;
    auto x = model.start(kicked, {}, {});
    double sum = 0.0;
    for (int k = 0; k < static_cast<int>(from * 1e3) + 1000; ++k) {
      model.step(x, {});
      const double load = model.signals(x)[index(Channel::F_w)];
      if (k >= static_cast<int>(from * 1e3)) sum += load * load;
    }
    return std::sqrt(sum / 1000.0);
  };
  EXPECT_LT(rms_at(0.014, 9.0), 1e-2 * rms_at(0.014, 1.0));
  EXPECT_GT(rms_at(0.015, 9.0), 1e1 * rms_at(0.015, 1.0));
}

// Golden. The branch alone at n = 1 … 6 equal ducts on its coil spring: 8 √(n/2) Hz. Wheel and body do not move: the
// bench holds the deflection. Lossless but for rounding; frequency from the phase over 10 s.
TEST(Poles, OfTheFdvaBranchAreEightHertzTimesTheRootOfHalfItsDucts) {
  const double expected[] = {5.66, 8.00, 9.80, 11.31, 12.65, 13.86};
  for (int n = 1; n <= 6; ++n) {
    auto rig = support::fdva_rig(RigKind::component_bench, n);
    rig.fdva.oil_viscosity = 0.0;
    rig.fdva.minor_loss = 0.0;
    const model::RigModel<> model(rig, 1e-3);
    model::Column<double, 6> pulled = model::Column<double, 6>::Zero();
    pulled(4) = 0.01;
    auto x = model.start(pulled, {}, {});
    std::vector<double> y;
    for (int k = 0; k < 10'000; ++k) {
      if (k % 8 == 0) y.push_back(x.core(CoreIndex::piston_travel));
      model.step(x, {});
    }
    const auto poles = poles_of(y, 2, 8e-3);
    ASSERT_EQ(poles.size(), 1U) << n << " ducts";
    EXPECT_NEAR(poles[0].imag() / (2.0 * 3.14159265358979), expected[n - 1], 5e-3) << n << " ducts";
    EXPECT_NEAR(poles[0].imag() / (16.0 * 3.14159265358979 * std::sqrt(n / 2.0)), 1.0, 1e-5) << n << " ducts";
    EXPECT_NEAR(poles[0].real(), 0.0, 1e-9) << n << " ducts";
  }
}

}  // namespace
