// The sampler and its diagnostics, against densities whose moments are known.
#include "host_sim/transfer/posterior/sampler.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "firmware/simulation/gaussian.hpp"
#include "host_sim/transfer/common/statistics.hpp"

namespace sampler_test {
namespace {

using host_sim::transfer::Samples;

constexpr double far = 1e9;

Samples samples_of_normal(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& proposed, double lower,
                          std::size_t draws) {
  const Eigen::MatrixXd precision = covariance.inverse();
  const Eigen::VectorXd mode = Eigen::VectorXd::Zero(covariance.rows());
  return host_sim::transfer::sample(
      [&](const std::vector<Eigen::VectorXd>& at) {
        std::vector<double> values;
        for (const auto& u : at) values.push_back(-0.5 * u.dot(precision * u));
        return values;
      },
      mode, proposed, Eigen::VectorXd::Constant(mode.size(), lower), Eigen::VectorXd::Constant(mode.size(), far),
      {draws, 3, {}});
}

// Point. Mean and covariance of a correlated normal: 8000 draws, some 4000 effective, know a variance to 2.2 %; four of
// these are allowed.
TEST(TransferSampler, DrawsACorrelatedNormal) {
  Eigen::MatrixXd covariance(2, 2);
  covariance << 4.0, 1.5, 1.5, 1.0;
  const Samples samples = samples_of_normal(covariance, covariance, -far, 10000);
  const Eigen::MatrixXd all = samples.all();
  ASSERT_EQ(all.cols(), 8000);
  const Eigen::VectorXd mean = all.rowwise().mean();
  const Eigen::MatrixXd centred = all.colwise() - mean;
  const Eigen::MatrixXd found = centred * centred.transpose() / 7999.0;
  EXPECT_NEAR(mean(0) / 2.0, 0.0, 0.07);
  EXPECT_NEAR(mean(1), 0.0, 0.07);
  EXPECT_NEAR(found(0, 0) / 4.0, 1.0, 0.09);
  EXPECT_NEAR(found(0, 1) / 1.5, 1.0, 0.13);
  EXPECT_LT(samples.rhat.maxCoeff(), 1.01);
  EXPECT_GT(samples.effective.minCoeff(), 2000.0);
  EXPECT_GT(samples.accepted, 0.5);
}

// Law. A Laplace approximation that is three times too narrow still proposes; the walk adapts and the draws are right.
TEST(TransferSampler, CorrectsALaplaceApproximationThatIsTooNarrow) {
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(2, 2);
  const Samples samples = samples_of_normal(covariance, covariance / 9.0, -far, 10000);
  for (int i = 0; i < 2; ++i) {
    const Eigen::VectorXd row = samples.all().row(i);
    EXPECT_NEAR((row.array() - row.mean()).square().mean(), 1.0, 0.2) << i;
  }
}

// Point. Beyond a bound there is nothing: the half normal has the mean √(2/π).
TEST(TransferSampler, StaysInsideItsBounds) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(1, 1);
  const Eigen::VectorXd row = samples_of_normal(one, one, 0.0, 10000).all().row(0);
  EXPECT_GE(row.minCoeff(), 0.0);
  EXPECT_NEAR(row.mean(), std::sqrt(2.0 / 3.141592653589793), 0.05);
}

// Fault. Chains that stay where they began, each in another place, have not converged, however quiet each of them is.
TEST(TransferSampler, SaysWhereChainsDoNotMeet) {
  firmware::Gaussian normal(5, 1);
  std::vector<Eigen::MatrixXd> apart, together;
  for (int c = 0; c < 8; ++c) {
    const Eigen::MatrixXd chain = Eigen::MatrixXd::NullaryExpr(1, 500, [&] { return normal(); });
    together.push_back(chain);
    apart.emplace_back(chain.array() + 3.0 * c);
  }
  EXPECT_GT(host_sim::transfer::split_rhat(apart)(0), 3.0);
  EXPECT_LT(host_sim::transfer::split_rhat(together)(0), 1.01);
}

// Point. Two chains by hand, in halves 0 2, 0 2, 4 6, 4 6: within them the variance is 2, between their means 16/3, so
// R̂² = (2 · 1/2 + 16/3)/2.
TEST(TransferSampler, ComparesHalvesOfChains) {
  std::vector<Eigen::MatrixXd> chains;
  for (const double lowest : {0.0, 4.0}) {
    chains.emplace_back(1, 4);
    chains.back() << lowest, lowest + 2.0, lowest, lowest + 2.0;
  }
  EXPECT_NEAR(host_sim::transfer::split_rhat(chains)(0), std::sqrt((1.0 + 16.0 / 3.0) / 2.0), 1e-12);
}

// Point. An autoregression x ← ρ x + … has (1 − ρ)/(1 + ρ) effective draws each: 1/19 for 0.9. Eight chains of 4000
// know it to some 10 %; three of these are allowed.
TEST(TransferSampler, CountsEffectiveDraws) {
  firmware::Gaussian normal(6, 1);
  std::vector<Eigen::MatrixXd> chains;
  for (int c = 0; c < 8; ++c) {
    Eigen::MatrixXd chain(1, 4000);
    double x = normal() / std::sqrt(1.0 - 0.81);
    for (Eigen::Index k = 0; k < chain.cols(); ++k) chain(0, k) = x = 0.9 * x + normal();
    chains.push_back(chain);
  }
  EXPECT_NEAR(host_sim::transfer::effective_draws(chains)(0) / (32000.0 / 19.0), 1.0, 0.3);
}

// Point. Tables of χ²: 5 % beyond 7.815 (3), 18.307 (10), 124.34 (100). The approximation is good to 1 % of them.
TEST(TransferStatistics, KnowTheTailOfChiSquared) {
  using host_sim::transfer::chi_squared_tail;
  EXPECT_NEAR(chi_squared_tail(7.815, 3), 0.05, 1e-3);
  EXPECT_NEAR(chi_squared_tail(18.307, 10), 0.05, 5e-4);
  EXPECT_NEAR(chi_squared_tail(124.34, 100), 0.05, 2e-4);
  EXPECT_EQ(chi_squared_tail(0.0, 3), 1.0);
}

// Point. Quantiles by hand: of 1 … 5 the quarter is 2, the median 3, 2.5 % is 1.1.
TEST(TransferStatistics, TakeQuantilesBetweenDraws) {
  const auto bands = host_sim::transfer::bands_of({5, 3, 1, 4, 2});
  EXPECT_DOUBLE_EQ(bands.median, 3.0);
  EXPECT_DOUBLE_EQ(bands.low50, 2.0);
  EXPECT_DOUBLE_EQ(bands.high50, 4.0);
  EXPECT_DOUBLE_EQ(bands.low95, 1.1);
  EXPECT_DOUBLE_EQ(bands.high95, 4.9);
}

// Law. The tail of draws that are a scaled χ² of 4: x = 3 · 9.488 has 5 %. 4000 draws know mean and variance to 3 %.
TEST(TransferStatistics, ContinueTheTailOfDraws) {
  firmware::Gaussian normal(7, 1);
  std::vector<double> draws;
  for (int i = 0; i < 4000; ++i) {
    double sum = 0.0;
    for (int j = 0; j < 4; ++j) sum += std::pow(normal(), 2);
    draws.push_back(3.0 * sum);
  }
  EXPECT_NEAR(host_sim::transfer::tail_probability(3.0 * 9.488, draws), 0.05, 0.01);
}

}  // namespace
}  // namespace sampler_test
