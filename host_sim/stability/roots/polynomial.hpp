// Real polynomials of the Laplace variable, small enough for the characteristic equation of a rig.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <initializer_list>
#include <vector>

namespace host_sim::stability {

using Complex = std::complex<double>;

/// a · b without the library's treatment of infinities, which costs a function call.
[[nodiscard]] inline Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// p(s) = Σ_k c_k s^k with real c_k; the highest one is not zero. The zero polynomial has no coefficients.
class Polynomial {
 public:
  static constexpr std::size_t capacity = 48;  ///< coefficients

  Polynomial() = default;
  Polynomial(std::initializer_list<double> ascending) : Polynomial(std::vector<double>(ascending)) {}
  explicit Polynomial(std::vector<double> ascending);  ///< At most `capacity` finite numbers, or it throws.

  [[nodiscard]] static Polynomial s() { return {0.0, 1.0}; }

  [[nodiscard]] bool zero() const { return coefficients_.empty(); }
  [[nodiscard]] std::size_t size() const { return coefficients_.size(); }
  [[nodiscard]] int degree() const { return static_cast<int>(size()) - 1; }  ///< −1: the zero polynomial
  [[nodiscard]] double operator[](std::size_t k) const { return k < size() ? coefficients_[k] : 0.0; }
  [[nodiscard]] double leading() const { return zero() ? 0.0 : coefficients_.back(); }

  [[nodiscard]] Complex operator()(Complex s) const {
    Complex sum;
    for (std::size_t k = size(); k-- > 0;) sum = times(sum, s) + coefficients_[k];
    return sum;
  }
  [[nodiscard]] double operator()(double x) const {
    double sum = 0.0;
    for (std::size_t k = size(); k-- > 0;) sum = sum * x + coefficients_[k];
    return sum;
  }
  /// Value and first derivative.
  [[nodiscard]] std::array<Complex, 2> jet(Complex s) const {
    Complex value;
    Complex derivative;
    for (std::size_t k = size(); k-- > 0;) {
      derivative = times(derivative, s) + value;
      value = times(value, s) + coefficients_[k];
    }
    return {value, derivative};
  }
  /// Σ |c_k| r^k, r ≥ 0: bound of |p| on |s| ≤ r, and the scale of its rounding error.
  [[nodiscard]] double magnitude(double r) const;

  /// Writes p(s + δ) = Σ_k t_k δ^k into `t` (size() numbers).
  template <class Number>
  void expand(Number s, std::array<Number, capacity>& t) const {
    const std::size_t n = size();
    for (std::size_t k = 0; k < n; ++k) t[k] = Number(coefficients_[k]);
    for (std::size_t i = 0; i + 1 < n; ++i) {
      for (std::size_t k = n - 1; k-- > i;) t[k] += product(s, t[k + 1]);
    }
  }

  [[nodiscard]] Polynomial derivative() const;
  [[nodiscard]] Polynomial mirrored() const;                ///< p(−s)
  [[nodiscard]] Polynomial stretched(double factor) const;  ///< p(factor · s)

  Polynomial& operator+=(const Polynomial& other);
  Polynomial& operator*=(double factor);
  friend Polynomial operator+(Polynomial a, const Polynomial& b) { return a += b; }
  friend Polynomial operator-(Polynomial a, const Polynomial& b) { return a += -1.0 * b; }
  friend Polynomial operator*(double factor, Polynomial a) { return a *= factor; }
  friend Polynomial operator*(const Polynomial& a, const Polynomial& b);

 private:
  static Complex product(Complex a, Complex b) { return times(a, b); }
  static double product(double a, double b) { return a * b; }
  void trim();

  std::vector<double> coefficients_;
};

/// Real and imaginary part on the axis s = jω: p(jω) = real(ω) + j imaginary(ω), both real polynomials of ω.
struct AxisParts {
  Polynomial real, imaginary;
};
[[nodiscard]] AxisParts on_axis(const Polynomial& p);

/// |p(jω)|² as a polynomial of x = ω².
[[nodiscard]] Polynomial squared_magnitude(const Polynomial& p);

/// All roots with their multiplicities: eigenvalues of the scaled and balanced companion matrix, then Newton. Roots at
/// zero are exact. Error of a simple root: a few rounding errors times its condition number.
[[nodiscard]] std::vector<Complex> roots(const Polynomial& p);

}  // namespace host_sim::stability
