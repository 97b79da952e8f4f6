// Exact solution of a linear system over one period.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "model/numerics/require.hpp"
#include "model/numerics/select.hpp"

namespace model {

template <class S, int N>
using Column = Eigen::Matrix<S, N, 1>;
template <class S, int Rows, int Columns>
using Block = Eigen::Matrix<S, Rows, Columns>;

/// a · b, summed column by column: the same order, and so the same bits, whatever the vector width.
template <class S, int R, int N, int C>
[[nodiscard]] Block<S, R, C> product(const Block<S, R, N>& a, const Block<S, N, C>& b) {
  Block<S, R, C> result;
  for (int j = 0; j < C; ++j) {
    Column<S, R> sum = a.col(0) * b(0, j);
    for (int k = 1; k < N; ++k) sum += a.col(k) * b(k, j);
    result.col(j) = sum;
  }
  return result;
}

/// Exact solution over one period h of
///
///   (1)  ẋ = A x + Σ B_i u_i(t)
///
/// for inputs that are polynomials of up to third order inside the period. With s = t/h in 0 … 1 and the φ-functions
/// φ₀(Z) = e^Z, φ_k(Z) = ∫₀¹ e^{(1−s)Z} s^{k−1}/(k−1)! ds:
///
///   (2)  x(h) = φ₀(hA) x(0) + Σ_m h m! φ_{m+1}(hA) B c_m      for u = Σ_m c_m s^m
///
/// φ by scaling, Taylor series and the doubling formula φ_k(2Z) = 2^{−k} (φ₀ φ_k + Σ_{j=1…k} φ_j/(k−j)!): only + − ×
/// ÷ in a fixed order, so every machine gets the same bits. Truncation below 1e-17 of the result.
/// Source: (2), doubling: Hochbruck and Ostermann, Exponential integrators, Acta Numerica 2010.
template <class S, int N>
class ExactDiscretisation {
 public:
  using Matrix = Block<S, N, N>;
  using Vector = Column<S, N>;
  static constexpr int orders = 5;  ///< φ₀ … φ₄

  /// A [1/s …], period h [s] > 0.
  ExactDiscretisation(const Matrix& a, S h) : period_(h) {
    require(all_lanes(h > S(0)), "period > 0");
    S size = S(0);
    for (int i = 0; i < N; ++i) {
      S row = S(0);
      for (int j = 0; j < N; ++j) row += select(a(i, j) < S(0), S(-a(i, j)), a(i, j));
      require(all_lanes(row - row == S(0)), "A finite");
      size = select(row > size, row, size);
    }
    size *= h;
    require(all_lanes(size < S(1e12)), "A h finite");
    S doublings = S(0), scale = h;
    for (; any_lane(size > S(0.5)); size *= S(0.5)) {
      const auto large = size > S(0.5);
      doublings = select(large, S(doublings + S(1)), doublings);
      scale = select(large, S(scale * S(0.5)), scale);
    }

    const Matrix z = a * scale;
    constexpr int last = 16;  // powers up to 12 in φ₄: 0.5^13 · 4!/17! < 1e-17
    S factorial = S(1);
    for (int k = 2; k <= last; ++k) factorial *= S(k);  // exact: 16! < 2^53
    Matrix series = Matrix::Identity() * (S(1) / factorial);
    for (int k = last; k >= orders; --k) {
      factorial /= S(k);
      series = product(z, series);
      for (int i = 0; i < N; ++i) series(i, i) += S(1) / factorial;
    }
    phi_[4] = series;
    constexpr std::array<double, orders> inverse_factorial{1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0};
    for (std::size_t k = orders - 1; k-- > 0;) {
      phi_[k] = product(z, phi_[k + 1]);
      for (int i = 0; i < N; ++i) phi_[k](i, i) += S(inverse_factorial[k]);
    }
    for (; any_lane(doublings > S(0)); doublings -= S(1)) {
      if constexpr (lane_count<S> == 1) {
        twice();
      } else {
        twice_where(doublings > S(0));
      }
    }
  }

  /// φ₀(hA), the transition matrix of one period.
  [[nodiscard]] const Matrix& transition() const { return phi_[0]; }

  /// Effect of an input that is s^m during the period, entering by column b: h m! φ_{m+1} b.
  [[nodiscard]] Vector monomial(const Vector& b, int m) const {
    constexpr std::array<double, 4> factorial{1.0, 1.0, 2.0, 6.0};
    return product(phi_[static_cast<std::size_t>(m) + 1], b) * (period_ * S(factorial[static_cast<std::size_t>(m)]));
  }

  /// Column for an input held over the period.
  [[nodiscard]] Vector held(const Vector& b) const { return monomial(b, 0); }

