#include "firmware/loop/guards/command_guard.hpp"

#include <cmath>

namespace firmware {
namespace {

bool beyond(double value, double limit) { return value > limit || value < -limit; }
double within(double value, double limit) { return value > limit ? limit : value < -limit ? -limit : value; }

}  // namespace

CommandGuard::CommandGuard(const Limits& limits, double period, double rest)
    : half_stroke_(0.5 * limits.stroke),
      speed_(limits.speed),
      acceleration_(limits.highest_acceleration()),
      speed_time_(limits.speed_time),
      period_(period),
      last_{rest, 0.0, 0.0} {}

CommandGuard::Verdict CommandGuard::judge(const hal::Command& wanted, hal::Time now) {
  Verdict verdict{wanted, false, std::nullopt};
  if (!std::isfinite(wanted.position) || !std::isfinite(wanted.velocity) || !std::isfinite(wanted.acceleration)) {
    verdict.hazard = Trip{Reason::command_not_finite, std::nullopt, wanted.position, 0.0, now};
    return verdict;
  }
  if (beyond(wanted.position, half_stroke_)) {
    verdict.hazard = Trip{Reason::stroke, std::nullopt, wanted.position, half_stroke_, now};
    return verdict;
  }
  const double wanted_speed = (wanted.position - last_.position) / period_;
  const double wanted_acceleration = (wanted_speed - velocity_) / period_;
  constexpr double rounding = 1.0 + 1e-9;  // a reference that moves at just the limit is not beyond it
  const bool fast = beyond(wanted_speed, speed_ * rounding);
  const bool sudden = beyond(wanted_acceleration, acceleration_ * rounding) ||
                      (limited_in_a_row_ > 0 && beyond(wanted_speed - wanted.velocity, acceleration_ * period_));
  const bool fast_forward = beyond(wanted.velocity, speed_ * rounding);
  verdict.limited = fast || sudden || fast_forward;
  if (fast || sudden) {
    verdict.command = catch_up(wanted);
  } else if (fast_forward) {
    verdict.command = {wanted.position, wanted.velocity > 0.0 ? speed_ : -speed_, 0.0};
  }
  verdict.command.acceleration = within(verdict.command.acceleration, acceleration_);
  if (!verdict.limited) {
    limited_in_a_row_ = 0;
    return verdict;
  }
  const bool begins = limited_in_a_row_ == 0;
  if (begins) began_sudden_ = !fast && !fast_forward;
  if (!began_sudden_ && (fast || fast_forward)) {
    cause_ = fast ? wanted_speed : wanted.velocity;
  } else if (begins) {
    cause_ = wanted_acceleration;
  }
  ++limited_count_;
  ++limited_in_a_row_;
  if (static_cast<double>(limited_in_a_row_) * period_ > speed_time_ + 0.5 * period_) {
    verdict.hazard = Trip{began_sudden_ ? Reason::acceleration : Reason::speed, std::nullopt, cause_,
                          began_sudden_ ? acceleration_ : speed_, now};
  }
  if (beyond(verdict.command.position, half_stroke_)) {  // too fast to brake before the end
    verdict.hazard = Trip{Reason::stroke, std::nullopt, verdict.command.position, half_stroke_, now};
  }
  return verdict;
}

double CommandGuard::braking_towards(double wanted_acceleration) const {
  const double left = acceleration_ + wanted_acceleration, least = least_braking * acceleration_;
  return left < least ? least : left > acceleration_ ? acceleration_ : left;
}

hal::Command CommandGuard::catch_up(const hal::Command& wanted) const {
  const double way = wanted.position - last_.position;
  double velocity = way > 0.0 ? speed_ : -speed_, acceleration = 0.0;
  if (acceleration_ < never_reached) {
    const double forward = within(wanted.velocity, speed_);
    const double beyond_it = way - forward * period_, distance = beyond_it < 0.0 ? -beyond_it : beyond_it;
    const double step = acceleration_ * period_;
    const double braking = braking_towards(beyond_it < 0.0 ? -wanted.acceleration : wanted.acceleration);
    const double short_way = braking * period_;
    const double closing = std::sqrt(short_way * short_way + 2.0 * braking * distance) - short_way;
    velocity = forward + (beyond_it < 0.0 ? -closing : closing);                // (1)
    velocity = within(velocity_ + within(velocity - velocity_, step), speed_);  // (2)
    acceleration = (velocity - velocity_) / period_;
  }
  return {last_.position + velocity * period_, velocity, acceleration};
}

void CommandGuard::passed(const hal::Command& command) {
  velocity_ = (command.position - last_.position) / period_;
  last_ = command;
}

}  // namespace firmware
