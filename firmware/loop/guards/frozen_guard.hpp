// Is a sensor alive?
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/guards/sample_guard.hpp"
#include "hal/command_output.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// Finds channels that show the very same value while the rig moves. Since the last change of a channel's value:
///
///   (1)  x_act, z_r, F          max x̂ − min x̂ ≥ frozen_way                    x̂: expected position of the machine
///   (2)  channels of a          max v − min v ≥ frozen_speed and              v, a: velocity and acceleration of
///        quarter car            max a − min a ≥ frozen_acceleration           the foot point's command
///
/// and at least frozen_time, whatever the sample rate. A rig at rest moves by nothing, so a quantised sensor at rest never trips. In
/// (2) both must have changed: a slow and wide motion deflects neither tyre nor suspension by a count, and a fast and
/// small one does not reach the body. At 1 Hz and up 0.05 m/s and 0.5 m/s² are 15 counts and more of each sensor of the
/// paper's rig; below, 0.5 m/s² are 0.8 mm of the tyre, 50 counts.
///
/// Not watched: channels that the rig description lets stand still while the rig moves. These are sensors with a limit
/// or hold, F of a component that is neither spring nor FDVA, and dz_b of a suspension with dry friction. Free play
/// adds to the way.
class FrozenGuard {
 public:
  FrozenGuard(const Supervision& supervision, const model::RigParameters<double>& rig, double period);

  /// Every channel may have stood still until now.
  void start();

  /// One period: frame of the guard of samples, expected position [m], command for this instant. A channel that is
  /// known to be frozen does not hide another.
  [[nodiscard]] std::optional<Trip> follow(const SampleGuard& samples, double expected, const hal::Command& command,
                                           hal::Time now = hal::never,
                                           std::optional<model::Channel> known = std::nullopt);

 private:
  /// What happened since a channel changed.
  struct Range {
    float lowest = 0.0F, highest = 0.0F;
    void begin(float value) { lowest = highest = value; }
    void hold(float value) {
      if (value < lowest) lowest = value;
      if (value > highest) highest = value;
    }
    [[nodiscard]] float width() const { return highest - lowest; }
  };
  struct Watch {
    float value = 0.0F;         ///< 24 bits, as many as any converter has
    std::int32_t samples = -1;  ///< since it changed; −1: not seen yet
    Range first{};              ///< (1) position, (2) velocity
    Range second{};             ///< (2) acceleration
  };

  [[nodiscard]] static bool by_position(model::Channel channel);

  double time_;           ///< frozen_time [s]; 0: nothing is watched
  std::int32_t samples_;  ///< as many periods
  float way_;
  float speed_;
  float acceleration_;
  std::array<bool, model::channel_count> watched_{};
  std::array<Watch, model::channel_count> watches_{};
};

}  // namespace firmware