  /// Columns for an input that goes straight from u₀ to u₁.
  [[nodiscard]] Block<S, N, 2> straight(const Vector& b) const {
    Block<S, N, 2> columns;
    columns.col(1) = monomial(b, 1);
    columns.col(0) = monomial(b, 0) - columns.col(1);
    return columns;
  }

  /// Columns for an input that enters by value (column `by_value`) and by rate (column `by_rate`) and moves on the
  /// cubic Hermite polynomial through (x₀, ẋ₀) and (x₁, ẋ₁); factors in the order x₀, ẋ₀, x₁, ẋ₁.
  [[nodiscard]] Block<S, N, 4> hermite(const Vector& by_value, const Vector& by_rate) const {
    std::array<Vector, 4> c;
    c[0] = monomial(by_value, 0);
    for (int m = 1; m < 4; ++m) {
      c[static_cast<std::size_t>(m)] = monomial(by_value, m) + monomial(by_rate, m - 1) * (S(m) / period_);
    }
    Block<S, N, 4> columns;
    columns.col(2) = c[2] * S(3) - c[3] * S(2);
    columns.col(0) = c[0] - columns.col(2);
    columns.col(1) = (c[1] - c[2] * S(2) + c[3]) * period_;
    columns.col(3) = (c[3] - c[2]) * period_;
    return columns;
  }

  /// Columns for an input that moves on the cubic through its samples at the end of the period, its beginning and the
  /// two before; the newest comes first.
  [[nodiscard]] Block<S, N, 4> through_newest(const Vector& b) const {
    const Vector c0 = monomial(b, 0), c1 = monomial(b, 1), c2 = monomial(b, 2), c3 = monomial(b, 3);
    Block<S, N, 4> columns;
    columns.col(0) = c1 * S(1.0 / 3.0) + c2 * S(0.5) + c3 * S(1.0 / 6.0);
    columns.col(1) = c0 + c1 * S(0.5) - c2 - c3 * S(0.5);
    columns.col(2) = c2 * S(0.5) + c3 * S(0.5) - c1;
    columns.col(3) = (c1 - c3) * S(1.0 / 6.0);
    return columns;
  }

  /// Columns for an input known only up to now: the polynomial through its newest samples, three or four, continued
  /// over the period (exponential Adams–Bashforth of that order). The oldest comes first: the newest is known last.
  template <int Order>
  [[nodiscard]] Block<S, N, Order> continued(const Vector& b) const {
    static_assert(Order == 3 || Order == 4, "orders for which columns are known");
    const Vector c0 = monomial(b, 0), c1 = monomial(b, 1), c2 = monomial(b, 2);
    Block<S, N, Order> columns;
    if constexpr (Order == 3) {
      columns.col(0) = (c1 + c2) * S(0.5);
      columns.col(1) = c1 * S(-2) - c2;
      columns.col(2) = c0 + c1 * S(1.5) + c2 * S(0.5);
    } else {
      const Vector c3 = monomial(b, 3);
      columns.col(0) = c1 * S(-1.0 / 3.0) - c2 * S(0.5) - c3 * S(1.0 / 6.0);
      columns.col(1) = c1 * S(1.5) + c2 * S(2) + c3 * S(0.5);
      columns.col(2) = c1 * S(-3) - c2 * S(2.5) - c3 * S(0.5);
      columns.col(3) = c0 + c1 * S(11.0 / 6.0) + c2 + c3 * S(1.0 / 6.0);
    }
    return columns;
  }

 private:
  void twice() {
    const Matrix one = phi_[0];
    const Matrix p1 = phi_[1], p2 = phi_[2], p3 = phi_[3];
    phi_[4] = (product(one, phi_[4]) + phi_[4] + p3 + p2 * S(0.5) + p1 * S(1.0 / 6.0)) * S(1.0 / 16.0);
    phi_[3] = (product(one, p3) + p3 + p2 + p1 * S(0.5)) * S(1.0 / 8.0);
    phi_[2] = (product(one, p2) + p2 + p1) * S(1.0 / 4.0);
    phi_[1] = (product(one, p1) + p1) * S(1.0 / 2.0);
    phi_[0] = product(one, one);
  }

  /// In some lanes.
  template <class Condition>
  void twice_where(const Condition& wanted) {
    const std::array<Matrix, orders> before = phi_;
    twice();
    for (std::size_t k = 0; k < orders; ++k) {
      for (int i = 0; i < N * N; ++i) phi_[k](i) = select(wanted, phi_[k](i), before[k](i));
    }
  }

  S period_;
  std::array<Matrix, orders> phi_;
};

}  // namespace model
