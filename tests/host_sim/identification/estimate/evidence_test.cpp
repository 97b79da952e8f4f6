// The evidence beside a discrepancy: problems whose evidence is known, limits, slopes.
#include "host_sim/identification/estimate/evidence.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace {

using namespace host_sim::identification;
using host_sim::identification::Power;

/// (1) of evidence.hpp.
double left_with(double power, double count, double directions, double s) {
  const double x = std::max(power - count, 0.0);
  return power - x + directions * std::log1p(s) + (directions + x) / (1.0 + s) - directions;
}

// Point. Residuals r = noise + B z of known directions: with |r|² = ν − K across them and K + x along them the exact
// −2 ln of the likelihood, r⊥² + K ln(1 + s) + r∥²/(1 + s), is (1).
TEST(Evidence, IsTheLikelihoodOfAGaussianDiscrepancy) {
  constexpr double count = 100.0, directions = 3.0, x = 40.0;
  for (const double s : {0.0, 0.3, 5.0, 200.0}) {
    const double across = count - directions, along = directions + x;
    const double exact = across + directions * std::log1p(s) + along / (1.0 + s);
    EXPECT_NEAR(left_with(count + x, count, directions, s), exact, 1e-9) << s;
  }
}

// Law. (2) is the least value of (1) over s, and (3) its slope; at the noise and below both are those of χ².
TEST(Evidence, IsTheLeastOverTheSizeOfTheDiscrepancy) {
  constexpr double count = 500.0, directions = 4.0;
  for (const double power : {510.0, 600.0, 1e4, 1e9}) {
    double least = INFINITY;
    for (double ln = -8.0; ln < 25.0; ln += 1e-3)
      least = std::min(least, left_with(power, count, directions, std::exp(ln)));
    EXPECT_NEAR(tempered_power({power, count}, directions), least, 1e-3) << power;
    const double h = 1e-4 * power;
    const double slope =
        (tempered_power({power + h, count}, directions) - tempered_power({power - h, count}, directions)) / (2.0 * h);
    EXPECT_NEAR(tempered_weight({power, count}, directions) / slope, 1.0, 1e-2) << power;
  }
  EXPECT_EQ(tempered_power({480.0, count}, directions), 480.0);
  EXPECT_EQ(tempered_weight({480.0, count}, directions), 1.0);
  // Far above the noise a share counts, whatever the size: K ln(1/0.7) for a third less.
  EXPECT_NEAR(tempered_power({1e8, count}, directions) - tempered_power({0.7e8, count}, directions),
              directions * std::log(1.0 / 0.7), 1e-3);
}

// Limits of (6). Noise scatters by √(2ν): a weight of 1/(1 + x/K) would be 1/16 there, though nothing but noise is left.
// Far above it the two agree, since the power says s.
TEST(Evidence, KnowsADiscrepancyByThePowerAlone) {
  const DiscrepancyModel discrepancy;
  constexpr double count = 2000.0;
  const double deviation = std::sqrt(2.0 * count);
  EXPECT_LT(tempered_weight({count + deviation, count}, discrepancy.directions), 0.07);
  EXPECT_GT(weight_of({count + deviation, count}, discrepancy), 0.98);
  EXPECT_EQ(weight_of({count - deviation, count}, discrepancy), 1.0);
  const Power far{count + 1e7, count};
  EXPECT_NEAR(weight_of(far, discrepancy) / tempered_weight(far, discrepancy.directions), 1.0, 1e-6);
  EXPECT_NEAR(tempered_power(Power{1e8, count}, discrepancy) - tempered_power(Power{0.7e8, count}, discrepancy),
              discrepancy.directions * std::log(1.0 / 0.7), 0.05);
  // Growing, with its own weight as slope.
  for (double power = 1.001 * count; power < 1e5; power *= 1.05) {
    const double h = 1e-3 * power;
    const double rise =
        tempered_power(Power{power + h, count}, discrepancy) - tempered_power(Power{power - h, count}, discrepancy);
    EXPECT_GE(rise, 0.0) << power;
    EXPECT_LE(rise, 2.0 * h * 1.05) << power;
  }
}

