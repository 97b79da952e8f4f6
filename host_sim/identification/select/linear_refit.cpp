#include "host_sim/identification/select/linear_refit.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/least_squares/gram.hpp"

namespace host_sim::identification {

LinearRefit::LinearRefit(const Fit& base) : base_(base) {
  Eigen::MatrixXd h = gram(base.jacobian);
  for (Eigen::Index i = 0; i < h.rows(); ++i) {
    const bool free = !base.parameters[static_cast<std::size_t>(i)].at_bound(base.hypothesis);
    h(i, i) += (free ? 1e-10 : 1e12) * h(i, i) + 1e-30;
  }
  factor_.compute(h);
  residual_ = transposed_product(base.jacobian, base.residual);
}

LinearRefit::Left LinearRefit::left(const Eigen::VectorXd& d) const {
  Left left{d.squaredNorm(), base_.residual.dot(d)};
  if (base_.jacobian.cols() > 0) {
    const Eigen::VectorXd projection = transposed_product(base_.jacobian, d);
    const Eigen::VectorXd solved = factor_.solve(projection);
    left.square -= projection.dot(solved);
    left.along -= residual_.dot(solved);
  }
  return left;
}

double LinearRefit::gain(const Eigen::VectorXd& d) const {
  const auto [square, along] = left(d);
  if (!(square > 1e-9)) return 0.0;
  const double factor = std::clamp(-along / square, 0.0, 2.0);
  return -2.0 * factor * along - factor * factor * square;
}

double LinearRefit::free_gain(const Eigen::VectorXd& d) const {
  const auto [square, along] = left(d);
  return square > 1e-8 * d.squaredNorm() ? along * along / square : 0.0;
}

LinearRefit::Directions LinearRefit::directions(const Eigen::MatrixXd& d) const {
  Directions left{d.transpose() * d, d.transpose() * base_.residual};
  if (base_.jacobian.cols() > 0) {
    const Eigen::MatrixXd projection = base_.jacobian.transpose() * d;
    const Eigen::MatrixXd solved = factor_.solve(projection);
    left.matrix -= projection.transpose() * solved;
    left.gradient -= solved.transpose() * residual_;
  }
  return left;
}

Eigen::VectorXd LinearRefit::best_sizes(const Eigen::MatrixXd& d) const {
  const auto [matrix, gradient] = directions(d);
  const Eigen::VectorXd before = d.colwise().squaredNorm();
  Eigen::VectorXd scale(d.cols());
  for (Eigen::Index i = 0; i < d.cols(); ++i) {
    const bool left = matrix(i, i) > std::max(1e-8 * before[i], 1e-9);
    scale[i] = left ? 1.0 / std::sqrt(matrix(i, i)) : 0.0;
  }
  Eigen::MatrixXd unit = scale.asDiagonal() * matrix * scale.asDiagonal();
  unit.diagonal().array() += 1e-8;
  return -scale.cwiseProduct(unit.ldlt().solve(scale.cwiseProduct(gradient)));
}

}  // namespace host_sim::identification
