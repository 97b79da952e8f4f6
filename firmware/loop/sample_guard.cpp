#include "firmware/loop/sample_guard.hpp"

namespace firmware {

using model::Channel;

SampleGuard::SampleGuard(const Limits& limits, hal::Time period, const hal::SensorSource& sensors)
    : most_in_a_row_(limits.bridged_in_a_row),
      force_limit_(limits.force),
      oldest_(hal::seconds(limits.stale_after * period.seconds())) {
  for (std::size_t i = 0; i < model::channel_count; ++i) fitted_[i] = sensors.fitted(i);
}

void SampleGuard::take(const hal::Result<hal::Frame>& frame, hal::Time now) {
  hazard_.reset();
  limit_hazard_.reset();
  bridged_ = 0;
  frame_ = frame ? *frame : hal::Frame{};
  if (!frame) {
    ++missed_frames_;
    if (frame.fault() != hal::Fault::timeout) report(Reason::sensors_lost, std::nullopt, 0.0, 0.0, now);
  }

  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!fitted_[i]) continue;
    const hal::Reading& reading = frame_.channels[i];
    const Reason reason = judge(reading, now);
    if (reason == Reason::none) {
      good_[i] = reading.value - tare_[i];
      seen_[i] = true;
      in_a_row_[i] = 0;
      continue;
    }
    bridged_ = static_cast<std::uint16_t>(bridged_ | (1U << i));
    ++bridged_count_;
    if (in_a_row_[i] < most_in_a_row_) ++in_a_row_[i];
    if (in_a_row_[i] >= most_in_a_row_ || !seen_[i]) {
      report(reason, model::channel_at(i), reading.value, static_cast<double>(most_in_a_row_), now);
    }
  }

  for (const Channel channel : {Channel::F, Channel::F_w}) {
    if (!fitted(channel)) continue;
    const double force = value(channel);
    const bool beyond = force > force_limit_ || force < -force_limit_;
    if (beyond && !limit_hazard_) limit_hazard_ = Trip{Reason::force, channel, force, force_limit_, now};
  }
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

void SampleGuard::report(Reason reason, std::optional<Channel> channel, double value, double limit, hal::Time now) {
  if (!hazard_) hazard_ = Trip{reason, channel, value, limit, now};
}

}  // namespace firmware
