// Settled coefficients of adaptive_time_series in a loop.
#pragma once

#include "firmware/loop/compensation/settings.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim::compensation {

inline constexpr double lowest_hz = 0.1, highest_hz = 50.0;  ///< of road and response

/// The coefficients a that firmware::compensation::TimeSeries repeats, on a road |z_r|² ∝ 1/f² from 0.1 to 50 Hz and
/// with a memory that is long beside its motions. For machine M and wanted deflection x:
///
///   (1)  ∫ |G ω x|² Re{(−jω)^i (A M a′ − A)} df = 0,  i = 0 … order,  A = Σ a_i (jω)^i,  A M a′ = Σ a′_j (jω)^j M A
///   (2)  x = x₀ (1 + Q₀/P₀)/(1 + A e^{−sτ} Q/P)        P, Q of stability::LinearRig; index 0: no machine
///   (3)  a = a′, within the bounds of `settings`
///
/// G: SignalFilter. A cut series cannot be the inverse at all frequencies: a is a mean over them, and the wheel's peak
/// is as far off as the mean is from the inverse there.
[[nodiscard]] firmware::compensation::Coefficients arrived_series(const firmware::compensation::Settings& settings,
                                                                  const model::RigParameters<double>& rig);

/// Coefficients of a time series, each within the bounds of its adaptation.
void keep_within_bounds(firmware::compensation::Settings& settings);

}  // namespace host_sim::compensation
