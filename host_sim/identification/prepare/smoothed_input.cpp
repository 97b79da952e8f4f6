#include "host_sim/identification/prepare/smoothed_input.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/signal/kaiser.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/signal/summary.hpp"
#include "host_sim/signal/weighted_sums.hpp"

namespace host_sim::identification {
namespace {

/// g of (1): 2n − 1 weights.
std::vector<double> low_pass_weights(double edge, double period, std::size_t n) {
  std::vector<double> weights;
  double sum = 0.0;
  for (std::size_t i = 1; i < 2 * n; ++i) {
    const double j = static_cast<double>(i) - static_cast<double>(n);
    const double turn = 2.0 * std::numbers::pi * edge * period * j;
    weights.push_back(kaiser_window(j / static_cast<double>(n)) * (j == 0.0 ? 1.0 : std::sin(turn) / turn));
    sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

/// (2) for j = 1 … count; `value_at(j)`: the samples from the end on, `fitted` of them for the cubic.
template <class ValueAt>
std::vector<double> beyond_the_end(const ValueAt& value_at, std::size_t fitted, std::size_t count) {
  Eigen::MatrixX4d powers(fitted, 4);
  Eigen::VectorXd values(fitted);
  for (std::size_t j = 0; j < fitted; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const double x = static_cast<double>(j) / static_cast<double>(fitted);
    powers.row(row) << 1.0, x, x * x, x * x * x;
    values(row) = value_at(j);
  }
  const Eigen::Vector4d c = powers.householderQr().solve(values);
  std::vector<double> result;
  for (std::size_t j = 1; j <= count; ++j) {
    const double x = static_cast<double>(j) / static_cast<double>(fitted);
    result.push_back(2.0 * (c(0) + c(2) * x * x) - value_at(j));
  }
  return result;
}

}  // namespace

std::vector<double> smoothed(const std::vector<double>& signal, double edge, double period) {
  const auto n = static_cast<std::size_t>(std::ceil(thresholds::smoothing_reach / period));
  const std::size_t size = signal.size();
  if (size <= n) return signal;
  constexpr std::size_t fewest = 6;
  const std::size_t fitted = std::clamp(static_cast<std::size_t>(1.0 / (edge * period)), fewest, n);
  const auto before = beyond_the_end([&](std::size_t j) { return signal[j]; }, fitted, n - 1);
  const auto behind = beyond_the_end([&](std::size_t j) { return signal[size - 1 - j]; }, fitted, n - 1);
  std::vector<double> longer(before.rbegin(), before.rend());
  longer.insert(longer.end(), signal.begin(), signal.end());
  longer.insert(longer.end(), behind.begin(), behind.end());
  const std::vector<double> weights = low_pass_weights(edge, period, n);
  std::vector<double> result(size, 0.0);
  add_weighted_sums(weights.data(), weights.size(), longer.data(), result.data(), size);
  return result;
}

double smoothing_edge(double known) { return known + thresholds::smoothing_transition; }

double known_up_to(const std::vector<double>& position, const PositionNoise& noise, double period, std::size_t step) {
  const double recorded_period = period * static_cast<double>(step);
  const PowerSpectrum spectrum = welch(position, 1.0 / period, static_cast<std::size_t>(1.0 / period));
  const double floor = 2.0 * noise.level * noise.level * recorded_period;
  double known = thresholds::lowest_known_frequency;
  const double highest =
      std::min(thresholds::highest_known_frequency, thresholds::recorded_share_of_rate / recorded_period);
  for (std::size_t k = 0; k < spectrum.frequency.size() && spectrum.frequency[k] <= highest; ++k) {
    const double f = spectrum.frequency[k];
    const double least = thresholds::power_above_noise * floor * noise.colour.power(f, recorded_period);
    if (spectrum.density[k] > least) known = std::max(known, f);
  }
  return known;
}

std::optional<double> edge_of_motion(const std::vector<double>& position, const PositionNoise& noise, double period,
                                     std::size_t step) {
  const double recorded_period = period * static_cast<double>(step);
  const double rms = noise.level * std::sqrt(noise.colour.mean_power(recorded_period));
  const double edge = smoothing_edge(known_up_to(position, noise, period, step));
  if (!(rms > 0.0) || edge > thresholds::recorded_share_of_rate / recorded_period) return std::nullopt;
  std::vector<double> taken = smoothed(position, edge, period);
  for (std::size_t k = 0; k < taken.size(); ++k) taken[k] -= position[k];
  if (largest_magnitude(taken) > thresholds::smoothed_noise * rms) return std::nullopt;
  return edge;
}

}  // namespace host_sim::identification
