// Which samples the control program believes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "hal/sensor_source.hpp"
#include "model/components/channel.hpp"

namespace firmware {

static_assert(model::channel_count <= hal::channel_capacity, "the firmware indexes hal's channels by model::Channel");

/// Bridges bad samples with the last good one, and says when they are too many.
///
/// Bad is: missing, not finite, clipped (all three judged by hal), or stale. A bad sample is counted and replaced by
/// the channel's last good value. Limits::bridged_in_a_row bad ones in a row, a lasting share of bad ones that a bucket
/// of that size does not lose again, or a first sample that is bad (there is nothing to bridge with), are a hazard. So
/// is a force F or F_w whose size, less its tare, is beyond a limit; where a force may be beyond it and becomes smaller
/// (the way back from a force limit), only one that grows:
///
///   (1)  |F| > limit and |F| > F₀ + growth · limit,   F₀ ← min(F₀, |F|)
///   (2)  level ← min(level + 1, bridged_in_a_row)     a bad sample of a channel; a hazard where the level is full
///   (3)  level ← max(0, level − bridged_leak)         a good one; 1/bridged_leak is taken for a whole number
///
/// With a leak of ¼ any lasting share of bad samples above one in five trips: by then a channel is late by a fifth of a
/// period in the mean, and by one and two periods in turns.
class SampleGuard {
 public:
  SampleGuard(const Limits& limits, hal::Time period, const hal::SensorSource& sensors);

  /// From here on a force is judged against this limit [N]; `growing`: by (1). Its F₀ begins where that begins.
  void judge_force(double limit, bool growing);
  /// (1) begins anew: F₀ is the next force.
  void begin_growth() { least_force_.fill(never_reached); }
  /// The channels that are bad now may stay so: they are lasting(), and hide no other.
  void bear() {
    borne_ = lost_ ? all_channels : bad_;
    borne_lost_ = lost_;
  }
  void bear_nothing() {
    borne_ = 0;
    borne_lost_ = false;
  }

  /// One frame a period.
  void take(const hal::Result<hal::Frame>& frame, hal::Time now);

  /// From here on value(channel) is what was read less this offset; frame() stays as read.
  void tare(model::Channel channel, double offset) { tare_[model::index(channel)] = offset; }
  [[nodiscard]] double tare(model::Channel channel) const { return tare_[model::index(channel)]; }

  /// The first hazard of the last frame: bad samples, lost sensors, or a force beyond its limit.
  [[nodiscard]] const std::optional<Trip>& hazard() const { return hazard_ ? hazard_ : limit_hazard_; }
  /// Of these the first of a limit on good samples.
  [[nodiscard]] const std::optional<Trip>& limit_hazard() const { return limit_hazard_; }
  /// Every hazard of the last frame, one call each.
  template <class Use>
  void each_hazard(hal::Time now, Use&& use) const {
    if (hazard_) use(*hazard_);
    for (std::size_t i = 0; i < model::channel_count; ++i) {
      if ((bad_ >> i & 1U) != 0) use(bad_sample(i, now));
    }
    for (const model::Channel channel : {model::Channel::F, model::Channel::F_w}) {
      if (const auto hazard = beyond_limit(channel, now)) use(*hazard);
    }
  }
  /// What is still as it was when it was borne.
  [[nodiscard]] const std::optional<Trip>& lasting() const { return lasting_; }

  [[nodiscard]] bool fitted(model::Channel channel) const { return fitted_[model::index(channel)]; }
  [[nodiscard]] double value(model::Channel channel) const {
    return good_[model::index(channel)];
  }  ///< last good, tared
  /// Fitted, and the sample of this period is good.
  [[nodiscard]] bool good(model::Channel channel) const {
    return fitted(channel) && seen(channel) && (bridged_ >> model::index(channel) & 1U) == 0;
  }
  [[nodiscard]] bool seen(model::Channel channel) const { return seen_[model::index(channel)]; }  ///< ever good

  [[nodiscard]] const hal::Frame& frame() const { return frame_; }  ///< as read; all missing when there was none
  [[nodiscard]] std::uint16_t bridged() const { return bridged_; }  ///< bit i: channel i of the last frame was bad
  [[nodiscard]] std::uint64_t bridged_count() const { return bridged_count_; }
  [[nodiscard]] std::uint64_t missed_frames() const { return missed_frames_; }

 private:
  [[nodiscard]] Reason judge(const hal::Reading& reading, hal::Time now) const;
  [[nodiscard]] Trip bad_sample(std::size_t channel, hal::Time now) const;
  [[nodiscard]] std::optional<Trip> beyond_limit(model::Channel channel, hal::Time now) const;
  void report(const Trip& hazard, bool borne);
  static constexpr std::uint16_t all_channels = 0xffff;
  void judge_forces(hal::Time now);

  static constexpr double growth = 0.02;  ///< share of the limit: 500 N of 25 kN, 50 σ of a force sensor

  int weight_;  ///< of a bad sample, in good ones: 1/bridged_leak
  int full_;    ///< of a level, in good samples
  double force_limit_;
  bool growing_ = false;
  std::array<double, 2> least_force_{never_reached, never_reached};  ///< F₀ of F and F_w
  bool lost_ = false;                                                ///< the source, in this period
  bool borne_lost_ = false;
  std::uint16_t bad_ = 0;  ///< bit i: channel i is a hazard in this period
  std::uint16_t borne_ = 0;
  hal::Time oldest_;
  std::array<bool, model::channel_count> fitted_{};
  std::array<double, model::channel_count> good_{};
  std::array<double, model::channel_count> tare_{};
  std::array<bool, model::channel_count> seen_{};
  std::array<int, model::channel_count> levels_{};
  hal::Frame frame_{};
  std::uint16_t bridged_ = 0;
  std::uint64_t bridged_count_ = 0;
  std::uint64_t missed_frames_ = 0;
  std::optional<Trip> hazard_{};
  std::optional<Trip> limit_hazard_{};
  std::optional<Trip> lasting_{};
};

}  // namespace firmware
