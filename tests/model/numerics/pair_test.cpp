#include "model/numerics/pair.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

namespace {

/// A scalar that is not double: the arithmetic every scalar type gets.
struct Scalar {
  double value{};
  Scalar() = default;
  explicit Scalar(double v) : value(v) {}
  friend Scalar operator+(Scalar a, Scalar b) { return Scalar(a.value + b.value); }
  friend Scalar operator-(Scalar a, Scalar b) { return Scalar(a.value - b.value); }
  friend Scalar operator-(Scalar a) { return Scalar(-a.value); }
  friend Scalar operator*(Scalar a, Scalar b) { return Scalar(a.value * b.value); }
  friend bool operator<(Scalar a, Scalar b) { return a.value < b.value; }
};

// Law. Each half is what it would be alone, and the two ways of computing agree to the bit.
TEST(Pair, ComputesEachHalfAsIfItWereAlone) {
  const double a0 = 0.1, a1 = -3.7e10, b0 = 1.0 / 3.0, b1 = 2e-17;
  const model::Pair<double> a(a0, a1), b(b0, b1);
  const model::Pair<Scalar> c{Scalar{a0}, Scalar{a1}}, d{Scalar{b0}, Scalar{b1}};
  const auto check = [](const model::Pair<double>& fast, const model::Pair<Scalar>& general, double first,
                        double second) {
    EXPECT_EQ(fast[0], first);
    EXPECT_EQ(fast[1], second);
    EXPECT_EQ(general[0].value, first);
    EXPECT_EQ(general[1].value, second);
  };
  check(a + b, c + d, a0 + b0, a1 + b1);
  check(a - b, c - d, a0 - b0, a1 - b1);
  check(a * b, c * d, a0 * b0, a1 * b1);
  check(abs(a), abs(c), a0, 3.7e10);
  check(model::Pair<double>::both(a1), model::Pair<Scalar>::both(Scalar(a1)), a1, a1);
}

// Point. A matrix of three columns times (1, 10, 100), in that order.
TEST(PackedColumns, MultipliesEachColumnByItsFactorAndSums) {
  Eigen::Matrix<double, 4, 3> matrix;
  matrix << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12;
  const model::PackedColumns<double, 4, 3> columns(matrix);
  auto sum = columns.times({1.0, 10.0, 100.0});
  for (std::size_t i = 0; i < 4; ++i) {
    const double first = 3.0 * static_cast<double>(i) + 1.0;
    EXPECT_EQ(sum[i], first + 10.0 * (first + 1.0) + 100.0 * (first + 2.0));
  }
  columns.add_to(sum, {0.0, -10.0, 0.0});
  Eigen::Matrix<double, 4, 1> stored;
  sum.store(stored);
  EXPECT_EQ(stored(0), 301.0);
  EXPECT_EQ(stored(3), 1210.0);
  EXPECT_EQ((sum + sum)[3], 2420.0);
}

}  // namespace
