#include "host_sim/identification/common/multisine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace host_sim::identification {

firmware::FootPointMotion multisine(Band band, double period, std::size_t samples) {
  constexpr int lines = 24;
  firmware::FootPointMotion motion(samples);
  for (int i = 0; i < lines; ++i) {
    const double omega = 2.0 * std::numbers::pi * band.from * std::pow(band.to / band.from, (i + 0.5) / lines);
    const double phase = -std::numbers::pi * i * (i + 1) / lines;
    for (std::size_t k = 0; k < samples; ++k) {
      const double angle = omega * period * static_cast<double>(k) + phase;
      motion[k].position += (std::sin(angle) - std::sin(phase)) / omega;
      motion[k].velocity += std::cos(angle);
      motion[k].acceleration -= omega * std::sin(angle);
    }
  }
  return motion;
}

MotionSize size_of(const firmware::FootPointMotion& motion) {
  MotionSize size;
  if (motion.empty()) return size;
  for (const auto& m : motion) {
    size.velocity += m.velocity * m.velocity;
    size.travel = std::max(size.travel, std::abs(m.position - motion.front().position));
  }
  size.velocity = std::sqrt(size.velocity / static_cast<double>(motion.size()));
  return size;
}

void scale(firmware::FootPointMotion& motion, double factor) {
  for (auto& m : motion) {
    m.position *= factor;
    m.velocity *= factor;
    m.acceleration *= factor;
  }
}

}  // namespace host_sim::identification
