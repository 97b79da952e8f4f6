// Velocity and acceleration of a measured stroke.
#pragma once

#include <vector>

#include "firmware/simulation/road.hpp"

namespace host_sim {

/// Motion through samples x_k, h apart, by central differences of eighth order:
///
///   (1)  ẋ_k = Σ_j a_j (x_{k+j} − x_{k−j})/h              a = 4/5, −1/5, 4/105, −1/280
///   (2)  ẍ_k = Σ_j b_j (x_{k+j} − 2 x_k + x_{k−j})/h²     b = 8/5, −1/5, 8/315, −1/560
///
/// Of a sine of ω (1) falls short by (ωh)⁸/630 and (2) by (ωh)⁸/3150 of itself, both without a phase: at 90 Hz and h =
/// 1.05 ms, the longest step of a simulation, by 2.5e-5 and 5e-6. A bench near its resonance needs that: there the
/// forces of spring and mass cancel, and what either is wrong by is compared with the damper's. With differences of
/// fourth order (firmware::through_samples) and an acceleration that knows the past alone, (ωh)³/20 beside it (6e-3 of
/// ẍ at 80 Hz and 1 kHz, as a damper), c of such a bench came out 4 … 11 % too large. Within four samples of the ends
/// the motion is that of firmware::through_samples.
///
/// Source: B. Fornberg, Mathematics of Computation 51, 1988, table 1.
[[nodiscard]] firmware::FootPointMotion measured_motion(const std::vector<double>& samples, double sample_rate);

}  // namespace host_sim
