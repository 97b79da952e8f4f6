// Which commands reach the drive.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/loop/settings.hpp"
#include "firmware/loop/trip.hpp"
#include "hal/command_output.hpp"

namespace firmware {

/// Holds every command against stroke and speed.
///
/// Not finite, or beyond the stroke: a hazard at once, the command does not pass. Faster than the limit: the command
/// moves as far as one period at that speed allows, is counted, and is a hazard when this lasts longer than speed_time
/// without a break. A feed-forward velocity beyond the limit is cut to it in the same way.
class CommandGuard {
 public:
  CommandGuard(const Limits& limits, double period, double rest);

  struct Verdict {
    hal::Command command{};        ///< what may go out, if there is no hazard
    bool limited = false;          ///< slower than wanted
    std::optional<Trip> hazard{};  ///< time not filled in
  };

  [[nodiscard]] Verdict judge(const hal::Command& wanted);

  /// What has gone out: the next command is held against it.
  void passed(const hal::Command& command);

  [[nodiscard]] const hal::Command& last() const { return last_; }  ///< the command for this instant
  [[nodiscard]] double velocity() const { return velocity_; }       ///< at which the last one moved [m/s]
  [[nodiscard]] std::uint64_t limited_count() const { return limited_count_; }

 private:
  double half_stroke_;
  double speed_;
  double speed_time_;
  double period_;
  hal::Command last_{};
  double velocity_ = 0.0;
  std::uint64_t limited_in_a_row_ = 0;
  std::uint64_t limited_count_ = 0;
};

}  // namespace firmware
