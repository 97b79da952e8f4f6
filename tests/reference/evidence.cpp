#include "tests/reference/evidence.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace reference {

double counted(const Cell& cell) {
  const double x = cell.power - cell.count;
  return x > 0.0 ? cell.count + directions * std::log1p(x / directions) : cell.power;
}

double weight(const Cell& cell) { return 1.0 / (1.0 + std::max(cell.power - cell.count, 0.0) / directions); }

double occam(const Eigen::MatrixXd& hessian, const std::vector<double>& widths) {
  Eigen::MatrixXd information = hessian;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < hessian.rows(); ++i) {
    const double width = widths[static_cast<std::size_t>(i)];
    information(i, i) += 12.0 / (width * width);
    sum += 2.0 * std::log(width) - std::log(2.0 * std::numbers::pi);
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(information);
  for (const double d : solver.vectorD()) sum += std::log(std::max(d, 1e-300));  // −ln|C| = ln|C⁻¹|
  return sum;
}

double unexplained(const std::vector<Cell>& cells, double outside) {
  const double chance = 1.0 - std::pow(1.0 - outside, 1.0 / static_cast<double>(cells.size()));
  double none = 1.0;
  for (const Cell& cell : cells) {
    if (!(cell.power > cell.count)) continue;
    const double q = 2.0 / (9.0 * cell.count);
    const double z = std::max((std::cbrt(cell.power / cell.count) - 1.0 + q) / std::sqrt(q), 1.0);
    const double odds = chance / (1.0 - chance) * std::sqrt(2.0 * std::numbers::pi) / (z * 10.0 * std::numbers::ln10);
    none /= 1.0 + odds * std::exp(0.5 * z * z);
  }
  return 1.0 - none;
}

std::vector<double> posterior(const std::vector<double>& minus_two_ln) {
  std::vector<double> shares;
  const double least = *std::min_element(minus_two_ln.begin(), minus_two_ln.end());
  double sum = 0.0;
  for (const double value : minus_two_ln) {
    const double share = std::exp(-0.5 * (value - least));
    sum += shares.emplace_back(share > 1e-3 ? share : 0.0);
  }
  for (double& share : shares) share /= sum;
  return shares;
}

}  // namespace reference