// Law. Noise of ν = 20 … 2000 residuals is given less than the chance c to hold something, whatever ν: the mean over 2000
// powers of noise is 0.5 … 2 times that of ν = 2000, so bands of few residuals raise no more alarms.
TEST(Evidence, AsksNoiseOfFewAndOfManyResidualsAlike) {
  const DiscrepancyModel discrepancy;
  std::mt19937_64 random(7);
  std::vector<double> means;
  for (const double count : {20.0, 200.0, 2000.0}) {
    std::chi_squared_distribution<double> noise(count);
    double sum = 0.0;
    for (int i = 0; i < 2000; ++i) sum += chance_of_discrepancy(Power{noise(random), count}, discrepancy);
    means.push_back(sum / 2000.0);
    EXPECT_LT(means.back(), discrepancy.chance) << count;
  }
  for (const double mean : means) EXPECT_NEAR(std::log2(mean / means.back()), 0.0, 1.0);
}

// Law. Noise that is known to 5 % only is no discrepancy when it is 8 % louder, however many residuals show it.
TEST(Evidence, AllowsForNoiseThatIsNotKnown) {
  const Power louder{1.08e5, 1e5};
  DiscrepancyModel discrepancy;
  EXPECT_GT(chance_of_discrepancy(louder, discrepancy), 0.99);
  discrepancy.noise_error = 0.05;
  EXPECT_LT(chance_of_discrepancy(louder, discrepancy), 0.2);
  EXPECT_GT(chance_of_discrepancy(Power{1.6e5, 1e5}, discrepancy), 0.99);
}

// Point. Any of several independent bands.
TEST(Evidence, JoinsTheBands) {
  const DiscrepancyModel discrepancy;
  const Power noise{100.0, 100.0}, weak{160.0, 100.0};
  const double one = chance_of_discrepancy(noise, discrepancy), other = chance_of_discrepancy(weak, discrepancy);
  EXPECT_NEAR(chance_of_discrepancy({noise, weak}, discrepancy), 1.0 - (1.0 - one) * (1.0 - other), 1e-12);
  EXPECT_LT(one, discrepancy.chance);
  EXPECT_GT(other, one);
  EXPECT_GT(chance_of_discrepancy(Power{1e4, 100.0}, discrepancy), 0.999);
  EXPECT_EQ(chance_of_discrepancy(Power{}, discrepancy), 0.0) << "no residual in the band";
}

// Law. A straight line through the origin with noise of variance 1 and a slope that is anywhere in a width: (7) is the
// exact −2 ln ∫ exp(−½ χ²) du/width, less the least χ², by quadrature. Two correlated parameters likewise.
TEST(Occam, IsTheIntegralOverAGaussian) {
  const Eigen::Matrix2d information{{5.0, 3.0}, {3.0, 4.0}};
  const std::vector<double> widths{40.0, 60.0};
  double sum = 0.0;
  constexpr double h = 0.02;
  for (double u = -20.0; u < 20.0; u += h) {
    for (double v = -20.0; v < 20.0; v += h) {
      const Eigen::Vector2d at{u, v};
      sum += std::exp(-0.5 * at.dot(information * at)) * h * h;
    }
  }
  const double exact = -2.0 * std::log(sum / (widths[0] * widths[1]));
  EXPECT_NEAR(occam_factor(widths, information.inverse()), exact, 1e-3);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Constant(1, 1, 0.01);
  EXPECT_NEAR(occam_factor({5.0}, one), 2.0 * std::log(5.0) - std::log(2.0 * std::numbers::pi) - std::log(0.01), 1e-9);
  // What the recordings do not narrow costs nothing.
  EXPECT_EQ(occam_factor({5.0}, Eigen::MatrixXd::Constant(1, 1, 1e6)), 0.0);
}

// Point. Odds of 3 : 1 are 2 ln 3 apart; also where all values are large.
TEST(Posterior, IsNormalised) {
  const auto shares = posterior_of({1e6, 1e6 + 2.0 * std::log(3.0), 2e6});
  EXPECT_NEAR(shares[0], 0.75, 1e-9);
  EXPECT_NEAR(shares[1], 0.25, 1e-9);
  EXPECT_EQ(shares[2], 0.0);
  EXPECT_TRUE(posterior_of({}).empty());
}

}  // namespace
