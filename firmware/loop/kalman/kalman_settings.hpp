// What can be set about the Kalman filter.
#pragma once

#include <array>
#include <cstddef>

#include "model/components/channel.hpp"

namespace firmware {

/// Most channels that may have a bias state.
inline constexpr std::size_t bias_capacity = 3;
/// Most periods that a sample may come late.
inline constexpr int longest_history = 8;

/// Settings of [estimator] kind = "kalman". The noise of a channel decides whether it is used: 0 leaves it out.
struct KalmanSettings {
  bool enabled = false;
  std::array<double, model::channel_count> noise{};  ///< rms of the sensor's noise [SI]; 0: channel not used
  std::array<double, model::channel_count> age{};    ///< usual age of a sample when a period begins [s]
  std::array<bool, model::channel_count> bias{};     ///< channels whose offset is a state
  double bias_drift = 0.1;     ///< rms change of an offset within a second, in terms of the channel's noise [1]
  double roughness = 64e-6;    ///< G_d(n₀) of the road [m³]
  double speed = 27.78;        ///< over the road [m/s]
  double cut_off = 0.05;       ///< f_c of the road [Hz]
  double bandwidth = 30.0;     ///< f_b of the foot point [Hz]; 0: white velocity, one road state
  int history = 0;             ///< periods that a sample may come late; 0: the longest usual age, at least one
  double false_alarms = 1e-2;  ///< of the innovation monitor with a right model [1/h]
};

}  // namespace firmware
