// Which samples the control program believes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/loop/settings.hpp"
#include "firmware/loop/trip.hpp"
#include "hal/sensor_source.hpp"
#include "model/channel.hpp"

namespace firmware {

static_assert(model::channel_count <= hal::channel_capacity, "the firmware indexes hal's channels by model::Channel");

/// Bridges bad samples with the last good one, and says when they are too many.
///
/// Bad is: missing, not finite, clipped (all three judged by hal), or stale. A bad sample is counted and replaced by
/// the channel's last good value. Limits::bridged_in_a_row bad ones in a row, or a first sample that is bad (there is
/// nothing to bridge with), are a hazard.
class SampleGuard {
 public:
  SampleGuard(const Limits& limits, hal::Time period, const hal::SensorSource& sensors);

  /// One frame a period.
  void take(const hal::Result<hal::Frame>& frame, hal::Time now);

  /// From here on value(channel) is what was read less this offset; frame() stays as read.
  void tare(model::Channel channel, double offset) { tare_[model::index(channel)] = offset; }
  [[nodiscard]] double tare(model::Channel channel) const { return tare_[model::index(channel)]; }

  /// The first hazard of the last frame: bad samples, lost sensors, or a force beyond its limit.
  [[nodiscard]] const std::optional<Trip>& hazard() const { return hazard_ ? hazard_ : limit_hazard_; }
  /// Of these the first of a limit on good samples.
  [[nodiscard]] const std::optional<Trip>& limit_hazard() const { return limit_hazard_; }

  [[nodiscard]] bool fitted(model::Channel channel) const { return fitted_[model::index(channel)]; }
  [[nodiscard]] double value(model::Channel channel) const {
    return good_[model::index(channel)];
  }                                                                                               ///< last good, tared
  [[nodiscard]] bool seen(model::Channel channel) const { return seen_[model::index(channel)]; }  ///< ever good

  [[nodiscard]] const hal::Frame& frame() const { return frame_; }  ///< as read; all missing when there was none
  [[nodiscard]] std::uint16_t bridged() const { return bridged_; }  ///< bit i: channel i of the last frame was bad
  [[nodiscard]] std::uint64_t bridged_count() const { return bridged_count_; }
  [[nodiscard]] std::uint64_t missed_frames() const { return missed_frames_; }

 private:
  [[nodiscard]] Reason judge(const hal::Reading& reading, hal::Time now) const;
  void report(Reason reason, std::optional<model::Channel> channel, double value, double limit, hal::Time now);

  int most_in_a_row_;
  double force_limit_;
  hal::Time oldest_;
  std::array<bool, model::channel_count> fitted_{};
  std::array<double, model::channel_count> good_{};
  std::array<double, model::channel_count> tare_{};
  std::array<bool, model::channel_count> seen_{};
  std::array<int, model::channel_count> in_a_row_{};
  hal::Frame frame_{};
  std::uint16_t bridged_ = 0;
  std::uint64_t bridged_count_ = 0;
  std::uint64_t missed_frames_ = 0;
  std::optional<Trip> hazard_{};
  std::optional<Trip> limit_hazard_{};
};

}  // namespace firmware
