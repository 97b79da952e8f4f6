// Plays a reference: stands still and goes on again, at a level, without a jump.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/loop/reference/reference.hpp"

namespace firmware {

/// The reference by a clock of its own, scaled about its beginning x₀:
///
///   (1)  x = x₀ + L (r(τ) − x₀),   ẋ = L ṙ τ̇ + L̇ (r − x₀),   ẍ = L (r̈ τ̇² + ṙ τ̈) + 2 L̇ ṙ τ̇ + L̈ (r − x₀)
///   (2)  to stand still:  τ̇ = 1 − 3s² + 2s³,   τ = τ₀ + T (s − s³ + s⁴/2),   s = 0 … 1 over T
///   (3)  to go on:        τ̇ = 3s² − 2s³,       τ = τ₀ + T (s³ − s⁴/2)
///   (4)  a new level:     L = L₀ + (L₁ − L₀)(3s² − 2s³) over T · max(1, |L₁ − L₀|) of the clock τ
///
/// T is 1 s, an even number of periods: (2) and (3) end half as many samples on, on a sample. So before, between and
/// after two of them the reference is played as it is, to the bit; between samples it is a cubic through both. What is
/// asked for during a change waits for its end. The level follows the same clock: a reference that stands still keeps
/// its level, too. What is asked for in between begins once the reference has gone on, and a change that was under way
/// goes on with it.
class ReferencePlayer {
 public:
  static constexpr double change_time = 1.0;    ///< T [s]
  static constexpr double highest_level = 1.5;  ///< of level()

  ReferencePlayer(Reference& reference, double period);

  /// From the beginning: where it is. The level that was asked for last holds from there.
  [[nodiscard]] std::optional<Motion> start();

  /// One period on. No value: the reference has ended.
  [[nodiscard]] std::optional<Motion> next();

  void hold() { holds_ = true; }
  void resume() { holds_ = false; }
  void level(double wanted) { wanted_level_ = wanted; }  ///< 0 … highest_level

  [[nodiscard]] bool standing() const { return pace_ == Pace::standing; }
  [[nodiscard]] double level() const { return level_; }
  [[nodiscard]] std::uint64_t sample() const { return index_; }  ///< of the reference, the newest that was asked for

 private:
  enum class Pace : unsigned char { playing, slowing, standing, quickening };

  [[nodiscard]] std::optional<Motion> play();
  [[nodiscard]] std::optional<Motion> change_pace();
  [[nodiscard]] bool take_until(std::uint64_t index);
  void begin_level();
  [[nodiscard]] Motion scaled(Motion motion);

  Reference& reference_;
  double period_;
  std::uint64_t change_steps_;  ///< T in periods

  Motion begin_{};
  Motion before_{};  ///< sample index_ − 1, where it was asked for
  Motion newest_{};  ///< sample index_
  std::uint64_t index_ = 0;

  Pace pace_ = Pace::playing;
  bool holds_ = false;
  std::uint64_t from_ = 0;  ///< sample at which the change of pace began
  std::uint64_t pace_step_ = 0;

  double level_ = 1.0;
  double wanted_level_ = 1.0;
  double level_from_ = 1.0, level_to_ = 1.0;
  double level_step_ = 0.0, level_steps_ = 0.0;  ///< of the change under way, in periods of τ
  // Of the clock, in this period.
  double clock_step_ = 1.0;    ///< so many periods of τ
  double clock_rate_ = 1.0;    ///< τ̇
  double clock_change_ = 0.0;  ///< τ̈ [1/s]
  double paced_ = 0.0;         ///< periods of τ since the change of pace began
};

}  // namespace firmware
