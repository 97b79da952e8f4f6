#include "host_sim/identification/parity/smooth_window.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace host_sim::identification {
namespace {

constexpr double knots = 0.005;  // [s]

/// B-spline of degree n around 0, knots 1 apart.
double spline(int n, double x) {
  double sum = 0.0, binomial = 1.0, factorial = 1.0;
  for (int j = 0; j <= n + 1; ++j) {
    const double y = x + 0.5 * (n + 1) - j;
    if (y > 0.0) sum += (j % 2 == 0 ? binomial : -binomial) * std::pow(y, n);
    binomial = binomial * (n + 1 - j) / (j + 1);
    if (j >= 2 && j <= n) factorial *= j;
  }
  return sum / factorial;
}

}  // namespace

SmoothWindow::SmoothWindow(double period) : period_(period) {
  const double q = std::max(knots, 5.0 * period);
  reach_ = static_cast<std::ptrdiff_t>(std::ceil(3.0 * q / period));
  for (std::ptrdiff_t i = -reach_; i <= reach_; ++i) {
    const double x = static_cast<double>(i) * period / q, w = period / q;
    taps_[0].push_back(w * spline(5, x));
    taps_[1].push_back(w / q * (spline(4, x + 0.5) - spline(4, x - 0.5)));
    taps_[2].push_back(w / (q * q) * (spline(3, x + 1.0) - 2.0 * spline(3, x) + spline(3, x - 1.0)));
  }
}

std::vector<double> SmoothWindow::operator()(const std::vector<double>& y, int order) const {
  const auto& taps = taps_[static_cast<std::size_t>(order)];
  const auto n = static_cast<std::ptrdiff_t>(y.size());
  std::vector<double> out(y.size(), 0.0);
  for (std::ptrdiff_t k = reach_; k + reach_ < n; ++k) {
    double sum = 0.0;
    for (std::ptrdiff_t i = -reach_; i <= reach_; ++i) {
      sum += taps[static_cast<std::size_t>(i + reach_)] * y[static_cast<std::size_t>(k - i)];
    }
    out[static_cast<std::size_t>(k)] = sum;
  }
  return out;
}

std::complex<double> SmoothWindow::gain(int order, double frequency) const {
  std::complex<double> sum;
  for (std::ptrdiff_t i = -reach_; i <= reach_; ++i) {
    const double angle = -2.0 * std::numbers::pi * frequency * period_ * static_cast<double>(i);
    sum += taps_[static_cast<std::size_t>(order)][static_cast<std::size_t>(i + reach_)] * std::polar(1.0, angle);
  }
  return sum;
}

}  // namespace host_sim::identification
