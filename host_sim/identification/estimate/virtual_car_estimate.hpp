// The virtual car of a hil rig, which the real-time program computes.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace host_sim::identification {

/// A value with its standard error.
struct Estimate {
  double value, error;
};

/// An effect of the virtual tyre, and how it changes the residual of (3).
struct TyreEffect {
  firmware::PlacedEffect effect;
  std::vector<Estimate> parameters;
  double gain = 0.0;   ///< fall of Σ(residual of (3))²/σ² on fitted samples, in independent samples
  double count = 0.0;  ///< independent fitted samples
};

/// rms of the residual of (3) ÷ rms of F_w, on samples that were not fitted (on the fitted ones where nothing is held
/// out): tyre as described, k_t and b_t refitted, effects added.
struct TyreError {
  double described = 0.0, refitted = 0.0, with_effects = 0.0;
};

/// A number of the virtual car with which the program does not compute as described.
struct VirtualNumberOff {
  std::string path;
  double described;  ///< [SI]
  double gain;  ///< fall of Σ(residual of (1) to (3))²/σ² with it and the others of its kind, in independent samples
};

struct VirtualCarEstimate {
  std::map<std::string, Estimate> parameters;  ///< tolerated ones and those that are off, by path
  std::vector<VirtualNumberOff> off{};
  std::vector<TyreEffect> effects;
  TyreError tyre_error;
};

/// The tolerated parameters of the virtual car (masses, tyre, virtual damping) by bounded least squares over the
/// numbers that the program recorded, which carry no sensor noise:
///
///   (1)  m_b z̈_b − b̃ ẋ_cmd = F      (2)  m_w z̈_w + b̃ ẋ_cmd = F_w − F      (3)  k_t dz_w + b_t ḋz_w + p law(dz_w) = F_w
///
/// b̃: virtual damping. Each equation is used where its channels are recorded, in units of the rms of its right-hand
/// side. Velocities are differences of fourth order. Laws of the virtual tyre show in (3) alone: one that is
/// proportional to its only parameter p where it takes away half the power that a linear tyre leaves and moves F_w by a
/// thousandth; one without parameters that bounds F_w where the lowest F_w is repeated exactly near the bound. The laws
/// are asked on their cards. A number that is not as described, with or without a tolerance, is `off` where freeing it
/// takes away nearly all that is left of the equations (thresholds::freed_number_leaves).
[[nodiscard]] VirtualCarEstimate estimate_virtual_car(const firmware::RigDescription& description,
                                                      const std::vector<PreparedRecording>& recordings);

}  // namespace host_sim::identification
