#include "tests/confusion/black_box.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace confusion {
namespace {

constexpr std::size_t every = 5, delays = 2;

std::vector<double> thinned(const std::vector<double>& values) {
  std::vector<double> kept;
  for (std::size_t k = 0; k < values.size(); k += every) kept.push_back(values[k]);
  return kept;
}

}  // namespace

BlackBox::BlackBox(const firmware::Recording& bench)
    : stroke_(thinned(bench[model::Channel::x_act])), force_(thinned(bench[model::Channel::F])) {
  fitted_ = stroke_.size() * 3 / 4;
  double largest = 1e-12;  // columns of one size
  for (const double x : stroke_) largest = std::max(largest, std::abs(x));
  for (double& x : stroke_) x /= largest;
  const Eigen::VectorXd first = row(force_, delays);
  Eigen::MatrixXd a(static_cast<Eigen::Index>(fitted_ - delays), first.size());
  Eigen::VectorXd b(a.rows());
  for (std::size_t k = delays; k < fitted_; ++k) {
    const auto i = static_cast<Eigen::Index>(k - delays);
    a.row(i) = row(force_, k).transpose();
    b(i) = force_[k];
  }
  values_ = a.colPivHouseholderQr().solve(b);
}

double BlackBox::error() const {
  std::vector<double> force = force_;
  double squares = 0.0, size = 0.0;
  for (std::size_t k = fitted_; k < force.size(); ++k) {
    force[k] = values_.dot(row(force, k));
    squares += std::pow(force[k] - force_[k], 2);
    size += std::pow(force_[k], 2);
  }
  const double error = size > 0.0 ? std::sqrt(squares / size) : 0.0;
  return std::isfinite(error) ? error : INFINITY;
}

Eigen::VectorXd BlackBox::row(const std::vector<double>& force, std::size_t k) const {
  std::vector<double> terms{force[k - 1], force[k - 2], 1.0};
  for (std::size_t i = 0; i <= delays; ++i) {
    const double x = stroke_[k - i];
    terms.push_back(x);
    for (std::size_t j = i; j <= delays; ++j) {
      terms.push_back(x * stroke_[k - j]);
      for (std::size_t l = j; l <= delays; ++l) terms.push_back(x * stroke_[k - j] * stroke_[k - l]);
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(terms.data(), static_cast<Eigen::Index>(terms.size()));
}

}  // namespace confusion
