#include "firmware/loop/command_guard.hpp"

#include <cmath>

namespace firmware {

CommandGuard::CommandGuard(const Limits& limits, double period, double rest)
    : half_stroke_(0.5 * limits.stroke),
      speed_(limits.speed),
      speed_time_(limits.speed_time),
      period_(period),
      last_{rest, 0.0, 0.0} {}

CommandGuard::Verdict CommandGuard::judge(const hal::Command& wanted) {
  Verdict verdict{wanted, false, std::nullopt};
  if (!std::isfinite(wanted.position) || !std::isfinite(wanted.velocity) || !std::isfinite(wanted.acceleration)) {
    verdict.hazard = Trip{Reason::command_not_finite, std::nullopt, wanted.position, 0.0, hal::never};
    return verdict;
  }
  if (wanted.position > half_stroke_ || wanted.position < -half_stroke_) {
    verdict.hazard = Trip{Reason::stroke, std::nullopt, wanted.position, half_stroke_, hal::never};
    return verdict;
  }
  const double way = wanted.position - last_.position;
  double wanted_speed = way / period_;
  const double farthest = speed_ * period_;
  const double rounding = 1e-9 * farthest;  // a reference that moves at just the limit is not beyond it
  if (way > farthest + rounding || way < -farthest - rounding) {
    verdict.limited = true;
    const double direction = way > 0.0 ? 1.0 : -1.0;
    verdict.command = {last_.position + direction * farthest, direction * speed_, 0.0};
  } else if (wanted.velocity > speed_ * (1.0 + 1e-9) || wanted.velocity < -speed_ * (1.0 + 1e-9)) {
    verdict.limited = true;
    verdict.command = {wanted.position, wanted.velocity > 0.0 ? speed_ : -speed_, 0.0};
    wanted_speed = wanted.velocity;
  }
  if (!verdict.limited) {
    limited_in_a_row_ = 0;
    return verdict;
  }
  ++limited_count_;
  ++limited_in_a_row_;
  if (static_cast<double>(limited_in_a_row_) * period_ > speed_time_ + 0.5 * period_) {
    verdict.hazard = Trip{Reason::speed, std::nullopt, wanted_speed, speed_, hal::never};
  }
  return verdict;
}

void CommandGuard::passed(const hal::Command& command) {
  velocity_ = (command.position - last_.position) / period_;
  last_ = command;
}

}  // namespace firmware
