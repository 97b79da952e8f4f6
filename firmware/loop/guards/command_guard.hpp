// Which commands reach the drive.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "hal/command_output.hpp"

namespace firmware {

/// Holds every command against stroke, speed and acceleration.
///
/// Not finite, or beyond the stroke: a hazard at once, the command does not pass. Faster than the limit, or
/// accelerating more than the limit: the command moves as far as the limits allow, is counted, and is a hazard when
/// this lasts longer than speed_time without a break. With e the way to the wanted place beyond what its own velocity v
/// covers in a period h, and a the acceleration limit:
///
///   (1)  v⁺ = v + sgn(e) (√(b² h² + 2 b |e|) − b h)      so fast that braking still ends at the wanted place
///   (2)  v⁺ within last velocity ± a h, then within ± speed
///   (3)  b = a + v̇ sgn(e), within a/4 … a                of braking by a there is left what the wanted place, which
///                                                        accelerates by v̇, does not need for itself
///
/// With b = a the command overshot a reference that turned round while it was being caught up with, and was limited for
/// three times as long.
///
/// Speed and acceleration are those of the positions. A feed-forward velocity beyond the limit is cut to it and counted
/// in the same way; a feed-forward acceleration is cut. A slower command's acceleration is that of its positions, as
/// the acceleration sensor of a foot point that follows will show it.
class CommandGuard {
 public:
  CommandGuard(const Limits& limits, double period, double rest);

  struct Verdict {
    hal::Command command{};  ///< what may go out, if there is no hazard
    bool limited = false;    ///< slower than wanted
    std::optional<Trip> hazard{};
  };

  [[nodiscard]] Verdict judge(const hal::Command& wanted, hal::Time now = hal::never);

  /// What has gone out: the next command is held against it.
  void passed(const hal::Command& command);

  [[nodiscard]] const hal::Command& last() const { return last_; }  ///< the command for this instant
  [[nodiscard]] double velocity() const { return velocity_; }       ///< at which the last one moved [m/s]
  [[nodiscard]] std::uint64_t limited_count() const { return limited_count_; }

 private:
  /// The position one period on that comes nearest to the wanted one.
  [[nodiscard]] hal::Command catch_up(const hal::Command& wanted) const;
  /// (3); the acceleration of the wanted place is counted in the direction of e.
  [[nodiscard]] double braking_towards(double wanted_acceleration) const;

  static constexpr double least_braking = 0.25;  ///< b is at least so much of a

  double half_stroke_;
  double speed_;
  double acceleration_;
  double speed_time_;
  double period_;
  hal::Command last_{};
  double velocity_ = 0.0;
  double cause_ = 0.0;         ///< of the limiting: the first acceleration [m/s²], or the last speed [m/s]
  bool began_sudden_ = false;  ///< it began with an acceleration
  std::uint64_t limited_in_a_row_ = 0;
  std::uint64_t limited_count_ = 0;
};

}  // namespace firmware
