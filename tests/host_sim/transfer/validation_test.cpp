// Bands against measurements that are made by hand.
#include "host_sim/transfer/validate/validation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/simulation/gaussian.hpp"
#include "host_sim/transfer/validate/both_rigs.hpp"
#include "tests/host_sim/transfer/linear_pair.hpp"

namespace {

namespace transfer = host_sim::transfer;
using transfer::Complex;
using transfer::Outcome;

/// A car whose recorded channels are multiples of its road: responses are those numbers at each line.
transfer::SecondRig measured(double load, double body) {
  const auto to = linear_pair::car();
  transfer::SecondRig second = transfer::on_road(to, linear_pair::road(to, 20.0));
  host_sim::Response run;
  for (const auto& m : second.drives.front().input.motion) {
    run[index(model::Channel::F_w)].push_back(load * m.position);
    run[index(model::Channel::zdd_b)].push_back(body * m.position);
    run[index(model::Channel::dz_b)].push_back(m.position);
  }
  second.measured.push_back(std::move(run));
  return second;
}

Outcome constant(const transfer::SecondRig& second, Complex response) {
  Outcome outcome;
  for (auto& h : outcome.response) h.assign(second.analysis->frequencies().size(), response);
  outcome.quantity.fill(std::abs(response));
  return outcome;
}

// Point. Draws of 1 … 5: their 50 % band is 2 … 4, the 95 % band 1.1 … 4.9. A response of 3 lies in both, one of 4.5 in
// the wider only. Area metric: E|X − 3| = 6/5, E|X − 4.5| = 8.5/5. Log score with the mean 3 and the variance 2.5.
TEST(TransferValidation, CountsCoverageAreaAndScore) {
  const transfer::SecondRig second = measured(3.0, 4.5);
  transfer::Prediction p;
  p.centre = constant(second, 3.0);
  for (int i = 1; i <= 5; ++i) p.draws.push_back(constant(second, i));
  const transfer::Validation v = transfer::validate(p, second);
  EXPECT_NEAR(v.coverage50, 0.5, 1e-9);
  EXPECT_NEAR(v.coverage95, 1.0, 1e-9);
  EXPECT_NEAR(v.area[0], 1.2, 1e-9);
  EXPECT_NEAR(v.area[1], 1.7, 1e-9);
  EXPECT_NEAR(v.area_share[0], 1.2 / 3.0, 1e-9);
  EXPECT_NEAR(v.area_share[1], 1.7 / 4.5, 1e-9);
  const double first = std::log(std::numbers::pi * 2.5 / 9.0),
               other = std::log(std::numbers::pi * 2.5 / 20.25) + 2.25 / 2.5;
  EXPECT_NEAR(v.log_score, 0.5 * (first + other), 1e-9);
  const double level = v.measured.quantity[0];  // of the road times 3, against 1 … 5
  double area = 0.0;
  for (int i = 1; i <= 5; ++i) area += std::abs(i - level) / 5.0;
  EXPECT_NEAR(v.quantity_area[0], area, 1e-12);
  EXPECT_TRUE(v.holds);
  // The velocity of the road is level, so each line says something, the lowest too.
  EXPECT_NEAR(v.bands.front().lowest, second.analysis->frequencies().front() - 0.5 * second.analysis->line_width(),
              1e-9);
}

/// 400 draws around 10 with complex noise of variance 0.01, by line.
transfer::Prediction noisy(const transfer::SecondRig& second) {
  transfer::Prediction p;
  p.centre = constant(second, 10.0);
  firmware::Gaussian normal(3, 1);
  for (int i = 0; i < 400; ++i) {
    p.draws.push_back(p.centre);
    for (auto& response : p.draws.back().response) {
      for (Complex& h : response) {
        const double re = normal();
        h += std::sqrt(0.005) * Complex(re, normal());
      }
    }
  }
  return p;
}

// Point. (1): T of a measurement that is off by c is n c²/0.01 of n lines; p is the share of the draws with more, as
// far as 400 of them can count it (four times √(p (1 − p)/400)). (2): the deviation is c/10, without what noise makes.
// The mean of the draws, ± √(0.005/400) of 10 in a line, moves it by off/√(off² − noise) ≤ 1.16 times that/√n; four of
// these and its own square are allowed. (3): with a force that moves a line by e, the component lacks c/e of its force.
TEST(TransferValidation, ChecksABandByProbabilitySizeAndForce) {
  for (const double off : {0.09, 0.10, 0.11, 0.5}) {
    transfer::SecondRig second = measured(10.0 + off, 10.0);
    transfer::Prediction p = noisy(second);
    for (auto& effect : p.force_effect.response)
      effect.assign(second.analysis->frequencies().size(), Complex(0.0, 2.0));
    constexpr double noise = 0.002;  // variance of a line of H
    for (std::size_t k = 0; k < second.noise_density[0].size(); ++k) {
      second.noise_density[0][k] = noise * second.analysis->foot_power()[k] * second.analysis->averages();
    }
    const transfer::Validation v = transfer::validate(p, second);
    for (const transfer::BandCheck& band : v.bands) {
      if (band.response != 0) {
        EXPECT_TRUE(band.holds);
        EXPECT_GT(band.p, 0.99);
        continue;
      }
      std::vector<std::size_t> lines;
      for (std::size_t k = 0; k < second.analysis->frequencies().size(); ++k) {
        const double f = second.analysis->frequencies()[k];
        if (f > band.lowest && f < band.highest) lines.push_back(k);
      }
      double reached = 0.0;
      for (const Outcome& o : p.draws) {
        double t = 0.0;
        for (const std::size_t k : lines) t += std::norm(o.response[0][k] - 10.0);
        reached += t >= off * off * static_cast<double>(lines.size()) ? 1.0 / 400.0 : 0.0;
      }
      EXPECT_NEAR(band.p, reached, 4.0 * std::sqrt(0.25 / 400.0)) << off << " at " << band.lowest;
      EXPECT_NEAR(band.deviation, std::sqrt(off * off - noise) / 10.0,
                  4.0 * 1.16 * std::sqrt(0.005 / 400.0) / 10.0 / std::sqrt(static_cast<double>(lines.size())) + 2e-5);
      EXPECT_NEAR(band.level, off / 10.0, 0.001);
      EXPECT_NEAR(band.half_width, 1.96 * std::sqrt(0.005) / 10.0, 0.002);
      EXPECT_NEAR(band.force.real(), 0.0, 0.01);
      EXPECT_NEAR(band.force.imag(), -off / 2.0, 0.01);
      EXPECT_EQ(band.holds, off < 0.2) << band.p;
    }
    EXPECT_EQ(v.holds, off < 0.2);
  }
}

// Point. (1), (2) of SharedValue: 10 ± 1 and 13 ± 2 are 3/√5 apart, and together (10 + 13/4)/(1 + 1/4) = 10.6 with a
// deviation of √0.8. Of values that are positive by nature the same holds for their logarithms.
TEST(TransferBothRigs, ComparesAndPoolsAValue) {
  const auto plain = transfer::shared_value("a", "N", {10.0, 1.0}, {13.0, 2.0}, false);
  EXPECT_NEAR(plain.z, -3.0 / std::sqrt(5.0), 1e-12);
  EXPECT_TRUE(plain.equal);
  EXPECT_NEAR(plain.pooled.value, 10.6, 1e-12);
  EXPECT_NEAR(plain.pooled.upper - plain.pooled.value, 1.96 * std::sqrt(0.8), 1e-12);
  EXPECT_NEAR(plain.second.lower, 13.0 - 1.96 * 2.0, 1e-12);
  EXPECT_FALSE(transfer::shared_value("a", "N", {10.0, 1.0}, {17.0, 2.0}, false).equal);
  const auto logarithms = transfer::shared_value("a", "N", {std::log(10.0), 0.1}, {std::log(13.0), 0.2}, true);
  EXPECT_NEAR(logarithms.z, -std::log(1.3) / std::sqrt(0.05), 1e-12);
  EXPECT_NEAR(logarithms.pooled.value, 10.0 * std::pow(1.3, 0.2), 1e-12);
}

// Point. The second rig's own parameter comes with what its records leave of it: a half-width of 1.96 σ becomes the
// tolerance √3 σ of the same variance, unless the description says less. What travels stays as described.
TEST(TransferBothRigs, TakesTheSecondRigsOwnParameters) {
  const auto to =
      linear_pair::car("[tolerance]\n'tyre.stiffness' = 0.1\n'tyre.damping' = 0.01\n'suspension.stiffness' = 0.1\n");
  host_sim::identification::Diagnosis second;
  second.parameters["tyre.stiffness"] = {210e3, 210e3 - 1.96 * 2100.0, 210e3 + 1.96 * 2100.0};
  second.parameters["tyre.damping"] = {90.0, 90.0 - 1.96 * 9.0, 90.0 + 1.96 * 9.0};
  second.parameters["suspension.stiffness"] = {33e3, 32e3, 34e3};
  const auto own = transfer::with_own_effects(to, second);
  EXPECT_EQ(own.rig.tyre.stiffness, 210e3);
  EXPECT_NEAR(own.tolerance.at("tyre.stiffness"), 0.01 * std::numbers::sqrt3, 1e-12);
  EXPECT_EQ(own.rig.tyre.damping, 90.0);
  EXPECT_EQ(own.tolerance.at("tyre.damping"), 0.01);
  EXPECT_EQ(own.rig.suspension.stiffness, linear_pair::stiffness);
  EXPECT_EQ(own.tolerance.at("suspension.stiffness"), 0.1);
}

}  // namespace
