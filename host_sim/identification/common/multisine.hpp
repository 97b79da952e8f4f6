// Excitation in one band of frequencies.
#pragma once

#include <cstddef>

#include "firmware/simulation/road.hpp"

namespace host_sim::identification {

struct Band {
  double from, to;  ///< [Hz]
};

/// Sines of equal velocity over a band, from position 0. Phases for a low peak: M. Schroeder, IEEE Trans. Inf. Theory
/// 16, 1970.
[[nodiscard]] firmware::FootPointMotion multisine(Band band, double period, std::size_t samples);

struct MotionSize {
  double velocity = 0.0, travel = 0.0;  ///< rms, peak
};
[[nodiscard]] MotionSize size_of(const firmware::FootPointMotion& motion);

void scale(firmware::FootPointMotion& motion, double factor);

}  // namespace host_sim::identification
