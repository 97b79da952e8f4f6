#include "firmware/loop/guards/sample_guard.hpp"

namespace firmware {

using model::Channel;

SampleGuard::SampleGuard(const Limits& limits, hal::Time period, const hal::SensorSource& sensors)
    : weight_(static_cast<int>(1.0 / limits.bridged_leak + 0.5)),  // > 0. NOLINT(bugprone-incorrect-roundings)
      full_(weight_ * limits.bridged_in_a_row),
      force_limit_(limits.force),
      oldest_(hal::seconds(limits.stale_after * period.seconds())) {
  for (std::size_t i = 0; i < model::channel_count; ++i) fitted_[i] = sensors.fitted(i);
}

void SampleGuard::take(const hal::Result<hal::Frame>& frame, hal::Time now) {
  hazard_.reset();
  limit_hazard_.reset();
  lasting_.reset();
  bridged_ = 0;
  frame_ = frame ? *frame : hal::Frame{};
  if (!frame) {
    ++missed_frames_;
  }
  lost_ = !frame && frame.fault() != hal::Fault::timeout;
  if (lost_) report({.reason = Reason::sensors_lost, .time = now}, borne_lost_);
  bad_ = 0;

  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!fitted_[i]) continue;
    const hal::Reading& reading = frame_.channels[i];
    int& level = levels_[i];
    if (judge(reading, now) == Reason::none) {
      good_[i] = reading.value - tare_[i];
      seen_[i] = true;
      if (level > 0) --level;  // (3)
      continue;
    }
    bridged_ = static_cast<std::uint16_t>(bridged_ | (1U << i));
    ++bridged_count_;
    level = level < full_ - weight_ ? level + weight_ : full_;  // (2)
    if (level == full_ || !seen_[i]) {
      bad_ = static_cast<std::uint16_t>(bad_ | (1U << i));
      report(bad_sample(i, now), (borne_ >> i & 1U) != 0);
    }
  }

  judge_forces(now);
}

void SampleGuard::judge_force(double limit, bool growing) {
  force_limit_ = limit;
  if (growing && !growing_) begin_growth();
  growing_ = growing;
}

void SampleGuard::judge_forces(hal::Time now) {
  constexpr std::array forces{Channel::F, Channel::F_w};
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const Channel channel = forces[i];
    if (!fitted(channel)) continue;
    const double force = value(channel), size = force < 0.0 ? -force : force;
    if (growing_ && size < least_force_[i]) least_force_[i] = size;
    const std::optional<Trip> beyond = beyond_limit(channel, now);
    if (!beyond) continue;
    if (growing_ && size <= least_force_[i] + growth * force_limit_) {  // (1)
      if (!lasting_) lasting_ = beyond;
    } else if (!limit_hazard_) {
      limit_hazard_ = beyond;
    }
  }
}

std::optional<Trip> SampleGuard::beyond_limit(Channel channel, hal::Time now) const {
  if (!fitted(channel)) return std::nullopt;
  const double force = value(channel), size = force < 0.0 ? -force : force;
  if (size <= force_limit_) return std::nullopt;
  return hazard_of(Reason::force, channel, force, force_limit_, now);
}

Trip SampleGuard::bad_sample(std::size_t channel, hal::Time now) const {
  const hal::Reading& reading = frame_.channels[channel];
  const int most_in_a_row = full_ / weight_;
  return {judge(reading, now), model::channel_at(channel), reading.value, static_cast<double>(most_in_a_row), now};
}

Reason SampleGuard::judge(const hal::Reading& reading, hal::Time now) const {
  switch (reading.quality) {
    case hal::Quality::missing:
      return Reason::sample_missing;
    case hal::Quality::not_finite:
      return Reason::sample_not_finite;
    case hal::Quality::clipped:
      return Reason::sample_clipped;
    case hal::Quality::good:
      break;
  }
  const hal::Time age = now - reading.taken;
  return age > oldest_ || hal::Time{} - age > oldest_ ? Reason::sample_stale : Reason::none;
}

void SampleGuard::report(const Trip& hazard, bool borne) {
  std::optional<Trip>& place = borne ? lasting_ : hazard_;
  if (!place) place = hazard;
}

}  // namespace firmware
