// How a command moves when no reference leads it.
#pragma once

#include <cstdint>

#include "firmware/loop/common/settings.hpp"
#include "hal/command_output.hpp"

namespace firmware {

/// From one place to another at a given highest speed, one period a call:
///
///   (1)  x(s) = x₀ + (x₁ − x₀)(3s² − 2s³),   s = 0 … 1 over T = 1.5 |x₁ − x₀| / rate, rounded up to whole periods
///
/// At rest at both ends; the highest speed, in the middle, is 1.5 |x₁ − x₀| / T ≤ rate; |ẍ| ≤ 6 |x₁ − x₀| / T².
/// A move of more than 2⁵³ periods is taken to last 2⁵³.
class SmoothMove {
 public:
  SmoothMove() = default;
  SmoothMove(double from, double to, double rate, double period);

  /// Where the command shall be one period on; after the end it stays there.
  [[nodiscard]] hal::Command next();

  [[nodiscard]] bool arrived() const { return step_ >= steps_; }

 private:
  double from_ = 0.0;
  double to_ = 0.0;
  double period_ = 1.0;
  std::uint64_t steps_ = 0;
  std::uint64_t step_ = 0;
};

/// From motion to rest, one period a call: first to a stop with constant deceleration, then back by a SmoothMove.
///
///   (2)  x(t) = x₀ + v₀ t − ½ d t² sgn v₀   until t = |v₀|/d,   d = max(braking, v₀²/(2 · way left in the stroke))
///
/// So the way to the stop never leaves the stroke. Without any way left the command stops dead.
class ReturnToRest {
 public:
  ReturnToRest() = default;
  /// At `position` within ± half_stroke, moving with `velocity`.
  ReturnToRest(double position, double velocity, const Ramps& ramps, double half_stroke, double period);

  /// To a stop by (2), and nowhere else.
  [[nodiscard]] static ReturnToRest brake_and_hold(double position, double velocity, const Ramps& ramps,
                                                   double half_stroke, double period);

  [[nodiscard]] hal::Command next();

  [[nodiscard]] bool braking() const { return !stopped_; }
  [[nodiscard]] bool arrived() const { return stopped_ && back_.arrived(); }

 private:
  double position_ = 0.0;
  double velocity_ = 0.0;
  double deceleration_ = 0.0;  ///< with the sign of −velocity
  double stop_time_ = 0.0;
  double stop_position_ = 0.0;
  double period_ = 1.0;
  std::uint64_t step_ = 0;
  bool stopped_ = true;
  SmoothMove back_{};
};

}  // namespace firmware
