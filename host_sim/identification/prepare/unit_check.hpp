// Unit check: channels in a wrong unit or with a swapped sign, found before anything is explained with them.
#pragma once

#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"

namespace host_sim::identification {

/// A channel whose ratio to its simulation is that of a unit or a sign, and of no effect.
struct UnitError {
  model::Channel channel;
  double factor;  ///< recorded = factor × SI: ±1000 for millimetres, ±0.001 for kN, −1 for a swapped sign …
  /// The factor is that of the unit up to thresholds::unit_factor_certain (of a sign: it is negative), and no other
  /// channel has a factor that is neither right nor a unit's: the description is not what is wrong.
  bool certain = true;
};

/// Compares 12 s from the middle of the recording with a simulation of the rig as described, driven by the recording's
/// own input. Of each channel c
///
///   (1)  factor_c      = Σ m e / Σ e²           m: measured, e: simulated, without their means
///   (2)  correlation_c = (Σ m e)² / (Σ m² Σ e²)
///
/// and a channel with correlation_c > ½ has a unit error where factor_c is near that of a unit or a swapped sign. Where
/// most channels share the factor, the error is the input's. zdd_r is compared with z_r:
///
///   (3)  Σ_j (H − |jh|) z̈(t + jh) h / H² = (z(t+H) − 2 z(t) + z(t−H)) / H²,   H = 10 ms
///
/// In a hil rig machine and component are compared on x_cmd, then the car on z_r.
[[nodiscard]] std::vector<UnitError> unit_errors(const firmware::RigDescription& description,
                                                 const firmware::Recording& recording);

/// InputError that names the channels that are certainly wrong, what they look like, and what to write in [channels].
/// Returns a remark on those that are not certain, and on those whose scale the rig description gives in so many words:
/// whoever writes it insists.
[[nodiscard]] std::vector<std::string> check_units(const firmware::RigDescription& description,
                                                   const firmware::Recording& recording);

}  // namespace host_sim::identification
