#include "host_sim/stability/roots/polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "host_sim/stability/roots/eigenvalues.hpp"

namespace host_sim::stability {

Polynomial::Polynomial(std::vector<double> ascending) : coefficients_(std::move(ascending)) {
  for (const double c : coefficients_) {
    if (!std::isfinite(c)) throw std::domain_error("a coefficient of the characteristic equation is not finite");
  }
  trim();
}

void Polynomial::trim() {
  while (!coefficients_.empty() && coefficients_.back() == 0.0) coefficients_.pop_back();
  if (coefficients_.size() > capacity) throw std::length_error("the characteristic equation has too high a degree");
}

double Polynomial::magnitude(double r) const {
  double sum = 0.0;
  for (std::size_t k = size(); k-- > 0;) sum = sum * r + std::abs(coefficients_[k]);
  return sum;
}

Polynomial Polynomial::derivative() const {
  std::vector<double> c;
  for (std::size_t k = 1; k < size(); ++k) c.push_back(static_cast<double>(k) * coefficients_[k]);
  return Polynomial(std::move(c));
}

Polynomial Polynomial::mirrored() const {
  Polynomial p = *this;
  for (std::size_t k = 1; k < p.size(); k += 2) p.coefficients_[k] = -p.coefficients_[k];
  return p;
}

Polynomial Polynomial::stretched(double factor) const {
  Polynomial p = *this;
  double power = 1.0;
  for (double& c : p.coefficients_) {
    c *= power;
    power *= factor;
  }
  return p;
}

Polynomial& Polynomial::operator+=(const Polynomial& other) {
  if (other.size() > size()) coefficients_.resize(other.size());
  for (std::size_t k = 0; k < other.size(); ++k) coefficients_[k] += other.coefficients_[k];
  trim();
  return *this;
}

Polynomial& Polynomial::operator*=(double factor) {
  for (double& c : coefficients_) c *= factor;
  trim();
  return *this;
}

Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  if (a.zero() || b.zero()) return {};
  std::vector<double> c(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < b.size(); ++k) c[i + k] += a.coefficients_[i] * b.coefficients_[k];
  }
  return Polynomial(std::move(c));
}

AxisParts on_axis(const Polynomial& p) {
  std::vector<double> real(p.size()), imaginary(p.size());
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double c = (k / 2) % 2 == 0 ? p[k] : -p[k];  // j^k = (−1)^⌊k/2⌋ · 1 or j
    (k % 2 == 0 ? real : imaginary)[k] = c;
  }
  return {Polynomial(std::move(real)), Polynomial(std::move(imaginary))};
}

Polynomial squared_magnitude(const Polynomial& p) {
  const AxisParts parts = on_axis(p);
  const Polynomial square = parts.real * parts.real + parts.imaginary * parts.imaginary;
  std::vector<double> even;
  for (std::size_t k = 0; k < square.size(); k += 2) even.push_back(square[k]);
  return Polynomial(std::move(even));
}

std::vector<Complex> roots(const Polynomial& p) {
  std::vector<Complex> found;
  if (p.degree() < 1) return found;
  std::size_t at_zero = 0;
  while (p[at_zero] == 0.0) ++at_zero;
  found.assign(at_zero, Complex());
  const std::size_t n = p.size() - 1 - at_zero;
  if (n == 0) return found;

  // Time is scaled such that the product of all roots has modulus 1; a power of two leaves every digit as it is.
  const double spread = std::log2(std::abs(p[at_zero] / p.leading())) / static_cast<double>(n);
  const double scale = std::exp2(std::round(spread));
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
  double power = scale;
  for (std::size_t k = n; k-- > 0;) {
    companion(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(n - 1)) = -p[at_zero + k] / p.leading() / power;
    power *= scale;
  }
  for (Eigen::Index k = 1; k < static_cast<Eigen::Index>(n); ++k) companion(k, k - 1) = 1.0;

  for (Complex root : eigenvalues(companion)) {
    root *= scale;
    for (int i = 0; i < 4; ++i) {
      const auto [value, slope] = p.jet(root);
      const Complex better = root - value / slope;
      if (slope == Complex() || !(std::abs(p(better)) < std::abs(value))) break;
      root = better;
    }
    found.push_back(root);
  }
  return found;
}

}  // namespace host_sim::stability
