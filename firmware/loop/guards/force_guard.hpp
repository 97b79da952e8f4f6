// Does the measured force answer the motion at all?
#pragma once

#include <optional>

#include "firmware/loop/common/settings.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/guards/sample_guard.hpp"
#include "model/rig/rig_parameters.hpp"

namespace firmware {

/// Compares F of hil and component_bench with the spring of the described component. A load cell that is torn off, or a
/// cable that is cut behind its amplifier, shows noise: it is neither frozen, nor clipped, nor beyond a limit.
///
///   (1)  u = x − y,  y ← y + (x − y) h/(τ + h)                                 τ = 5 ms
///   (2)  X, and the variances and covariances of x, u and F, over blocks of 0.5 s one after the other
///   (3)  Φ: the variance of F that a x + b u explains, by least squares
///   (4)  X > force_way²  and  √(Φ/X) < force_share · k           hazard: innovation of F, with √(Φ/X) [N/m]
///
/// k: stiffness of the described springs at rest, behind a top mount in series, times the gain of the sensor. In a motion
/// of whatever frequency x and u span position and velocity, and nothing is differentiated. Spring, damper, friction and
/// an absorber's mass answer them; noise, hum and offset do not. Nothing else is predicted: whatever the component does
/// beyond its spring is what the rig is there to find.
///
/// The block behind the one in which F is lost shows it: after 0.5 to 1 s at any sample rate, if the drive moves by more
/// than force_way, rms, in it. The same holds for a gain that is lost: for less than a tenth of the spring's force.
///
/// Noise of σ hides the loss from a block of N samples with probability exp(−N (force_share k force_way/σ)²/2), by χ² with
/// two degrees of freedom: for 31.5 kN/m and 2 mm rms at 1 kHz 2e-5 of 30 N and less than 1e-40 of 10 N. The next
/// block is judged anew. A sound component is far from (4): over the paper's FDVA with no, two and six open ducts √(Φ/X)/k
/// was never below 0.4 in 300 s each of classes A to C; where its absorber takes the spring's force away 0.22 are left
/// (six open ducts, ± 1 mm at 8 Hz). Nine hours of a bench and four of a hil rig ended without a false alarm. Samples of
/// x or F that are bad belong to no block. Not judged without a spring, with free play, of a sensor that is described to
/// saturate, or with fewer than four samples in 0.5 s.
class ForceGuard {
 public:
  ForceGuard(const Supervision& supervision, const model::RigParameters<double>& rig, double period);

  /// Everything begins anew.
  void start();
  /// One period.
  [[nodiscard]] std::optional<Trip> follow(const SampleGuard& samples, hal::Time now);

 private:
  static constexpr double memory = 0.5;  ///< [s] of a block; half of it: a motion of 1 Hz is hardly one
  static constexpr double lag = 0.005;   ///< τ [s]; four times as long: sound components come down to 0.1
  struct Sums {                          ///< over the samples of this block
    double n = 0.0, x = 0.0, u = 0.0, f = 0.0, xx = 0.0, xu = 0.0, xf = 0.0, uu = 0.0, uf = 0.0;
  };

  double least_;      ///< force_share · k [N/m]; 0: not judged
  double way_;        ///< force_way² [m²]
  double lag_share_;  ///< h/(τ + h)
  double block_;      ///< samples
  bool started_ = false;
  double lagged_ = 0.0;  ///< y [m]
  Sums sums_{};
};

}  // namespace firmware
