#include "firmware/loop/guards/motion_guard.hpp"

#include <cmath>

#include "model/effects/catalogue.hpp"

namespace firmware {
namespace {

double absolute(double value) { return value < 0.0 ? -value : value; }

/// How many periods a step needs so that `duration` is at most `samples` steps long.
int periods_a_step(double duration, double period, std::size_t samples) {
  int stride = 1;
  while (duration > period * stride * static_cast<double>(samples)) ++stride;
  return stride;
}

}  // namespace

MotionGuard::MotionGuard(const Limits& limits, const Supervision& supervision, const model::RigParameters<double>& rig,
                         double period, double low_speed)
    : channel_(rig.kind == model::RigKind::quarter_car ? model::Channel::z_r : model::Channel::x_act),
      following_(limits.following),
      following_least_(limits.following < never_reached ? limits.following_least : 0.0),
      following_delay_(limits.following / limits.speed),
      following_share_(supervision.following_share),
      memory_(supervision.following_memory),
      half_stroke_(0.5 * limits.highest_measured_stroke()),
      highest_speed_(limits.highest_measured_speed()),
      low_speed_(low_speed < highest_speed_ ? low_speed : highest_speed_),
      confirmations_(limits.bridged_in_a_row),
      period_(period) {
  model::MachinePath<double> path{};
  rig.effects.act_on(path);
  const model::SensorPath<double> sensor = rig.effects.sensor_paths()[model::index(channel_)];
  if (sensor.gain != 0.0) gain_ = sensor.gain;
  offset_ = sensor.offset;
  if (sensor.limit > 0.0) following_least_ = 0.0;  // it shows no motion beyond its limit
  const double delay = path.delay + sensor.delay + sensor.lag + 0.5 * sensor.hold;

  const int for_line = periods_a_step(delay, period, Line::longest);
  const int for_window = periods_a_step(supervision.speed_window, period, window_length - 1);
  stride_ = for_line > for_window ? for_line : for_window;
  period_ = period * stride_;
  machine_ = model::Machine<double>(path, period_);
  const double steps = supervision.speed_window / period_ + 0.5;
  window_ = steps < 1.0 ? 1 : static_cast<std::size_t>(steps);
  if (window_ > window_length - 1) window_ = window_length - 1;
  const double allowed_steps = supervision.following_time / period_ + 0.5;
  following_steps_ = static_cast<int>(allowed_steps);
  memory_ = period_ < memory_ ? period_ / memory_ : 1.0;
  line_.start({}, static_cast<float>(delay / period_));
}

void MotionGuard::start(double position) {
  const model::Stroke<double> rest{position, 0.0};
  line_.start({static_cast<float>(position), 0.0F}, line_.delay());
  state_ = machine_.start(rest);
  delayed_ = reached_ = rest;
  measured_ = 0;
  until_step_ = 0;
  error_ = speed_ = mean_error_ = 0.0;
  mean_allowed_ = following_least_ * following_least_;
  away_ = far_ = fast_ = calm_ = 0;
}

std::optional<Trip> MotionGuard::follow(const hal::Command& command, const SampleGuard& samples, hal::Time now,
                                        bool arming) {
  if (until_step_ > 0) {
    --until_step_;
    return std::nullopt;
  }
  until_step_ = stride_ - 1;
  line_.push({static_cast<float>(command.position), static_cast<float>(command.velocity)});
  const model::Stroke<float> late = line_.read(static_cast<float>(period_));
  const model::Stroke<double> there{static_cast<double>(late.position), static_cast<double>(late.velocity)};
  reached_ = machine_.step(state_, delayed_, there, reached_);  // (1)
  delayed_ = there;
  if (!samples.fitted(channel_) || !samples.seen(channel_)) return std::nullopt;
  if (arming) {
    const double error = (samples.value(channel_) - offset_) / gain_ - reached_.position;
    offset_at_rest_ += (period_ < rest_time ? period_ / rest_time : 1.0) * (error - offset_at_rest_);
    mean_error_ = 0.0;
  }
  return judge((samples.value(channel_) - offset_) / gain_, now);
}

std::optional<Trip> MotionGuard::judge(double position, hal::Time now) {
  error_ = position - reached_.position;  // (2)
  newest_ = (newest_ + 1) % window_length;
  positions_[newest_] = static_cast<float>(position);
  if (measured_ <= window_) ++measured_;
  const float before = positions_[(newest_ + window_length - window_) % window_length];
  speed_ = measured_ > window_
               ? (position - static_cast<double>(before)) / (static_cast<double>(window_) * period_)  // (3)
               : 0.0;

  away_ = absolute(error_) > following_ ? away_ + 1 : 0;
  far_ = absolute(position) > half_stroke_ ? far_ + 1 : 0;
  const int settled = following_steps_ + static_cast<int>(window_);
  if (absolute(reached_.velocity) > low_speed_) calm_ = 0;
  if (calm_ <= settled) ++calm_;
  const double highest = slow_ && calm_ > settled ? low_speed_ : highest_speed_;
  fast_ = absolute(speed_) > highest ? fast_ + 1 : 0;
  if (far_ >= confirmations_) return hazard_of(Reason::measured_stroke, channel_, position, half_stroke_, now);
  if (fast_ >= confirmations_) return hazard_of(Reason::measured_speed, channel_, speed_, highest, now);
  if (away_ > following_steps_) return hazard_of(Reason::following_error, channel_, error_, following_, now);
  if (following_least_ <= 0.0) return std::nullopt;
  const double allowed = following_least_ + following_delay_ * absolute(reached_.velocity) +
                         following_share_ * absolute(reached_.position);  // (4)
  const double moved = error_ - offset_at_rest_;
  mean_error_ += memory_ * (moved * moved - mean_error_);  // (5)
  mean_allowed_ += memory_ * (allowed * allowed - mean_allowed_);
  if (mean_error_ > mean_allowed_) {
    return hazard_of(Reason::following_error, channel_, std::sqrt(mean_error_), std::sqrt(mean_allowed_), now);
  }
  return std::nullopt;
}

}  // namespace firmware
