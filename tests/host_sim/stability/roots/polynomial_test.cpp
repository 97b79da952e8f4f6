// Polynomials: arithmetic, expansion, and roots that are all there.
#include "host_sim/stability/roots/polynomial.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "host_sim/stability/roots/eigenvalues.hpp"

namespace {

using namespace host_sim::stability;

// Point. p = 2 + 3s + s³ and q = 1 − s, by hand.
TEST(Polynomial, AddsMultipliesAndDifferentiates) {
  const Polynomial p{2.0, 3.0, 0.0, 1.0}, q{1.0, -1.0};
  EXPECT_EQ((p + q)[0], 3.0);
  EXPECT_EQ((p + q)[1], 2.0);
  EXPECT_EQ((p + q).degree(), 3);
  const Polynomial product = p * q;  // 2 + s − 3s² + s³ − s⁴
  const double expected[] = {2.0, 1.0, -3.0, 1.0, -1.0};
  ASSERT_EQ(product.degree(), 4);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(product[k], expected[k]) << k;
  EXPECT_EQ(p.derivative()[2], 3.0);
  EXPECT_EQ(p.derivative()[0], 3.0);
  EXPECT_EQ(p(2.0), 16.0);
  EXPECT_EQ(p.mirrored()(2.0), p(-2.0));
  EXPECT_EQ(p.stretched(3.0)(2.0), p(6.0));
  EXPECT_EQ(p.magnitude(2.0), 16.0);
  EXPECT_EQ(Polynomial({1.0, -1.0}).magnitude(2.0), 3.0);
  EXPECT_EQ((p - p).degree(), -1);  // highest terms that cancel are gone
  EXPECT_EQ((-2.0 * p)[3], -2.0);
  EXPECT_THROW(Polynomial(std::vector<double>{1.0, std::numeric_limits<double>::infinity()}), std::domain_error);
}

// Law. p(s + δ) from the expansion is p at s + δ; the jet is value and slope.
TEST(Polynomial, ExpandsAboutAPoint) {
  const Polynomial p{5.0, -1.0, 2.0, 0.5, 1.0};
  const Complex s(0.3, -2.0), delta(-0.4, 0.7);
  std::array<Complex, Polynomial::capacity> t;
  p.expand(s, t);
  Complex sum;
  for (std::size_t k = p.size(); k-- > 0;) sum = sum * delta + t[k];
  EXPECT_LT(std::abs(sum - p(s + delta)), 1e-13);
  const auto [value, slope] = p.jet(s);
  EXPECT_LT(std::abs(value - t[0]), 1e-14);
  EXPECT_LT(std::abs(slope - t[1]), 1e-14);
}

// Law. On the axis p(jω) = real(ω) + j imaginary(ω), and |p|² is a polynomial of ω².
TEST(Polynomial, KnowsItsPartsOnTheAxis) {
  const Polynomial p{5.0, -1.0, 2.0, 0.5, 1.0};
  for (const double omega : {0.0, 0.7, 3.0}) {
    const Complex value = p(Complex(0.0, omega));
    EXPECT_NEAR(on_axis(p).real(omega), value.real(), 1e-13);
    EXPECT_NEAR(on_axis(p).imaginary(omega), value.imag(), 1e-13);
    EXPECT_NEAR(squared_magnitude(p)(omega * omega), std::norm(value), 1e-11);
  }
}

// Law. Roots put together are found again: over six decades of size, with zeros, each as often as it stands there.
TEST(Polynomial, FindsAllItsRoots) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> exponent(-2.0, 4.0), sign(-1.0, 1.0);
    Polynomial p{3.0};
    std::vector<Complex> expected;
    for (int i = 0; i < 3; ++i) {
      const Complex s = std::pow(10.0, exponent(random)) * Complex(sign(random), 0.2 + std::abs(sign(random)));
      p = p * Polynomial{std::norm(s), -2.0 * s.real(), 1.0};
      expected.insert(expected.end(), {s, std::conj(s)});
    }
    p = p * Polynomial{0.0, 0.0, 1.0};
    expected.insert(expected.end(), {Complex(), Complex()});
    const std::vector<Complex> found = roots(p);
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_EQ(std::count(found.begin(), found.end(), Complex()), 2);
    for (const Complex s : expected) {
      double nearest = 1e300;
      for (const Complex other : found) nearest = std::min(nearest, std::abs(s - other));
      EXPECT_LE(nearest, 1e-9 * std::abs(s));  // pairs of one size may lie a thousandth apart: 1e-16 · 1e3², and more
    }
  }
}

// Law. Balancing is a similarity: eigenvalues stay, rows and columns become comparable.
TEST(Balance, KeepsEigenvaluesOfABadlyScaledMatrix) {
  Eigen::MatrixXd a(3, 3);
  a << -1.0, 1e9, 0.0, -1e-9, -2.0, 1e7, 0.0, -3e-7, -5.0;
  Eigen::MatrixXd balanced = a;
  balance(balanced);
  EXPECT_NEAR(balanced.trace(), a.trace(), 0.0);
  EXPECT_NEAR(balanced.determinant(), a.determinant(), 1e-9);
  EXPECT_LT(balanced.cwiseAbs().maxCoeff(), 20.0);
}

}  // namespace
