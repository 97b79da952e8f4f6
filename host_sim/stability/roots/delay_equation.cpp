#include "host_sim/stability/roots/delay_equation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

namespace host_sim::stability {
namespace {

/// At least |z|, without a square root.
double at_least(Complex z) { return std::abs(z.real()) + std::abs(z.imag()); }

/// min |a + b t| for 0 ≤ t ≤ r.
double distance_of_segment(Complex a, Complex b, double r) {
  const double slope = std::norm(b);
  const double along = -(a.real() * b.real() + a.imag() * b.imag());
  const double t = slope > 0.0 ? std::clamp(along / slope, 0.0, r) : 0.0;
  return std::abs(a + b * t);
}

double phase_between(Complex from, Complex to) {
  const Complex turn = times(to, std::conj(from));
  return std::atan2(turn.imag(), turn.real());
}

}  // namespace

DelayEquation::DelayEquation(Polynomial p, Polynomial q, double delay)
    : p_(std::move(p)), q_(std::move(q)), delay_(delay) {
  if (q_.degree() > p_.degree()) {
    throw UnfitLoop("the delayed part has more derivatives than the undelayed part: the equation is advanced");
  }
  if (q_.degree() == p_.degree() && !p_.zero()) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the highest derivative is delayed (a mass beyond the force sensor): the equation is neutral with "
                  "the ratio %.4g and has infinitely many roots near one vertical line",
                  std::abs(q_.leading() / p_.leading()));
    throw UnfitLoop(text);
  }
}

Complex DelayEquation::delayed(Complex s) const {
  const double size = std::exp(-s.real() * delay_);
  const double angle = -s.imag() * delay_;
  return {size * std::cos(angle), size * std::sin(angle)};
}

std::array<Complex, 2> DelayEquation::jet(Complex s) const {
  const auto [p, dp] = p_.jet(s);
  const auto [q, dq] = q_.jet(s);
  const Complex e = delayed(s);
  return {p + times(q, e), dp + times(dq - delay_ * q, e)};
}

double DelayEquation::scale(Complex s) const {
  const double r = std::abs(s);
  return p_.magnitude(r) + q_.magnitude(r) * std::exp(-s.real() * delay_) * (1.0 + r * delay_);
}

double DelayEquation::radius(double line) const {
  const std::size_t n = p_.size() - 1;
  const double grown = std::exp(std::max(0.0, -line * delay_));
  const double leading = std::abs(p_.leading());
  const auto others = [&](double r) {  // (|P| and |Q e^{−sτ}| without |p_n| r^n) / (|p_n| r^n), falling with r
    double sum = 0.0;
    double power = 1.0 / r;
    for (std::size_t k = n; k-- > 0; power /= r) sum += (std::abs(p_[k]) + std::abs(q_[k]) * grown) * power;
    return sum / leading;
  };
  double r = std::max(1.0, std::abs(line));
  while (!(others(r) < 0.9)) r *= 1.25;
  return r;
}

int DelayEquation::roots_right_of(double line) const {
  const std::size_t n = p_.size() - 1;
  if (n == 0) return 0;
  const double r_all = radius(line);
  const double top = std::sqrt(r_all * r_all - line * line) * 1.0001 + 1e-3;
  const double grown = std::exp(-line * delay_);

  std::array<Complex, Polynomial::capacity> p;
  std::array<Complex, Polynomial::capacity> q;
  std::array<double, Polynomial::capacity> rest;
  double turned = 0.0;
  double step = 0.1 * r_all;
  for (double y = 0.0; y < top;) {
    const Complex s(line, y);
    p_.expand(s, p);
    q_.expand(s, q);
    const double q0 = q_.zero() ? 0.0 : at_least(q[0]);
    const double q1 = q_.size() > 1 ? at_least(q[1]) : 0.0;
    const Complex e = delayed(s);
    const Complex slope_q = (q_.size() > 1 ? q[1] : Complex()) - delay_ * (q_.zero() ? Complex() : q[0]);
    const Complex f0 = p[0] + (q_.zero() ? Complex() : times(q[0], e));
    const Complex f1 = times(Complex(0.0, 1.0), p[1] + times(slope_q, e));
    rest[0] = grown * (0.5 * q0 * delay_ * delay_ + q1 * delay_);
    rest[0] += n >= 2 ? at_least(p[2]) : 0.0;
    if (q_.size() > 2) rest[0] += grown * at_least(q[2]);
    for (std::size_t k = 3; k <= n; ++k) {
      rest[k - 2] = at_least(p[k]) + (k < q_.size() ? grown * at_least(q[k]) : 0.0);
    }
    const std::size_t terms = n >= 2 ? n - 1 : 1;
    const double rounding_error = 1e-14 * scale(s);

    step = std::min(2.5 * step, top - y);
    for (;; step *= 0.6) {
      double remainder = 0.0;
      for (std::size_t k = terms; k-- > 0;) remainder = remainder * step + rest[k];
      remainder = remainder * step * step * 1.000001 + rounding_error;
      if (remainder < distance_of_segment(f0, f1, step)) break;
      if (!(step > 1e-12 * (1.0 + r_all))) {
        char text[120];
        std::snprintf(text, sizeof text, "a root lies on the line Re s = %.9g 1/s, near Im s = %.9g 1/s", line, y);
        throw RootOnLine(text);
      }
    }
    const Complex straight = f0 + f1 * step;
    y = step == top - y ? top : y + step;
    turned += phase_between(f0, straight) + phase_between(straight, (*this)(Complex(line, y)));
  }

  // n arg(s) on the arc, then from f/s^n to the phase that the line ended with
  const Complex end(line, top);
  Complex power(p_.leading(), 0.0);
  for (std::size_t k = 0; k < n; ++k) power = times(power, end / r_all);
  Complex value = (*this)(end);
  for (std::size_t k = 0; k < n; ++k) value /= r_all;
  const double arc = static_cast<double>(n) * std::arg(end) + phase_between(power, value);
  // The phase of f/p_n starts at 0 or π on both ways; the lower half of the boundary is the mirror image.
  const double count = (arc - turned) / std::numbers::pi;
  const double whole = std::round(count);
  if (!(std::abs(count - whole) < 1e-6) || whole < 0.0) {
    throw std::logic_error("stability: the phase along the contour is not a whole number of turns");
  }
  return static_cast<int>(whole);
}

}  // namespace host_sim::stability
