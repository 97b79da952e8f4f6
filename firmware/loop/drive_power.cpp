#include "firmware/loop/drive_power.hpp"

namespace firmware {
namespace {

double share_of(double period, double time) { return period < time ? period / time : 1.0; }

}  // namespace

DrivePower::DrivePower(hal::DriveEnable& enable, const Supervision& supervision, double period, model::Channel position,
                       hal::DriveEnable* high_pressure)
    : enable_(enable),
      high_pressure_(high_pressure),
      enable_time_(hal::seconds(supervision.enable_time)),
      way_(supervision.unpowered_way),
      mean_share_(share_of(period, mean_time)),
      place_share_(share_of(period, place_time)),
      channel_(position) {}

bool DrivePower::write(hal::Time now) {
  if (written_ && on_ == wanted_) return true;
  written_ = static_cast<bool>(enable_.write(wanted_));
  if (!written_) {
    ++failures_;
    return false;
  }
  if (on_ != wanted_) {
    agreed_ = now;
    if (on_) taken_ = now;
  }
  on_ = wanted_;
  return true;
}

bool DrivePower::write_high_pressure(bool wanted) {
  const bool high = wanted && wanted_ && (on_ || always());
  if (high_pressure_ == nullptr || high_ == high) return true;
  high_.reset();
  if (!high_pressure_->write(high)) {
    ++failures_;
    return false;
  }
  high_ = high;
  return true;
}

std::optional<Trip> DrivePower::watch(std::optional<double> position, hal::Time now) {
  if (taken_ == hal::never) taken_ = agreed_ = now;
  const std::optional<Trip> moves = watch_motion(position, now);
  moves_ = moves.has_value();
  const std::optional<Trip> differs = watch_feedback(now);
  return differs ? differs : moves;
}

std::optional<Trip> DrivePower::watch_feedback(hal::Time now) {
  if (!enable_.feedback_fitted()) return std::nullopt;
  const hal::Result<bool> shown = enable_.feedback();
  if (shown && *shown == on_) {
    agreed_ = now;
    return std::nullopt;
  }
  if (now - agreed_ <= enable_time_) return std::nullopt;
  return Trip{
      .reason = Reason::enable_feedback, .value = shown && *shown ? 1.0 : 0.0, .limit = on_ ? 1.0 : 0.0, .time = now};
}

std::optional<Trip> DrivePower::watch_motion(std::optional<double> position, hal::Time now) {
  if (on_ || !enable_.fitted()) {
    place_.reset();
    return std::nullopt;
  }
  if (!position) return std::nullopt;
  if (!place_ || now - taken_ <= enable_time_) {
    place_ = mean_ = *position;
    return std::nullopt;
  }
  *place_ += place_share_ * (*position - *place_);
  const double away = *position - mean_, size = away < 0.0 ? -away : away;
  mean_ += mean_share_ * away;  // (2)
  if (size <= way_) return std::nullopt;
  return Trip{.reason = Reason::motion_without_power, .channel = channel_, .value = away, .limit = way_, .time = now};
}

}  // namespace firmware
