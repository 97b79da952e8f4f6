#include "host_sim/signal/line.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace host_sim {

std::complex<double> line_in(const std::vector<double>& signal, double frequency, double period, double first_time) {
  std::complex<double> sum = 0.0;
  double weight = 0.0;
  const double n = static_cast<double>(signal.size());
  for (std::size_t k = 0; k < signal.size(); ++k) {
    const auto at = static_cast<double>(k);
    const double w = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * (at + 0.5) / n);
    const double phase = 2.0 * std::numbers::pi * frequency * (first_time + at * period);
    sum += w * signal[k] * std::complex<double>(std::cos(phase), -std::sin(phase));
    weight += w;
  }
  return weight > 0.0 ? 2.0 / weight * sum : 0.0;
}

}  // namespace host_sim
