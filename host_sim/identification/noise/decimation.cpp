#include "host_sim/identification/noise/decimation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/signal/kaiser.hpp"
#include "host_sim/signal/wide.hpp"

namespace host_sim::identification {
namespace {

std::vector<double> half_band(double highest) {
  const double width = 0.5 - 2.0 * highest;
  auto half = static_cast<std::size_t>(std::ceil(kaiser_length(width)));
  half += half % 2 == 0 ? 1 : 0;  // the outermost factor at an odd place: those at even ones are zero
  std::vector<double> factors;
  double sum = 0.0;
  for (std::size_t j = 1; j <= half; j += 2) {
    const double x = static_cast<double>(j), sign = j % 4 == 1 ? 1.0 : -1.0;
    factors.push_back(kaiser_window(x / static_cast<double>(half + 1)) * sign / (std::numbers::pi * x));
    sum += 2.0 * factors.back();
  }
  for (double& h : factors) h *= 0.5 / sum;  // a constant stays what it is
  return factors;
}

/// (1) of n samples: `sum` holds the even ones halved; odd[k] is x_{2k+1}, with room on both sides. Pieces that stay in
/// the first-level cache.
RIGTWIN_WIDE void add_odd(const double* factors, std::size_t count, const double* odd, double* sum, std::size_t n) {
  constexpr std::size_t piece = 1024;
  for (std::size_t first = 0; first < n; first += piece) {
    const std::size_t last = first + piece < n ? first + piece : n;
    for (std::size_t i = 0; i < count; ++i) {
      const double h = factors[i];
      const double* const after = odd + i;       // x_{2k + (2i+1)}
      const double* const before = odd - i - 1;  // x_{2k − (2i+1)}
      for (std::size_t k = first; k < last; ++k) sum[k] += h * (before[k] + after[k]);
    }
  }
}

}  // namespace

Decimation::Decimation(double sample_rate, double highest) {
  for (double rate = sample_rate; rate / 4.0 >= 1.25 * highest; rate /= 2.0)
    stages_.push_back(half_band(highest / rate));
}

std::vector<double> Decimation::operator()(std::vector<double> signal) const {
  std::vector<double> even, odd;
  for (const std::vector<double>& factors : stages_) {
    // x_{2k} and x_{2k+1} apart, with room for zeros around them, so that each factor is one pass over neighbours.
    const std::size_t n = signal.size() / 2, room = factors.size();
    even.resize(n);
    odd.resize(n + 2 * room);
    std::fill_n(odd.begin(), room, 0.0);
    std::fill_n(odd.end() - static_cast<std::ptrdiff_t>(room), room, 0.0);
    for (std::size_t k = 0; k < n; ++k) {
      even[k] = 0.5 * signal[2 * k];
      odd[room + k] = signal[2 * k + 1];
    }
    add_odd(factors.data(), factors.size(), odd.data() + room, even.data(), n);
    signal.swap(even);
  }
  return signal;
}

}  // namespace host_sim::identification
