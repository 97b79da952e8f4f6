#include "host_sim/identification/prepare/input_fusion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/prepare/smoothed_input.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

/// M A at k, and whether it can be had.
bool mean_acceleration(const std::vector<double>& a, std::size_t k, double& value) {
  value = (a[k - 1] + 10.0 * a[k] + a[k + 1]) / 12.0;
  return std::isfinite(value);
}

/// [Hz] up to where a recording holds its signal: the interpolation's filter ends there.
double highest_recorded(double period, std::size_t step) {
  return thresholds::recorded_share_of_rate / (period * static_cast<double>(step));
}

}  // namespace

std::vector<double> fused_displacement(const std::vector<double>& displacement, const std::vector<double>& acceleration,
                                       double displacement_noise, double acceleration_noise, double period) {
  const std::size_t n = displacement.size();
  if (n < 3) return displacement;
  const double h2 = period * period;
  const double weight = std::pow(displacement_noise / (h2 * acceleration_noise), 2);
  // (I + κ GᵀG) z = Z + κ h² GᵀM A, five diagonals: main, first and second.
  std::vector<double> main(n, 1.0), first(n, 0.0), second(n, 0.0), z = displacement;
  constexpr std::array<double, 3> g{1.0, -2.0, 1.0};
  for (std::size_t k = 1; k + 1 < n; ++k) {
    double a = 0.0;
    if (!mean_acceleration(acceleration, k, a)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      main[k - 1 + i] += weight * g[i] * g[i];
      if (i < 2) first[k - 1 + i] += weight * g[i] * g[i + 1];
      z[k - 1 + i] += weight * h2 * g[i] * a;
    }
    second[k - 1] += weight * g[0] * g[2];
  }
  // L D Lᵀ
  std::vector<double> l1(n, 0.0), l2(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    if (k >= 1) main[k] -= l1[k - 1] * l1[k - 1] * main[k - 1];
    if (k >= 2) main[k] -= l2[k - 2] * l2[k - 2] * main[k - 2];
    const double coupling = k >= 1 ? l2[k - 1] * l1[k - 1] * main[k - 1] : 0.0;
    l1[k] = (first[k] - coupling) / main[k];
    l2[k] = second[k] / main[k];
  }
  for (std::size_t k = 0; k < n; ++k) {
    if (k >= 1) z[k] -= l1[k - 1] * z[k - 1];
    if (k >= 2) z[k] -= l2[k - 2] * z[k - 2];
  }
  for (std::size_t k = n; k-- > 0;) {
    z[k] /= main[k];
    if (k + 1 < n) z[k] -= l1[k] * z[k + 1];
    if (k + 2 < n) z[k] -= l2[k] * z[k + 2];
  }
  return z;
}

std::vector<double> contradiction(const std::vector<double>& displacement, const std::vector<double>& acceleration,
                                  double period) {
  std::vector<double> difference(displacement.size());
  for (std::size_t k = 1; k + 1 < difference.size(); ++k) {
    double a = 0.0;
    if (!mean_acceleration(acceleration, k, a)) continue;
    const double near = displacement[k + 1] - displacement[k], far = displacement[k] - displacement[k - 1];
    difference[k] = a - (near - far) / (period * period);
  }
  return difference;
}

bool disagree(const std::vector<double>& displacement, const std::vector<double>& acceleration,
              double displacement_noise, double acceleration_noise, double period, std::size_t step) {
  const std::size_t n = displacement.size() >= 64 ? good_fft_size_at_most(displacement.size() - 2) : 0;
  if (n < 32) return false;
  std::vector<double> difference(n);
  const std::vector<double> taper = hann_window(n), contradicted = contradiction(displacement, acceleration, period);
  double squares = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    squares += taper[k] * taper[k];
    difference[k] = taper[k] * contradicted[k + 1];
  }
  RealTransform transform(n);
  const auto bins = transform(difference);
  const double resolution = 1.0 / (period * static_cast<double>(n));
  std::array<double, noise_bands> power{}, count{};
  for (std::size_t k = 1; k < bins.size(); ++k) {
    const double f = resolution * static_cast<double>(k);
    const std::size_t b = noise_band_of(f);
    if (b >= noise_bands || f > highest_recorded(period, step)) break;
    const double sine = std::pow(std::sin(std::numbers::pi * f * period), 2);
    const double variance = std::pow(acceleration_noise * (1.0 - sine / 3.0), 2) +
                            std::pow(displacement_noise * 4.0 * sine / (period * period), 2);
    power[b] += std::norm(bins[k]) / (variance * squares);
    count[b] += 1.0;
  }
  for (std::size_t b = 0; b < noise_bands; ++b) {
    // Of a Hann window neighbouring bins share 35/18 of their power's variance.
    const double deviation = std::sqrt(35.0 / 18.0 * std::max(count[b], 1.0));
    if (power[b] - count[b] > thresholds::input_disagreement * deviation &&
        power[b] > (1.0 + thresholds::input_disagreement_share) * count[b]) {
      return true;
    }
  }
  return false;
}

double variance_above(double highest, const std::vector<double>& acceleration, Window window, double noise,
                      double period) {
  if (window.size() == 0) return 0.0;
  const std::vector<double> slow = smoothed(acceleration, highest, period);
  double sum = 0.0;
  for (std::size_t k = window.from; k < window.to; ++k) {
    sum += std::pow(acceleration[k] - slow[k], 2);
  }
  const double share_above = std::max(1.0 - 2.0 * highest * period, 0.0);  // of white noise
  return std::max(sum / static_cast<double>(window.size()) - noise * noise * share_above, 0.0);
}

}  // namespace host_sim::identification
