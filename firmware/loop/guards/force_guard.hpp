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
///   (1)  x̄ ← x̄ + (x − x̄) h/T,   x̃ = x − x̄;   f̃ likewise        T = 2 memory: offsets and drifts count for nothing
///   (2)  X ← X + (x̃² − X) h/memory,   Φ likewise of f̃²
///   (3)  X > force_way²  and  Φ < (force_share · k)² X          hazard: innovation of F
///
/// k: stiffness of the described springs at rest, behind a top mount in series, times the gain of the sensor. Absorber,
/// damper and friction add to it but near the frequency at which an absorber, or a mass that moves with the load cell,
/// takes the spring's force away: there the paper's FDVA leaves 0.22 of it (six open ducts, ± 1 mm at 8 Hz; 0.38 with
/// two). Nothing is predicted: whatever the component does beyond its spring is what the rig is there to find.
///
/// After F is gone Φ falls as e^(−u)(1 + c² u), u = t/memory, c the force at that instant by its rms: with c = 3 from
/// (2.75 k)² X (springs and coupling of the paper's rig) to (0.1 k)² X in 11.3 memories, 2.8 s; from k² X with c = 1 in
/// 1.7 s. Samples of x or F that are bad leave (1) and (2) as they are. Not judged without a spring, with free play, or
/// of a sensor that is described to saturate.
class ForceGuard {
 public:
  ForceGuard(const Supervision& supervision, const model::RigParameters<double>& rig, double period);

  /// Everything begins anew.
  void start();
  /// One period.
  [[nodiscard]] std::optional<Trip> follow(const SampleGuard& samples, hal::Time now);

  /// √(Φ/X)/k; 1 for the spring alone, 0 as long as nothing is judged.
  [[nodiscard]] double share() const;

 private:
  static constexpr double memory = 0.25;  ///< [s]

  double least_;       ///< force_share · k [N/m]; 0: not judged
  double stiffness_;   ///< k [N/m]
  double way_;         ///< force_way² [m²]
  double mean_share_;  ///< h/T
  double share_;       ///< h/memory
  bool started_ = false;
  double position_ = 0.0, force_ = 0.0;    ///< x̄ [m], f̄ [N]
  double positions_ = 0.0, forces_ = 0.0;  ///< X [m²], Φ [N²]
};

}  // namespace firmware
