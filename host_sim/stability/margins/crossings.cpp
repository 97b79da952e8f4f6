#include "host_sim/stability/margins/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/signal/spectrum.hpp"

namespace host_sim::stability {
namespace {

/// ω → where ln|P(jω)| − ln|Q(jω)| = 0: Newton, to the last digits.
double polished(const Polynomial& p, const Polynomial& q, double omega) {
  for (int i = 0; i < 6; ++i) {
    const Complex s(0.0, omega);
    const auto [p0, p1] = p.jet(s);
    const auto [q0, q1] = q.jet(s);
    const double value = 0.5 * std::log(std::norm(p0) / std::norm(q0));
    const double slope = -((p1 / p0).imag() - (q1 / q0).imag());  // d/dω ln|p(jω)| = Re(j p'/p)
    const double step = value / slope;
    if (!(std::abs(step) < 0.01 * omega)) return omega;
    omega -= step;
  }
  return omega;
}

}  // namespace

std::vector<CrossingFrequency> crossing_frequencies(const Polynomial& p, const Polynomial& q) {
  std::vector<CrossingFrequency> found;
  if (q.zero()) return found;
  const Polynomial difference = squared_magnitude(p) - squared_magnitude(q);
  const Polynomial slope = difference.derivative();
  for (const Complex x : roots(difference)) {
    if (!(x.real() > 0.0)) continue;
    double omega = std::sqrt(x.real());
    int direction = 0;
    if (std::abs(x.imag()) > 1e-6 * x.real()) continue;
    if (x.imag() != 0.0) {  // two that meet, torn apart by rounding, or two that just miss
      if (x.imag() < 0.0) continue;
      const double size = std::norm(p(Complex(0.0, omega))) + std::norm(q(Complex(0.0, omega)));
      if (std::abs(difference(x.real())) > 1e-11 * size) continue;
    } else {
      omega = polished(p, q, omega);
      const double rise = slope(omega * omega);
      direction = rise > 0.0 ? 1 : (rise < 0.0 ? -1 : 0);
    }
    const Complex s(0.0, omega);
    double angle = -std::arg(-p(s) / q(s));  // ωτ
    if (angle < 0.0) angle += full_turn;
    found.push_back({omega, angle / omega, direction});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.omega > b.omega; });
  return found;
}

std::vector<Crossing> crossings(const std::vector<CrossingFrequency>& frequencies, double longest) {
  std::vector<Crossing> found;
  for (const auto& f : frequencies) {
    for (int k = 0;; ++k) {
      const double delay = f.first + k * full_turn / f.omega;
      if (!(delay <= longest)) break;
      found.push_back({delay, f.omega, f.direction});
    }
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.delay < b.delay; });
  return found;
}

int unstable_roots(const Polynomial& p) {
  int count = 0;
  for (const Complex s : roots(p)) count += s.real() > 0.0 ? 1 : 0;
  return count;
}

std::optional<int> unstable_roots(const Polynomial& p, const Polynomial& q,
                                  const std::vector<CrossingFrequency>& frequencies, double delay) {
  const Polynomial without_delay = p + q;
  if (without_delay[0] == 0.0) return std::nullopt;
  int count = unstable_roots(without_delay);
  for (const auto& f : frequencies) {
    if (f.direction == 0) return std::nullopt;
    if (f.first < 1e-12) return std::nullopt;  // on the axis without any delay
    if (delay > f.first) count += 2 * f.direction * (1 + static_cast<int>((delay - f.first) * f.omega / full_turn));
  }
  return count;
}

std::vector<StableRange> stable_ranges(const Polynomial& p, const Polynomial& q,
                                       const std::vector<CrossingFrequency>& frequencies) {
  std::vector<StableRange> ranges;
  if (!unstable_roots(p, q, frequencies, 0.0)) return ranges;
  int count = unstable_roots(p + q);
  double from = 0.0;
  for (const Crossing& c : crossings(frequencies, longest_delay)) {
    const int after = count + 2 * c.direction;
    if (count == 0 && after > 0) ranges.push_back({from, c.delay});
    if (count > 0 && after == 0) from = c.delay;
    count = after;
  }
  if (count == 0) ranges.push_back({from, longest_delay});
  return ranges;
}

Polynomial pade_denominator(int order) {
  std::vector<double> c;
  double term = 1.0;
  for (int k = 0; k <= order; ++k) {
    c.push_back(term);
    term *= static_cast<double>(order - k) / (static_cast<double>(2 * order - k) * (k + 1));
  }
  return Polynomial(std::move(c));
}

PadeResult pade_critical_delay(int order, const std::vector<CrossingFrequency>& frequencies,
                               std::optional<double> exact) {
  PadeResult result;
  result.order = order;
  const Polynomial d = pade_denominator(order);
  const std::vector<Complex> zeros = roots(d);
  // All zeros lie left of the axis, so arg D(jx) = Σ arg(jx − zero) grows steadily from 0 to n π/2.
  const auto angle = [&](double x) {
    double sum = 0.0;
    for (const Complex z : zeros) sum += std::arg(Complex(0.0, x) - z);
    return 2.0 * sum;
  };
  const auto slope = [&](double x) {
    double sum = 0.0;
    for (const Complex z : zeros) sum += -z.real() / std::norm(Complex(0.0, x) - z);
    return 2.0 * sum;
  };
  for (const auto& f : frequencies) {
    const double wanted = f.first * f.omega;
    if (!(wanted < order * std::numbers::pi)) continue;
    double low = 0.0, high = longest_delay * f.omega;
    if (angle(high) < wanted) continue;
    double x = std::min(wanted, high);
    for (int i = 0; i < 200 && high - low > 1e-15 * high; ++i) {
      const double miss = angle(x) - wanted;
      (miss > 0.0 ? high : low) = x;
      const double newton = x - miss / slope(x);
      const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
      if (std::abs(next - x) <= 1e-15 * x) break;
      x = next;
    }
    const double delay = x / f.omega;
    if (!result.critical_delay || delay < *result.critical_delay) {
      result.critical_delay = delay;
      result.omega = f.omega;
    }
  }
  if (exact) {
    if (result.critical_delay) {
      result.error = *result.critical_delay / *exact - 1.0;
      result.unsafe = *result.error > 0.0;
    } else {
      result.unsafe = true;
    }
  }
  return result;
}

}  // namespace host_sim::stability
