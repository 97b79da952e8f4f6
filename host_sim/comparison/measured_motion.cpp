#include "host_sim/comparison/measured_motion.hpp"

#include <array>
#include <cstddef>

namespace host_sim {

firmware::FootPointMotion measured_motion(const std::vector<double>& samples, double sample_rate) {
  constexpr std::array<double, 4> first{4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  constexpr std::array<double, 4> second{8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0};
  firmware::FootPointMotion motion = firmware::through_samples(samples, sample_rate);
  const double h = 1.0 / sample_rate;
  constexpr std::size_t reach = first.size();
  for (std::size_t k = reach; k + reach < samples.size(); ++k) {
    double rise = 0.0, bend = 0.0;
    for (std::size_t j = 1; j <= reach; ++j) {
      // Differences first: a constant signal has a velocity of exactly 0, and so no sign for friction.
      rise += first[j - 1] * (samples[k + j] - samples[k - j]);
      bend += second[j - 1] * ((samples[k + j] - samples[k]) - (samples[k] - samples[k - j]));
    }
    motion[k].velocity = rise / h;
    motion[k].acceleration = bend / (h * h);
  }
  return motion;
}

}  // namespace host_sim
