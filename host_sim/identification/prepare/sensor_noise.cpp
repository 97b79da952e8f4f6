#include "host_sim/identification/prepare/sensor_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/identification/prepare/sample_hold.hpp"

namespace host_sim::identification {

double estimated_noise(const std::vector<double>& samples) {
  constexpr std::array<double, 7> weights{1, -6, 15, -20, 15, -6, 1};
  double gain = 0.0;  // Σ weights²: of the variance of white noise
  for (const double w : weights) gain += w * w;
  constexpr std::size_t stretch = 64;
  std::vector<double> variances;
  for (std::size_t from = 0; from + stretch + weights.size() <= samples.size(); from += stretch) {
    double squares = 0.0;
    for (std::size_t k = from; k < from + stretch; ++k) {
      double difference = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i) difference += weights[i] * samples[k + i];
      squares += difference * difference;
    }
    variances.push_back(squares / (stretch * gain));
  }
  if (variances.empty()) return 0.0;
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return std::sqrt(*middle);
}

double sensor_noise(const firmware::RigDescription& description, const firmware::Recording& recording,
                    model::Channel channel) {
  if (const auto& given = description.noise[index(channel)]) return *given;
  const auto& samples = recording[channel];
  const auto renewals = renewals_of(samples);
  if (!renewals) return estimated_noise(samples);
  std::vector<double> renewed;
  for (const std::size_t k : renewals->at) renewed.push_back(samples[k]);
  return estimated_noise(renewed);
}

}  // namespace host_sim::identification
