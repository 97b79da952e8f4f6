#include "host_sim/least_squares/gram.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace {

Eigen::MatrixXd waves(Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd j(rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    for (Eigen::Index c = 0; c < columns; ++c) j(i, c) = std::sin(0.1 * static_cast<double>((i + 1) * (c + 2)));
  }
  return j;
}

// Law. JᵀJ and Jᵀr of any length are those of Eigen within the rounding of their sums, and JᵀJ is symmetric to the bit.
TEST(Gram, IsTheProductOfTheColumns) {
  for (const Eigen::Index rows : {0, 1, 7, 8, 9, 1000, 1023}) {
    const Eigen::MatrixXd j = waves(rows, 3);
    const Eigen::VectorXd r = waves(rows, 1);
    const double rounding = 1e-13 * static_cast<double>(rows + 1);
    EXPECT_LE((host_sim::gram(j) - j.transpose() * j).cwiseAbs().maxCoeff(), rounding) << rows;
    EXPECT_LE((host_sim::transposed_product(j, r) - j.transpose() * r).cwiseAbs().maxCoeff(), rounding) << rows;
    EXPECT_EQ(host_sim::gram(j), host_sim::gram(j).transpose().eval());
  }
}

// Point. The order of the sums is the one that stands in the header, whatever the processor: eight partial sums, added
// in pairs.
TEST(Gram, SumsInItsOwnOrderOnEveryProcessor) {
  const Eigen::MatrixXd j = waves(801, 2);
  std::array<double, 8> sum{};
  for (Eigen::Index i = 0; i < j.rows(); ++i) sum[static_cast<std::size_t>(i % 8)] += j(i, 0) * j(i, 1);
  const double wanted = ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
  EXPECT_EQ(host_sim::gram(j)(0, 1), wanted);
}

}  // namespace
