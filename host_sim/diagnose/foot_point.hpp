// The motion of the foot point from two sensors.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host_sim/diagnose/evidence.hpp"

namespace host_sim::diagnose {

/// The most likely displacement z behind a measured displacement Z with white noise σ_z and a measured acceleration A
/// with white noise σ_a, h apart:
///
///   (1)  min  Σ_k (Z_k − z_k)²/σ_z² + Σ_k (M A − δ²z/h²)_k²/σ_a²      δ²: second difference, M = 1 + δ²/12
///
/// δ²z/h² = M z̈ up to (ωh)⁴/240, 5e-6 at 30 Hz and 1 kHz. Displacement rules below √(σ_a/σ_z)/2π, acceleration above. A
/// sample of A that is not finite counts for nothing.
[[nodiscard]] std::vector<double> fused_displacement(const std::vector<double>& displacement,
                                                     const std::vector<double>& acceleration, double displacement_noise,
                                                     double acceleration_noise, double period);

/// Whether the two cannot be of one motion: the power of M A − δ²Z/h² in some band up to 90 Hz is beyond that of the
/// noise of both,
///
///   (2)  σ_a² |M|² + σ_z² (4 sin²(πfh)/h²)²,   M = 1 − sin²(πfh)/3
///
/// by 6 standard deviations, and by a tenth. An instant at which A is not finite counts for nothing.
[[nodiscard]] bool disagree(const std::vector<double>& displacement, const std::vector<double>& acceleration,
                            double displacement_noise, double acceleration_noise, double period);

/// The frequency above which a displacement is not above its white noise any more [Hz], 10 … 90.
[[nodiscard]] double known_up_to(const std::vector<double>& displacement, double noise, double period);

/// z̈ of a motion through samples, up to `highest` [Hz]: above, the noise of a displacement grows with f². A symmetric
/// filter of ± acceleration_reach; at the ends the last value goes on.
void smooth_acceleration(FootPointMotion& motion, double highest, double period);

/// What that filter takes away from a measured acceleration with white noise, as a variance over a window without the
/// noise's.
[[nodiscard]] double variance_above(double highest, const std::vector<double>& acceleration, Window window,
                                    double noise, double period);

}  // namespace host_sim::diagnose
