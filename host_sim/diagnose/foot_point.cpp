#include "host_sim/diagnose/foot_point.hpp"

#include <array>
#include <cmath>

namespace host_sim::diagnose {
namespace {

/// M A at k, and whether it can be had.
bool mean_acceleration(const std::vector<double>& a, std::size_t k, double& value) {
  value = (a[k - 1] + 10.0 * a[k] + a[k + 1]) / 12.0;
  return std::isfinite(value);
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

double disagreement(const std::vector<double>& fused, const std::vector<double>& displacement,
                    const std::vector<double>& acceleration, double displacement_noise, double acceleration_noise,
                    double period) {
  double sum = 0.0;
  const std::size_t n = fused.size();
  for (std::size_t k = 0; k < n; ++k) sum += std::pow((displacement[k] - fused[k]) / displacement_noise, 2);
  // M makes of white noise one of (1 + 100 + 1)/144 of its variance.
  constexpr double averaged = 102.0 / 144.0;
  for (std::size_t k = 1; k + 1 < n; ++k) {
    double a = 0.0;
    if (!mean_acceleration(acceleration, k, a)) continue;
    const double curvature = (fused[k - 1] - 2.0 * fused[k] + fused[k + 1]) / (period * period);
    sum += std::pow((a - curvature) / acceleration_noise, 2) / averaged;
  }
  return sum / static_cast<double>(n);
}

}  // namespace host_sim::diagnose
