#pragma once
#include <vector>

#include "tests/truth/truth.hpp"

namespace truth {

/// Position, velocity, acceleration of a prescribed motion.
struct Motion {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
};

/// A prescribed motion: road under the rig, or command to the machine of a bench.
///
/// Sum of cosines with random amplitude and phase, spaced 1/length apart, so nothing lies above the band's end:
///   road    one-sided G(f) = level² · G_d n₀² v / f² · (f/0.35)⁴ / (1 + (f/0.35)⁴),  G_d = 64·10⁻⁶ m³, v = 27.78 m/s,
///   up to 40 Hz bench   G(f) ∝ 1 / (f² + 4 Hz²), scaled to rms = level, times the modulation, up to 25 Hz
/// (shapes read off the spectra of the samples; corner and cut may be others). A ramp of 1 s, three times
/// differentiable, starts it. Known exactly at the samples; between them a quintic through position, velocity and
/// acceleration at both ends, wrong by (2π·40 Hz·1 ms)⁶/46080 = 6·10⁻⁹ of the amplitude at most.
class Signal {
 public:
  Signal(const RecordPlan& plan, bool bench);  ///< from t = −warm to duration
  explicit Signal(std::vector<Motion> knots);  ///< given at every millisecond

  [[nodiscard]] Motion at(double time) const;  ///< [s] after the first knot; held beyond the ends

 private:
  std::vector<Motion> knots_;
};

}  // namespace truth
