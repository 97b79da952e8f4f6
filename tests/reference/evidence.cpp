#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/reference/diagnose.hpp"

namespace reference {

double counted(const Cell& cell) {
  const double x = cell.power - cell.count;
  return x > 0.0 ? cell.count + directions * std::log1p(x / directions) : cell.power;
}

double weight(const Cell& cell) { return 1.0 / (1.0 + std::max(cell.power - cell.count, 0.0) / directions); }

double occam(const Eigen::MatrixXd& hessian, const std::vector<double>& widths) {
  Eigen::MatrixXd information = hessian;
  double sum = 0.0;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    information.diagonal()(static_cast<Eigen::Index>(i)) += 12.0 / (widths[i] * widths[i]);
    sum += 2.0 * std::log(widths[i]) - std::log(2.0 * std::numbers::pi);
  }
  return sum + information.ldlt().vectorD().array().max(1e-300).log().sum();  // −ln|C| = ln|C⁻¹|
}

double unexplained(const std::vector<Cell>& cells) {
  const double chance = 1.0 - std::pow(1.0 - outside_share, 1.0 / static_cast<double>(cells.size()));
  double none = 1.0;
  for (const Cell& cell : cells) {
    if (!(cell.power > cell.count)) continue;
    const double q = 2.0 / (9.0 * cell.count);
    const double z = std::max((std::cbrt(cell.power / cell.count) - 1.0 + q) / std::sqrt(q), 1.0);
    const double spread = std::sqrt(2.0 * std::numbers::pi) / (z * 10.0 * std::numbers::ln10);
    none /= 1.0 + chance / (1.0 - chance) * spread * std::exp(0.5 * z * z);
  }
  return 1.0 - none;
}

std::vector<double> posterior(const std::vector<double>& minus_two_ln) {
  const double least = *std::min_element(minus_two_ln.begin(), minus_two_ln.end());
  std::vector<double> shares;
  double sum = 0.0;
  for (const double value : minus_two_ln) {
    const double share = std::exp(-0.5 * (value - least));
    sum += shares.emplace_back(share > 1e-3 ? share : 0.0);
  }
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace reference
