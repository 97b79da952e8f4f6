// The posterior of a component: evidence, draws, and what widens them.
#include "host_sim/transfer/posterior/posterior.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/identification/estimate/uncertainty.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "tests/host_sim/transfer/linear_pair.hpp"

namespace posterior_test {
namespace {

namespace id = host_sim::identification;
namespace transfer = host_sim::transfer;

const std::string tolerance = "[tolerance]\n\"suspension.stiffness\" = 0.05\n";

/// A bench of 8 s, its spring fitted.
struct Fitted {
  explicit Fitted(double temper)
      : rig(linear_pair::bench(tolerance)),
        p(linear_pair::problem_of(rig, linear_pair::recorded(rig, 8.0))),
        model(transfer::laplace_model(p.problem, p.space, id::fit(p.problem, p.given, p.space.common), temper)) {}
  firmware::RigDescription rig;
  linear_pair::Problem p;
  transfer::ComponentModel model;
};

double variance_of_draws(const transfer::ComponentModel& model) {
  const Eigen::VectorXd row = model.draws.row(0);
  return (row.array() - row.mean()).square().mean();
}

// Point. (2): the evidence is the integral of the likelihood over the prior, here by the trapezium rule over eight
// standard deviations. A spring makes χ² quadratic, so Laplace is exact but for the prior's 12/width² in its curvature.
TEST(TransferPosterior, HasTheEvidenceThatIsTheIntegralOfTheLikelihood) {
  constexpr double temper = 2.0;
  const Fitted f(temper);
  ASSERT_EQ(f.model.mode.size(), 1);
  const double deviation = std::sqrt(f.model.covariance(0, 0)), at = f.model.mode(0);
  const double width = f.model.parameters[0].upper - f.model.parameters[0].lower;
  ASSERT_GT(0.5 * width, std::abs(at) + 8.0 * deviation) << "the likelihood must lie inside of the bounds";
  double sum = 0.0;
  constexpr int half = 40;
  for (int i = -half; i <= half; ++i) {
    const double u = at + 8.0 * deviation * i / half;
    const id::Prediction seen = id::predict(f.p.problem, f.model.at(Eigen::VectorXd::Constant(1, u)));
    const double chi_squared = id::residuals(f.p.problem, seen).squaredNorm();
    sum += std::exp(-0.5 * (chi_squared - f.model.chi_squared) / temper) * 8.0 * deviation / half;
  }
  const double exact = std::log(sum / width) - 0.5 * f.model.chi_squared / temper;
  const double prior = 0.5 * 12.0 / (width * width) * deviation * deviation;
  EXPECT_NEAR(f.model.log_evidence, exact, 1e-3 + 2.0 * prior);
}

// Law. (1), (3): the draws have the covariance that the model says, with the temper; 8000 draws, some 5000 of them
// independent, know a variance to 2 %, four of these are allowed.
TEST(TransferPosterior, DrawsWithTheCovarianceOfItsModel) {
  for (const double temper : {1.0, 4.0}) {
    Fitted f(temper);
    transfer::Discrepancy none;
    none.widening = Eigen::MatrixXd::Zero(1, 1);
    const auto report = transfer::sample_model(f.p.problem, temper, none, {10000, 3, {}}, f.model);
    EXPECT_LT(report.largest_rhat, 1.02);
    EXPECT_NEAR(variance_of_draws(f.model) / f.model.covariance(0, 0), 1.0, 0.08) << temper;
  }
  EXPECT_NEAR(Fitted(4.0).model.covariance(0, 0) / Fitted(1.0).model.covariance(0, 0), 4.0, 0.1);
}

// Law. (4): what a discrepancy may have moved the parameter by is added to the draws and to the covariance: V of three
// standard deviations makes ten times the variance.
TEST(TransferPosterior, IsWidenedByADiscrepancy) {
  Fitted f(1.0);
  const double plain = f.model.covariance(0, 0);
  transfer::Discrepancy rest;
  rest.bands.push_back({1.0, 2.0, 0.1, 10.0});
  rest.widening = Eigen::MatrixXd::Constant(1, 1, 9.0 * plain);
  (void)transfer::sample_model(f.p.problem, 1.0, rest, {10000, 3, {}}, f.model);
  EXPECT_NEAR(f.model.covariance(0, 0) / (10.0 * plain), 1.0, 1e-9);
  EXPECT_NEAR(variance_of_draws(f.model) / (10.0 * plain), 1.0, 0.08);
}

// Law. (3): where the first half of a recording is another spring than the second, residuals come in bursts. The draws
// are as wide as estimate/uncertainty.hpp says, which is more than the likelihood's own width.
TEST(TransferPosterior, IsStretchedWhereResidualsAreMoreThanNoise) {
  const auto rig = linear_pair::bench(tolerance, 1.0);
  firmware::Recording recording = linear_pair::recorded(rig, 16.0);
  std::vector<double>& force = recording[model::Channel::F];
  for (std::size_t k = 0; k < force.size() / 2; ++k) force[k] *= 1.04;
  const linear_pair::Problem p = linear_pair::problem_of(rig, std::move(recording));
  const id::Fit fit = id::fit(p.problem, p.given, p.space.common);
  const double temper = id::temper_of(fit);
  ASSERT_GT(temper, 1.5);
  transfer::ComponentModel model = transfer::laplace_model(p.problem, p.space, fit, temper);
  const double wanted = id::uncertainty(p.problem, p.space.suspects, fit).half_widths(0) / 1.96;
  const double plain = fit.covariance()(0, 0) * temper;
  ASSERT_GT(wanted, 1.3 * std::sqrt(plain));
  EXPECT_NEAR(model.covariance(0, 0) / (wanted * wanted), 1.0, 0.02);
  transfer::Discrepancy none;
  none.widening = Eigen::MatrixXd::Zero(1, 1);
  (void)transfer::sample_model(p.problem, temper, none, {10000, 3, {}}, model);
  EXPECT_NEAR(variance_of_draws(model) / (wanted * wanted), 1.0, 0.08);
}

// Law. The same recording where only 1 % is tolerated: the spring lies at its bound, its half width says nothing, and
// the draws lie on one side of the bound, as far as the likelihood says.
TEST(TransferPosterior, StaysAtABound) {
  const auto rig = linear_pair::bench("[tolerance]\n\"suspension.stiffness\" = 0.01\n", 1.0);
  firmware::Recording recording = linear_pair::recorded(rig, 16.0);
  std::vector<double>& force = recording[model::Channel::F];
  for (std::size_t k = 0; k < force.size() / 2; ++k) force[k] *= 1.08;
  const linear_pair::Problem p = linear_pair::problem_of(rig, std::move(recording));
  const id::Fit fit = id::fit(p.problem, p.given, p.space.common);
  const double temper = id::temper_of(fit), bound = fit.parameters[0].upper;
  ASSERT_GT(temper, 1.5);
  ASSERT_NEAR(fit.parameters[0].get(fit.hypothesis), bound, 1e-9);
  transfer::ComponentModel model = transfer::laplace_model(p.problem, p.space, fit, temper);
  const double plain = std::sqrt(fit.covariance()(0, 0) * temper);
  EXPECT_NEAR(std::sqrt(model.covariance(0, 0)) / plain, 1.0, 0.1);
  transfer::Discrepancy none;
  none.widening = Eigen::MatrixXd::Zero(1, 1);
  (void)transfer::sample_model(p.problem, temper, none, {10000, 3, {}}, model);
  EXPECT_LE(model.draws.maxCoeff(), bound);
  EXPECT_GT(model.draws.row(0).mean(), bound - plain);
}

}  // namespace
}  // namespace posterior_test
