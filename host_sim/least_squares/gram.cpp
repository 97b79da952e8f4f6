#include "host_sim/least_squares/gram.hpp"

#include <array>
#include <cstddef>

#include "host_sim/signal/wide.hpp"

namespace host_sim {
namespace {

RIGTWIN_WIDE double inner_product(const double* a, const double* b, std::size_t n) {
  constexpr std::size_t sums = 8;
  std::array<double, sums> sum{};
  std::size_t k = 0;
  for (; k + sums <= n; k += sums) {
    for (std::size_t i = 0; i < sums; ++i) sum[i] += a[k + i] * b[k + i];
  }
  for (std::size_t i = 0; k + i < n; ++i) sum[i] += a[k + i] * b[k + i];
  return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

}  // namespace

Eigen::MatrixXd gram(const Eigen::MatrixXd& j) {
  const Eigen::Index n = j.cols();
  const auto rows = static_cast<std::size_t>(j.rows());
  Eigen::MatrixXd product(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b <= a; ++b) {
      product(a, b) = product(b, a) = inner_product(j.col(a).data(), j.col(b).data(), rows);
    }
  }
  return product;
}

Eigen::VectorXd transposed_product(const Eigen::MatrixXd& j, const Eigen::VectorXd& r) {
  Eigen::VectorXd product(j.cols());
  for (Eigen::Index a = 0; a < j.cols(); ++a) {
    product(a) = inner_product(j.col(a).data(), r.data(), static_cast<std::size_t>(j.rows()));
  }
  return product;
}

}  // namespace host_sim
