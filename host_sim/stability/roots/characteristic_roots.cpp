#include "host_sim/stability/roots/characteristic_roots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/stability/roots/eigenvalues.hpp"

namespace host_sim::stability {
namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();

/// Multiplicity of a root: the smallest m for which the term c_m ρ^m of the Taylor series of f exceeds the sum of all
/// others on a circle of radius ρ (Rouché). 1 if no circle decides; a wrong value shows in the count of all roots.
int multiplicity(const DelayEquation& equation, Complex s) {
  std::array<Complex, Polynomial::capacity> p;
  std::array<Complex, Polynomial::capacity> q;
  equation.p().expand(s, p);
  equation.q().expand(s, q);
  const std::size_t n = equation.p().size();
  constexpr std::size_t terms = 8;
  const Complex e = equation.delayed(s);
  std::array<double, terms> c{};
  for (std::size_t k = 0; k < terms; ++k) {  // Σ_i q_{k−i} (−τ)^i/i!
    Complex sum = k < n ? p[k] : Complex();
    double factor = 1.0;
    for (std::size_t i = 0; i <= k; ++i) {
      if (k - i < equation.q().size()) sum += factor * times(q[k - i], e);
      factor *= -equation.delay() / static_cast<double>(i + 1);
    }
    c[k] = std::abs(sum);
  }
  const double size = std::abs(s) + 1.0;
  for (double circle = 1e-7 * size; circle < 1e-2 * size; circle *= 2.0) {
    double total = 0.0, power = 1.0, largest = 0.0;
    int at = 0;
    for (std::size_t k = 0; k < terms; ++k, power *= circle) {
      total += c[k] * power;
      if (c[k] * power > largest) {
        largest = c[k] * power;
        at = static_cast<int>(k);
      }
    }
    if (at >= 1 && largest > 0.6 * total) return at;
  }
  return 1;
}

/// Highest Im s on the line at which the delayed part of f exceeds the undelayed part. Above it there are no roots near
/// the line, below it about one per π/τ.
double reach(const DelayEquation& equation, double line) {
  const double grown = std::exp(-line * equation.delay());
  double y = equation.radius(line);
  while (y > 1.0) {
    const Complex s(line, y);
    if (std::abs(equation.q()(s)) * grown >= std::abs(equation.p()(s))) break;
    y *= 0.9;
  }
  return y;
}

bool further_right(Complex a, Complex b) { return a.real() != b.real() ? a.real() > b.real() : a.imag() > b.imag(); }

}  // namespace

CountMismatch::CountMismatch(int found, int proven, double line)
    : std::logic_error("stability: " + std::to_string(found) + " characteristic roots found right of Re s = " +
                       std::to_string(line) + " 1/s, but the argument principle counts " + std::to_string(proven)) {}

bool settle(const DelayEquation& equation, Complex& start) {
  Complex s = start;
  for (int i = 0; i < 40; ++i) {
    const auto [value, slope] = equation.jet(s);
    if (value == Complex()) break;
    const Complex step = value / slope;
    if (!std::isfinite(step.real()) || !std::isfinite(step.imag())) return false;
    s -= step;
    if (std::abs(step) <= 4.0 * rounding * std::abs(s)) break;
    if (i >= 6 && std::abs(step) <= 1e-13 * std::abs(s)) break;  // as near as rounding lets it come
  }
  // Rounding splits a double real root into a pair with |Im s| of about 1e-8 |s|; f is then zero to rounding on the
  // axis too.
  if (std::abs(s.imag()) < 1e-6 * (1.0 + std::abs(s.real()))) {
    const auto [value, slope] = equation.jet(s.real());
    if (std::abs(value) <= 1e3 * rounding * equation.scale(s.real())) s = s.real();
  }
  if (!(std::abs(equation(s)) <= 1e3 * rounding * equation.scale(s))) return false;
  start = s;
  return true;
}

