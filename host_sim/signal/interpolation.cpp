#include "host_sim/signal/interpolation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/signal/kaiser.hpp"

namespace host_sim {
namespace {

/// [samples] The filter's half length: the transition around half the sample rate is 92/(14.4 · 2 reach) = 0.1 of the
/// sample rate wide, so it begins at 0.45.
constexpr std::size_t interpolation_reach = 32;

}  // namespace

Interpolation::Interpolation(std::size_t factor) : factor_(factor) {
  constexpr auto reach = static_cast<std::ptrdiff_t>(interpolation_reach);
  for (std::size_t step = 1; step < factor; ++step) {
    const double r = static_cast<double>(step) / static_cast<double>(factor);
    double sum = 0.0;
    const std::size_t first = weights_.size();
    for (std::ptrdiff_t j = 1 - reach; j <= reach; ++j) {
      const double x = r - static_cast<double>(j);
      weights_.push_back(kaiser_window(x / static_cast<double>(reach)) * std::sin(std::numbers::pi * x) /
                         (std::numbers::pi * x));
      sum += weights_.back();
    }
    for (std::size_t i = first; i < weights_.size(); ++i) weights_[i] /= sum;
  }
}

std::vector<double> Interpolation::operator()(const std::vector<double>& signal) const {
  if (factor_ == 1 || signal.size() < 2) return signal;
  const std::size_t n = signal.size(), width = 2 * interpolation_reach;
  const std::vector<double> longer = continued(signal, interpolation_reach);
  std::vector<double> result;
  result.reserve(factor_ * (n - 1) + 1);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    result.push_back(signal[k]);
    const double* const around = longer.data() + k + 1;  // x_{k + 1 − reach}
    for (std::size_t step = 0; step + 1 < factor_; ++step) {
      const double* const weights = weights_.data() + step * width;
      double sum = 0.0;
      for (std::size_t j = 0; j < width; ++j) sum += weights[j] * around[j];
      result.push_back(sum);
    }
  }
  result.push_back(signal.back());
  return result;
}

std::vector<double> continued(const std::vector<double>& signal, std::size_t count) {
  std::vector<double> result;
  if (signal.empty()) return result;
  const std::size_t last = signal.size() - 1;
  result.reserve(signal.size() + 2 * count);
  for (std::size_t j = count; j > 0; --j) result.push_back(2.0 * signal.front() - signal[std::min(j, last)]);
  result.insert(result.end(), signal.begin(), signal.end());
  for (std::size_t j = 1; j <= count; ++j) result.push_back(2.0 * signal.back() - signal[last - std::min(j, last)]);
  return result;
}

}  // namespace host_sim
