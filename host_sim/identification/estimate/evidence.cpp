#include "host_sim/identification/estimate/evidence.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace host_sim::identification {
namespace {

double excess_of(const Power& left) { return std::max(left.excess(), 0.0); }

/// (4)
double deviations_of(const Power& left, const DiscrepancyModel& discrepancy) {
  const double spread = 2.0 / (9.0 * left.count);
  const double z = (std::cbrt(left.ratio()) - 1.0 + spread) / std::sqrt(spread);
  return z / std::sqrt(1.0 + 0.5 * discrepancy.noise_error * discrepancy.noise_error * left.count);
}

/// ln of (5)
double log_odds(const Power& left, const DiscrepancyModel& discrepancy) {
  const double z = std::max(deviations_of(left, discrepancy), 1.0);
  const double width = discrepancy.orders_of_magnitude * std::numbers::ln10;
  return std::log(discrepancy.chance / (1.0 - discrepancy.chance) * std::sqrt(2.0 * std::numbers::pi) / (z * width)) +
         0.5 * z * z;
}

}  // namespace

double tempered_power(const Power& left, double directions) {
  const double x = excess_of(left);
  return x > 0.0 ? left.count + directions * std::log1p(x / directions) : left.squares;
}

double tempered_weight(const Power& left, double directions) { return 1.0 / (1.0 + excess_of(left) / directions); }

double weight_of(const Power& left, const DiscrepancyModel& discrepancy) {
  if (!(left.count > 0.0) || left.excess() <= 0.0) return 1.0;
  const double some = chance_of_discrepancy(left, discrepancy);
  return 1.0 - some + some * tempered_weight(left, discrepancy.directions);
}

double tempered_power(const Power& left, const DiscrepancyModel& discrepancy) {
  if (!(left.count > 0.0) || left.excess() <= 0.0) return left.squares;
  // By trapezia that grow with the distance from the noise, as w falls by powers of it.
  constexpr double first = 0.25, growth = 1.15;  // [√(2ν)]
  double at = 0.0, step = first * std::sqrt(2.0 * left.count), sum = 0.0, before = 1.0;
  while (at < left.excess()) {
    const double next = std::min(at + step, left.excess());
    const double w = weight_of({left.count + next, left.count}, discrepancy);
    sum += 0.5 * (w + before) * (next - at);
    at = next;
    before = w;
    step *= growth;
  }
  return left.count + sum;
}

double chance_of_discrepancy(const Power& left, const DiscrepancyModel& discrepancy) {
  return left.count > 0.0 ? 1.0 / (1.0 + std::exp(-log_odds(left, discrepancy))) : 0.0;
}

double chance_of_discrepancy(const std::vector<Power>& left, const DiscrepancyModel& discrepancy) {
  double none = 1.0;
  for (const Power& each : left) none *= 1.0 - chance_of_discrepancy(each, discrepancy);
  return 1.0 - none;
}

double occam_factor(const std::vector<double>& widths, const Eigen::MatrixXd& covariance) {
  // In units of the widths, where an uninformed parameter has the variance 1/2π of the normal density that is 1 at its
  // top.
  Eigen::MatrixXd relative = covariance;
  for (Eigen::Index i = 0; i < relative.rows(); ++i) {
    relative.row(i) /= widths[static_cast<std::size_t>(i)];
    relative.col(i) /= widths[static_cast<std::size_t>(i)];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(relative, Eigen::EigenvaluesOnly);
  double sum = 0.0;
  for (const double variance : solver.eigenvalues()) {
    sum -= std::log(2.0 * std::numbers::pi * std::clamp(variance, 1e-300, 0.5 / std::numbers::pi));
  }
  return sum;
}

std::vector<double> posterior_of(const std::vector<double>& minus_two_ln_evidence) {
  std::vector<double> shares;
  if (minus_two_ln_evidence.empty()) return shares;
  const double least = *std::min_element(minus_two_ln_evidence.begin(), minus_two_ln_evidence.end());
  double sum = 0.0;
  for (const double value : minus_two_ln_evidence) sum += shares.emplace_back(std::exp(-0.5 * (value - least)));
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace host_sim::identification