std::vector<Complex> discretised_roots(const DelayEquation& equation, int nodes) {
  const Polynomial& p = equation.p();
  const int n = p.degree();
  if (equation.delay() == 0.0 || nodes < 1) return stability::roots(p + equation.q());

  // Time is scaled so that the roots of P + Q have a modulus of about 1.
  const Polynomial sum = p + equation.q();
  std::size_t lowest = 0;
  while (sum[lowest] == 0.0) ++lowest;
  const double spread = n > static_cast<int>(lowest)
                            ? std::log2(std::abs(sum[lowest] / sum.leading())) / (n - static_cast<double>(lowest))
                            : 0.0;
  const double scale = std::exp2(std::round(spread));
  const double leading = p.leading() * std::pow(scale, n);
  const double tau = equation.delay() * scale;

  // ẋ = companion of P, output w = −Q x into the line u_t = u_θ, θ in −τ … 0, whose end feeds the last row of x.
  const Eigen::Index size = n + nodes;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
  Eigen::RowVectorXd output = Eigen::RowVectorXd::Zero(n);
  double power = 1.0;
  for (int k = 0; k < n; ++k, power *= scale) {
    const auto at = static_cast<std::size_t>(k);
    a(n - 1, k) = -p[at] * power / leading;
    output(k) = -equation.q()[at] * power / leading;
    if (k + 1 < n) a(k, k + 1) = 1.0;
  }
  a(n - 1, size - 1) = 1.0;
  const auto node = [nodes](int i) { return std::cos(std::numbers::pi * i / nodes); };
  const auto weight = [nodes](int i) { return (i == 0 || i == nodes ? 2.0 : 1.0) * (i % 2 == 0 ? 1.0 : -1.0); };
  for (int i = 1; i <= nodes; ++i) {
    double diagonal = 0.0;
    for (int j = 0; j <= nodes; ++j) {
      if (i == j) continue;
      const double d = 2.0 / tau * weight(i) / weight(j) / (node(i) - node(j));
      diagonal -= d;
      if (j == 0) {
        a.row(n + i - 1).head(n) += d * output;
      } else {
        a(n + i - 1, n + j - 1) = d;
      }
    }
    a(n + i - 1, n + i - 1) += diagonal;
  }
  std::vector<Complex> found = eigenvalues(a);
  for (Complex& s : found) s *= scale;
  return found;
}

RootSet verified_roots(const DelayEquation& equation, double line, const std::vector<Complex>& starts) {
  std::vector<Complex> distinct;
  for (Complex s : starts) {
    if (s.imag() < -1e-6 * (1.0 + std::abs(s)) || !settle(equation, s)) continue;
    if (s.imag() < 0.0) s = std::conj(s);
    const bool known = std::any_of(distinct.begin(), distinct.end(),
                                   [s](Complex other) { return std::abs(s - other) < 1e-7 * (1.0 + std::abs(s)); });
    if (!known) distinct.push_back(s);
  }
  std::sort(distinct.begin(), distinct.end(), further_right);

  RootSet set;
  set.line = line;
  set.count = equation.roots_right_of(line);
  const auto count = [&] {
    int sum = 0;
    for (const Complex s : set.roots) sum += s.imag() > 0.0 ? 2 : 1;
    return sum;
  };
  for (const Complex s : distinct) {
    if (s.real() > line) set.roots.push_back(s);
  }
  if (count() != set.count) {
    const std::vector<Complex> once = set.roots;
    set.roots.clear();
    for (const Complex s : once)
      set.roots.insert(set.roots.end(), static_cast<std::size_t>(multiplicity(equation, s)), s);
  }
  if (count() != set.count) throw CountMismatch(count(), set.count, line);
  for (const Complex s : set.roots) {
    set.worst_residual = std::max(set.worst_residual, std::abs(equation(s)) / (rounding * equation.scale(s)));
  }
  return set;
}

RootSet characteristic_roots(const DelayEquation& equation, double line) {
  const double tau = equation.delay();
  if (equation.p().degree() < 1) throw UnfitLoop("the loop has no states");
  while (line < 0.0 && reach(equation, line) * tau / std::numbers::pi > most_roots) {
    line *= 0.9;
    if (line > -1e-3) line = 0.0;
  }
  for (;; line *= 2.0) {
    for (int refined = 0;; ++refined) {
      const double turns = reach(equation, line) * tau;
      const int nodes = (16 << refined) + static_cast<int>(std::min(0.5 * turns, 200.0));
      try {
        double clear = line;
        for (int tries = 0;; ++tries) {
          try {
            RootSet set = verified_roots(equation, clear, discretised_roots(equation, nodes));
            if (!set.roots.empty()) return set;
            break;
          } catch (const RootOnLine&) {
            if (tries == 5) throw;
            clear -= 1e-4 * (1.0 + std::abs(line));
          }
        }
        break;
      } catch (const CountMismatch&) {
        if (refined == 3) throw;
      }
    }
    if (line == 0.0) line = -1.0;
    if (reach(equation, 2.0 * line) * tau / std::numbers::pi > 4.0 * most_roots) {
      throw std::logic_error("stability: no characteristic root within reach");
    }
  }
}

}  // namespace host_sim::stability
