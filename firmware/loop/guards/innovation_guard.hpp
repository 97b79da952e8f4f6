// Does each sensor show what the Kalman filter expects of it?
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/kalman/estimator_equations.hpp"
#include "firmware/loop/kalman/kalman_filter.hpp"

namespace firmware {

/// Judges the innovations e = y − ŷ of each channel of a quarter car's filter, in terms of the standard deviation √s
/// that the filter expects of them: ν = e/√s, η = ŷ/√s. A sensor that is torn off shows noise, which no other guard
/// sees: ŷ goes on, and e = −ŷ.
///
///   (1)  ν̄ ← ν̄ + (ν − ν̄) h/T, ν̃ = ν − ν̄; η̃ likewise     T = 2 memory: offsets and drifts count for nothing
///   (2)  S ← S + (ν̃² − S) h/memory,  Y likewise of η̃²     S: normalised innovation squared (NIS) of the channel
///   (3)  S > innovation_noise² c  and  S > innovation_share² Y      hazard: innovation of the channel
///   (4)  c = (1 − 2/(9 N) + z √(2/(9 N)))³,  N = 2 memory/h,  1 − Φ(z) = false_alarms · h/3600 s/channels
///
/// c: what S of white noise of variance 1 exceeds with that probability, χ² with N degrees of freedom after Wilson and
/// Hilferty (1931). By Boole's inequality over all periods and channels noise alone ends at most `false_alarms` runs an
/// hour (the filter's setting, 0.01), even where it is innovation_noise times what is described. The second half of (3) is for
/// a model that is not quite right, as no model of a rig is: what it gets wrong of a channel must be more than this
/// share of what the channel is to show.
///
/// After a sensor is torn off S grows to Y as 1 − e^(−t/memory): it passes (0.5)² Y after 0.29 memories where the motion
/// is steady, 0.14 s, and where the last memory was c times as lively as this one after ln(1 + c²/3) of them, 0.7 s for
/// c = 3. The channel that is named is the farthest beyond its limit: the torn one, unless it leads the filter astray
/// (z_r, which holds the road). A torn-off zdd_r beside z_r ends no run: the filter takes it for a road that jumps
/// (KalmanFilter (5)).
/// Samples that are missing, bad or clipped have no innovation, and leave (1) and (2) as they are: SampleGuard has its
/// own word for them.
class InnovationGuard {
 public:
  static constexpr double memory = 0.5;  ///< [s]: seven cycles of the wheel; half of it scatters more, twice is later

  InnovationGuard(const Supervision& supervision, const EstimatorEquations& equations, double period);

  /// Everything begins anew.
  void start() { channels_ = {}; }
  /// One period, behind the filter's.
  [[nodiscard]] std::optional<Trip> follow(const KalmanFilter& filter, hal::Time now);

  /// √(S/Y) of a channel of the filter, 1 for one that is torn off; 0 as long as there is nothing.
  [[nodiscard]] double share(int channel) const;
  [[nodiscard]] double innovations(int channel) const { return at(channel).squares; }  ///< S
  [[nodiscard]] double limit() const { return limit_; }                                ///< innovation_noise² c

 private:
  struct PerChannel {
    bool started = false;
    double mean = 0.0, expected_mean = 0.0;        ///< ν̄, η̄
    double squares = 0.0, expected_squares = 0.0;  ///< S, Y
  };
  [[nodiscard]] const PerChannel& at(int channel) const { return channels_[static_cast<std::size_t>(channel)]; }

  int count_;
  double mean_share_;  ///< h/T
  double share_;       ///< h/memory
  double limit_;
  double model_;  ///< innovation_share²
  std::array<model::Channel, estimator_channels> names_{};
  std::array<PerChannel, estimator_channels> channels_{};
};

}  // namespace firmware
