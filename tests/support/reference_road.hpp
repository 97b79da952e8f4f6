// Roads for tests: seeded, the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "model/components/road_filter.hpp"
#include "model/numerics/motion.hpp"

namespace support {

/// Independent normal numbers, mean 0, variance 1 (Box–Muller on splitmix64).
class NormalNoise {
 public:
  explicit NormalNoise(std::uint64_t seed) : state_(seed) {}
  double operator()() {
    constexpr double two_pi = 6.28318530717958647692;
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(two_pi * uniform());
  }
  /// 0 ≤ u < 1
  double uniform() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBU;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

/// A road at 100 km/h, band limited to `bandwidth` [Hz]; starts level. Class B: roughness 64e-6 m³.
[[nodiscard]] inline std::vector<model::Motion<double>> random_road(double roughness, double period, double duration,
                                                                    std::uint64_t seed, double bandwidth = 40.0) {
  using Filter = model::RoadFilter<double>;
  const Filter filter({roughness, 100.0 / 3.6, 0.01, bandwidth}, period);
  NormalNoise noise(seed);
  Filter::State state = Filter::State::Zero();
  const double loudness = std::sqrt(0.5 / period);
  std::vector<model::Motion<double>> road{filter.motion(state)};
  for (double t = period; t < duration; t += period) {
    state = filter.step(state, loudness * noise());
    road.push_back(filter.motion(state));
  }
  return road;
}

}  // namespace support
