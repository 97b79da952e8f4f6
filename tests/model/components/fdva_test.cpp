#include "model/components/fdva.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "model/components/duct_flows.hpp"
#include "tests/support/reference_parameters.hpp"
#include "tests/support/reference_road.hpp"

namespace fdva_test {
namespace {

using Fdva = model::Fdva<double>;
using Flows = model::DuctFlows<double>;
using model::OpenDucts;

constexpr double A_p = 30e-4;
constexpr double h = 1e-3;

// Point (9). a = 1.130973e-4 m²: I = 860·0.6361571127/a, R = 128·860·32e-6·0.6361571127/(π 12e-3⁴), S = 860·1.5/(2a²),
// by hand to six digits.
TEST(Fdva, HasDuctsOfPoiseuilleAndIdelchik) {
  const auto duct = Fdva::duct(support::reference_fdva());
  EXPECT_NEAR(duct.inertance / 4.837383e6, 1.0, 1e-6);
  EXPECT_NEAR(duct.laminar_loss / 3.439917e7, 1.0, 1e-6);
  EXPECT_NEAR(duct.minor_loss / 5.042605e10, 1.0, 1e-6);
}

// Golden. The reference set with two ducts is the text's b = 21.768 kg, c = 154.80 N s/m, c₂ = 340.38 N s²/m².
TEST(Fdva, IsTheReferenceSetOfTheText) {
  const auto duct = Fdva::duct(support::reference_fdva());
  EXPECT_NEAR(duct.inertance * A_p * A_p / 2.0, 21.768, 5e-4);
  EXPECT_NEAR(duct.laminar_loss * A_p * A_p / 2.0, 154.80, 5e-3);
  EXPECT_NEAR(duct.minor_loss * A_p * A_p * A_p / 4.0, 340.38, 5e-3);
}

// Point (6). 55e3 (0.012 − 0.002).
TEST(Fdva, IsPushedThroughItsCoilSpring) {
  EXPECT_NEAR(Fdva::force(support::reference_fdva(), 0.012, 0.002), 550.0, 1e-9);
}

// Point (8a). n = 2, F_c = 100 N, u = 0.1 m/s: (100 − 15.480)/21.768 = 3.8828; with minor losses c₂ u² less, each duct
// carrying q = A_p u/2.
TEST(Fdva, AcceleratesItsPistonAgainstTheLosses) {
  const auto p = support::reference_fdva();
  const auto duct = Fdva::duct(p);
  EXPECT_NEAR(Fdva::piston_acceleration(p, duct, 2, 0.1, 100.0), 3.8828, 1e-4);
  const double q = A_p * 0.1 / 2.0;
  EXPECT_NEAR(Fdva::piston_deceleration_per_loss(p, duct) * 2.0 * q * q, 340.38 * 0.01 / 21.768, 1e-5);
  EXPECT_EQ(Fdva::piston_acceleration(p, duct, 0, 0.1, 100.0), 0.0);
}

// Point. Bit j − 1 is duct j.
TEST(OpenDucts, AreCountedAndFilledFromTheFirst) {
  EXPECT_EQ(model::first_ducts(0), 0);
  EXPECT_EQ(model::first_ducts(2), 3);
  EXPECT_EQ(model::first_ducts(6), 63);
  EXPECT_EQ(model::count(0b101101), 4);
}

Flows::Step step_of(const Fdva::Parameters& p) { return Flows::step_of(p, Fdva::duct(p), h); }

double sum_of_flows(const Flows& flows, double velocity, const Flows::Step& step) {
  double sum = 0.0;
  for (std::size_t j = 0; j < model::duct_capacity; ++j) sum += flows.flow(j, velocity, step);
  return sum;
}

// Law (7). Whatever is open and however unequal, the flows carry what the piston displaces; 1e-15 of the largest flow.
TEST(DuctFlows, CarryWhatThePistonDisplaces) {
  const auto step = step_of(support::reference_fdva());
  Flows flows;
  flows.start(3);
  support::NormalNoise noise(11);
  double u = 0.0;
  for (int k = 0; k < 2000; ++k) {
    if (k % 97 == 0) u = flows.switch_to(static_cast<OpenDucts>(noise.uniform() * 64.0), u, step);
    u = flows.open() == 0 ? 0.0 : 0.99 * u + 0.01 * noise();
    flows.advance(u, step);
    EXPECT_NEAR(sum_of_flows(flows, u, step), A_p * u, 2e-17) << "step " << k << ", seed 11";
    for (std::size_t j = 0; j < model::duct_capacity; ++j) {
      if (((flows.open() >> j) & 1) != 0) continue;
      EXPECT_EQ(flows.flow(j, u, step), 0.0) << "a closed duct, seed 11";
    }
  }
}

// Point (8b). Duct 3 opens beside two flowing ones at u = 0.2 m/s: q = (A_p u/2, A_p u/2, 0). Without minor losses the
// differences decay by e^{−R h/I} a step, R/I = 7.11110 1/s; the mean stays the piston's.
TEST(DuctFlows, EvenOutByTheirLaminarLoss) {
  auto p = support::reference_fdva();
  p.minor_loss = 0.0;
  const auto step = step_of(p);
  const auto duct = Fdva::duct(p);
  Flows flows;
  flows.start(3);
  flows.advance(0.2, step);
  EXPECT_DOUBLE_EQ(flows.switch_to(7, 0.2, step), 0.2) << "opening does not move the piston";
  EXPECT_NEAR(flows.flow(0, 0.2, step), 3e-4, 1e-18);
  EXPECT_NEAR(flows.flow(2, 0.2, step), 0.0, 1e-18);
  for (int k = 1; k <= 50; ++k) {
    flows.advance(0.2, step);
    const double difference = flows.flow(0, 0.2, step) - flows.flow(2, 0.2, step);
    EXPECT_NEAR(difference, 3e-4 * std::exp(-duct.laminar_loss / duct.inertance * k * h), 1e-17);
  }
}

// Point (8b) with minor losses: two ducts, flows q and 0, piston held at u. δ = (q₁ − q₂)/2 obeys
// δ̇ = −R/I δ − S/(2I) (q₁|q₁| − q₂|q₂|), here integrated by a thousand small Euler–midpoint steps a period.
TEST(DuctFlows, EvenOutByTheirMinorLosses) {
  const auto p = support::reference_fdva();
  const auto step = step_of(p);
  const auto duct = Fdva::duct(p);
  Flows flows;
  flows.start(1);
  const double u = 0.3, mean = A_p * u / 2.0;
  for (int k = 0; k < 4; ++k) flows.advance(u, step);
  EXPECT_DOUBLE_EQ(flows.switch_to(3, u, step), u);
  const auto rate = [&](double d) {
    const double a = mean + d, b = mean - d;
    return -duct.laminar_loss / duct.inertance * d -
           duct.minor_loss / (2.0 * duct.inertance) * (a * std::fabs(a) - b * std::fabs(b));
  };
  double d = mean;
  for (int k = 0; k < 60; ++k) {
    flows.advance(u, step);
    for (int i = 0; i < 1000; ++i) d += h / 1000.0 * rate(d + h / 2000.0 * rate(d));
  }
  // The new duct's loss history starts with a kink at the opening: an error of some h² of the loss rate, 1e-6 of q.
  EXPECT_NEAR((flows.flow(0, u, step) - flows.flow(1, u, step)) / 2.0 / d, 1.0, 1e-4);
}

// Point. Σ q|q| of two equal ducts at u: 2 (A_p u/2)², with the sign of the flow, three samples remembered.
TEST(DuctFlows, RememberTheLossesOfFourSamples) {
  const auto step = step_of(support::reference_fdva());
  Flows flows;
  flows.start(3);
  for (const double u : {0.1, -0.2, 0.3, -0.4}) flows.advance(u, step);
  const auto loss = [](double u) { return 2.0 * (A_p * u / 2.0) * std::fabs(A_p * u / 2.0); };
  EXPECT_NEAR(flows.losses().now, loss(-0.4), 1e-20);
  EXPECT_NEAR(flows.losses().before, loss(0.3), 1e-20);
  EXPECT_NEAR(flows.losses().earlier, loss(-0.2), 1e-20);
  EXPECT_NEAR(flows.losses().earliest, loss(0.1), 1e-20);
}

// Law. A closing duct's flow ends with its energy, an opening one starts at rest, what goes on is kept: ½ I Σ q² after
// switching is that of the flows that stay, never more.
TEST(DuctFlows, NeverGainEnergyBySwitching) {
  const auto p = support::reference_fdva();
  const auto step = step_of(p);
  const double inertance = Fdva::duct(p).inertance;
  for (const std::uint64_t seed : {21U, 22U, 23U}) {
    support::NormalNoise noise(seed);
    Flows flows;
    flows.start(63);
    double u = 0.0;
    for (int k = 0; k < 3000; ++k) {
      u = flows.open() == 0 ? 0.0 : 0.9 * u + 0.1 * noise();
      flows.advance(u, step);
      const double before = flows.energy(u, step, inertance);
      const auto open = static_cast<OpenDucts>(noise.uniform() * 64.0);
      double kept = 0.0, sum = 0.0;
      for (std::size_t j = 0; j < model::duct_capacity; ++j) {
        if (((flows.open() & open) >> j & 1) == 0) continue;
        const double q = flows.flow(j, u, step);
        kept += 0.5 * inertance * q * q;
        sum += q;
      }
      u = flows.switch_to(open, u, step);
      const double after = flows.energy(u, step, inertance);
      EXPECT_LE(after, before * (1.0 + 1e-14)) << "seed " << seed;
      EXPECT_NEAR(after, kept, 1e-14 * before) << "seed " << seed;
      EXPECT_NEAR(A_p * u, sum, 1e-17) << "seed " << seed;
    }
  }
}

}  // namespace
}  // namespace fdva_test
