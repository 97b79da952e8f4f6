// Signals and recordings for tests of frequency responses.
#pragma once

#include <complex>
#include <cstddef>
#include <initializer_list>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "firmware/recording/recording.hpp"
#include "firmware/simulation/gaussian.hpp"

namespace support {

/// White Gaussian noise; `stream` separates those of one seed.
inline std::vector<double> white(std::size_t count, double sigma, std::uint64_t seed, std::uint32_t stream = 0) {
  firmware::Gaussian gaussian(seed, stream);
  std::vector<double> signal(count);
  for (double& x : signal) x = sigma * gaussian();
  return signal;
}

/// Σ_j taps_j x_{n−j}, x before its beginning 0.
inline std::vector<double> filtered(const std::vector<double>& x, const std::vector<double>& taps) {
  std::vector<double> y(x.size(), 0.0);
  for (std::size_t j = 0; j < taps.size(); ++j) {
    if (taps[j] == 0.0) continue;
    for (std::size_t n = j; n < x.size(); ++n) y[n] += taps[j] * x[n - j];
  }
  return y;
}

/// The response of such a filter at f_s · `turns`.
inline std::complex<double> response(const std::vector<double>& taps, double turns) {
  std::complex<double> h = 0.0;
  for (std::size_t j = 0; j < taps.size(); ++j) {
    h += taps[j] * std::polar(1.0, -2.0 * std::numbers::pi * turns * static_cast<double>(j));
  }
  return h;
}

inline std::vector<double> sum(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t n = 0; n < a.size(); ++n) a[n] += b[n];
  return a;
}

inline firmware::Recording recording(double rate,
                                     std::initializer_list<std::pair<model::Channel, std::vector<double>>> channels,
                                     const std::string& file = "run.csv") {
  firmware::Recording result;
  result.sample_period = 1.0 / rate;
  result.source = file;
  for (const auto& [channel, samples] : channels) {
    result[channel] = samples;
    result.time = firmware::sample_times(samples.size(), rate);
  }
  return result;
}

}  // namespace support
