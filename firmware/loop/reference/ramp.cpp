#include "firmware/loop/reference/ramp.hpp"

namespace firmware {

SmoothMove::SmoothMove(double from, double to, double rate, double period) : from_(from), to_(to), period_(period) {
  const double way = to > from ? to - from : from - to;
  constexpr double most = 9007199254740992.0;  // 2⁵³: the count stays exact; beyond, the move has no end
  const double wanted = 1.5 * way / (rate * period);
  const double periods = wanted < most ? wanted : most;
  steps_ = static_cast<std::uint64_t>(periods);
  if (static_cast<double>(steps_) < periods) ++steps_;
}

hal::Command SmoothMove::next() {
  if (!arrived()) ++step_;
  if (arrived()) return {to_, 0.0, 0.0};
  const double duration = static_cast<double>(steps_) * period_;
  const double s = static_cast<double>(step_) / static_cast<double>(steps_);
  const double way = to_ - from_;
  return {from_ + way * (s * s * (3.0 - 2.0 * s)),  // (1)
          way * (6.0 * s * (1.0 - s)) / duration, way * (6.0 - 12.0 * s) / (duration * duration)};
}

ReturnToRest::ReturnToRest(double position, double velocity, const Ramps& ramps, double half_stroke, double period)
    : position_(position), velocity_(velocity), stop_position_(position), period_(period) {
  const double speed = velocity < 0.0 ? -velocity : velocity;
  const double way_left = velocity < 0.0 ? half_stroke + position : half_stroke - position;
  if (speed > 0.0 && way_left > 0.0) {
    const double needed = speed * speed / (2.0 * way_left);
    const double deceleration = needed > ramps.braking ? needed : ramps.braking;  // (2)
    const double braking_way = speed * speed / (2.0 * deceleration);
    deceleration_ = velocity < 0.0 ? deceleration : -deceleration;
    stop_time_ = speed / deceleration;
    stop_position_ = velocity < 0.0 ? position - braking_way : position + braking_way;
    stopped_ = false;
  }
  if (stop_position_ > half_stroke) stop_position_ = half_stroke;  // rounding
  if (stop_position_ < -half_stroke) stop_position_ = -half_stroke;
  back_ = SmoothMove(stop_position_, ramps.rest, ramps.rate, period);
}

ReturnToRest ReturnToRest::brake_and_hold(double position, double velocity, const Ramps& ramps, double half_stroke,
                                          double period) {
  ReturnToRest way(position, velocity, ramps, half_stroke, period);
  way.back_ = SmoothMove(way.stop_position_, way.stop_position_, ramps.rate, period);
  return way;
}

hal::Command ReturnToRest::next() {
  if (stopped_) return back_.next();
  ++step_;
  const double t = static_cast<double>(step_) * period_;
  if (t >= stop_time_) {
    stopped_ = true;
    return {stop_position_, 0.0, 0.0};
  }
  return {position_ + velocity_ * t + 0.5 * deceleration_ * t * t, velocity_ + deceleration_ * t, deceleration_};
}

}  // namespace firmware
