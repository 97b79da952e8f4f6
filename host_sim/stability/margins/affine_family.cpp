#include "host_sim/stability/margins/affine_family.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "host_sim/stability/roots/characteristic_roots.hpp"

namespace host_sim::stability {
namespace {

/// Σ_{k≥1} |t_k| r^k of the expansion of p about x; |t₀| in `value`.
double variation_of(const Polynomial& p, double x, double r, double& value) {
  std::array<double, Polynomial::capacity> t;
  p.expand(x, t);
  double sum = 0.0;
  for (std::size_t k = p.size(); k-- > 1;) sum = (sum + std::abs(t[k])) * r;
  value = p.zero() ? 0.0 : std::abs(t[0]);
  return sum;
}

/// Zero between low and high, where g has opposite signs.
double zero_between(const TrigonometricPolynomial& g, const TrigonometricPolynomial& slope, double low, double high) {
  const bool rising = g(high) > 0.0;
  double x = 0.5 * (low + high);
  for (int i = 0; i < 200; ++i) {
    const double value = g(x);
    if (value == 0.0) break;
    ((value > 0.0) == rising ? high : low) = x;
    const double newton = x - value / slope(x);
    const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
    if (std::abs(next - x) <= 2e-16 * std::abs(x)) break;
    x = next;
  }
  return x;
}

/// Numerator products on the axis: (a b*)(jω) = real(ω) + j imaginary(ω).
AxisParts times_conjugate(const Polynomial& a, const Polynomial& b) {
  const AxisParts x = on_axis(a), y = on_axis(b);
  return {x.real * y.real + x.imaginary * y.imaginary, x.imaginary * y.real - x.real * y.imaginary};
}

}  // namespace

double TrigonometricPolynomial::operator()(double x) const {
  return a(x) + b(x) * std::cos(tau * x) + c(x) * std::sin(tau * x);
}

TrigonometricPolynomial TrigonometricPolynomial::derivative() const {
  return {a.derivative(), b.derivative() + tau * c, c.derivative() - tau * b, tau};
}

double TrigonometricPolynomial::variation(double x, double r) const {
  double value_b = 0.0, value_c = 0.0, ignored = 0.0;
  const double turn = std::min(2.0, tau * r);  // |cos|, |sin| change by no more
  const double of_a = variation_of(a, x, r, ignored);
  const double of_b = variation_of(b, x, r, value_b);
  const double of_c = variation_of(c, x, r, value_c);
  return of_a + of_b + of_c + turn * (value_b + value_c);
}

std::vector<double> zeros(const TrigonometricPolynomial& g, double from, double to) {
  const TrigonometricPolynomial slope = g.derivative();
  std::vector<double> found;
  const double smallest = 1e-10 * (to - from);
  const auto search = [&](const auto& self, double low, double high) -> void {
    const double middle = 0.5 * (low + high), r = 0.5 * (high - low);
    if (std::abs(g(middle)) > g.variation(middle, r)) return;
    if (std::abs(slope(middle)) > slope.variation(middle, r)) {
      const double at_low = g(low), at_high = g(high);
      if (at_low == 0.0) {
        found.push_back(low);
      } else if (at_high != 0.0 && (at_low < 0.0) != (at_high < 0.0)) {
        found.push_back(zero_between(g, slope, low, high));
      }
      return;
    }
    if (r < smallest) {  // two zeros in one place, or rounding
      found.push_back(middle);
      return;
    }
    self(self, low, middle);
    self(self, middle, high);
  };
  constexpr int pieces = 64;
  for (int i = 0; i < pieces; ++i) {
    search(search, from + (to - from) * i / pieces, from + (to - from) * (i + 1) / pieces);
  }
  std::sort(found.begin(), found.end());
  found.erase(
      std::unique(found.begin(), found.end(), [&](double a, double b) { return std::abs(a - b) < 1e-9 * (to - from); }),
      found.end());
  return found;
}

AffineFamily affine_family(const std::function<LoopPolynomials(double)>& member, double typical) {
  const LoopPolynomials at_zero = member(0.0), at_one = member(typical), beyond = member(3.0 * typical);
  AffineFamily family{at_zero.p, 1.0 / typical * (at_one.p - at_zero.p), at_zero.q,
                      1.0 / typical * (at_one.q - at_zero.q)};
  // A coefficient that does not change must be exactly 0, not a rounding error.
  const auto cleaned = [&](const Polynomial& change, const Polynomial& a, const Polynomial& b) {
    std::vector<double> c(change.size());
    for (std::size_t k = 0; k < c.size(); ++k) {
      c[k] = std::abs(change[k]) * typical > 1e-13 * (std::abs(a[k]) + std::abs(b[k])) ? change[k] : 0.0;
    }
    return Polynomial(std::move(c));
  };
  family.p1 = cleaned(family.p1, at_zero.p, at_one.p);
  family.q1 = cleaned(family.q1, at_zero.q, at_one.q);
  const auto check = [&](const Polynomial& zero, const Polynomial& change, const Polynomial& value) {
    for (std::size_t k = 0; k < std::max(zero.size(), value.size()); ++k) {
      const double straight = zero[k] + 3.0 * typical * change[k];
      if (!(std::abs(straight - value[k]) <= 1e-10 * (std::abs(zero[k]) + std::abs(value[k])))) {
        throw std::logic_error("stability: a parameter does not enter the loop linearly");
      }
    }
  };
  check(family.p0, family.p1, beyond.p);
  check(family.q0, family.q1, beyond.q);
  return family;
}

double highest_frequency(const AffineFamily& family, double size) {
  const Polynomial rest =
      size * size * (squared_magnitude(family.p1) + squared_magnitude(family.q1)) + squared_magnitude(family.q0);
  double highest = 1.0;
  for (const Complex x : roots(squared_magnitude(family.p0) - 3.0 * rest)) {
    if (x.real() > 0.0 && std::abs(x.imag()) < 1e-3 * x.real())
      highest = std::max(highest, 1.001 * std::sqrt(x.real()));
  }
  return highest;
}

std::vector<AxisValue> axis_values(const AffineFamily& family, double delay, double from, double to) {
  // Im(f₀ f₁*) with E = e^{−jωτ}: P₀P₁* + Q₀Q₁* + P₀Q₁* E* + Q₀P₁* E
  const AxisParts p0p1 = times_conjugate(family.p0, family.p1), q0q1 = times_conjugate(family.q0, family.q1);
  const AxisParts p0q1 = times_conjugate(family.p0, family.q1), q0p1 = times_conjugate(family.q0, family.p1);
  TrigonometricPolynomial g{p0p1.imaginary + q0q1.imaginary, p0q1.imaginary + q0p1.imaginary, p0q1.real - q0p1.real,
                            delay};
  std::vector<AxisValue> found;
  if (g.a.zero() && g.b.zero() && g.c.zero()) return found;
  const double highest = highest_frequency(family, std::max(std::abs(from), std::abs(to)));
  // ω = 0 is always a zero of g (f₀ and f₁ are real there), but not a crossing of a pair.
  const double lowest = 1e-9 * highest;

  for (const double omega : zeros(g, lowest, highest)) {
    const Complex s(0.0, omega);
    const Complex e = DelayEquation(family.p0, family.q0, delay).delayed(s);
    const Complex f0 = family.p0(s) + times(family.q0(s), e);
    const Complex f1 = family.p1(s) + times(family.q1(s), e);
    const double value = -(f0 / f1).real();
    if (!(value >= from && value <= to)) continue;
    AxisValue axis{value, omega, false};
    const DelayEquation equation = family.at(value, delay);
    if (!(std::abs(equation(s)) <= 1e-6 * equation.scale(s))) continue;  // f₁ = 0 makes g vanish too
    const double beside = 1e-6 * omega;
    try {
      axis.border = equation.roots_right_of(beside) == 0;
    } catch (const RootOnLine&) {
      axis.border = false;
    }
    found.push_back(axis);
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return found;
}

}  // namespace host_sim::stability
