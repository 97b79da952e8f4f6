// Input fusion: the motion of the foot point from a displacement and an acceleration sensor.
#pragma once

#include <cstddef>
#include <vector>

#include "firmware/simulation/road.hpp"
#include "host_sim/identification/prepare/recording_window.hpp"

namespace host_sim::identification {

/// The most likely displacement z behind a measured displacement Z with white noise σ_z and a measured acceleration A
/// with white noise σ_a, h apart:
///
///   (1)  min  Σ_k (Z_k − z_k)²/σ_z² + Σ_k (M A − δ²z/h²)_k²/σ_a²      δ²: second difference, M = 1 + δ²/12
///
/// δ²z/h² = M z̈ up to (ωh)⁴/240, 5e-6 at 30 Hz and 1 kHz. The displacement dominates below √(σ_a/σ_z)/2π, the
/// acceleration above. Samples of A that are not finite are left out. (1) is a linear system with five diagonals,
/// solved by L D Lᵀ: a smoother over the whole recording, without a filter's edges. Source: the fixed-interval smoother
/// as least squares, A. Gelb, Applied Optimal Estimation, 1974, ch. 5; M is Numerov's.
[[nodiscard]] std::vector<double> fused_displacement(const std::vector<double>& displacement,
                                                     const std::vector<double>& acceleration, double displacement_noise,
                                                     double acceleration_noise, double period);

/// M A − δ²Z/h², which would be 0 without noise; 0 at both ends and where A is not finite.
[[nodiscard]] std::vector<double> contradiction(const std::vector<double>& displacement,
                                                const std::vector<double>& acceleration, double period);

/// Whether the two contradict each other: the power of M A − δ²Z/h² in some band up to 90 Hz exceeds that of the noise
/// of both,
///
///   (2)  σ_a² |M|² + σ_z² (4 sin²(πfh)/h²)²,   M = 1 − sin²(πfh)/3
///
/// by thresholds::input_disagreement and input_disagreement_share. Samples of A that are not finite are left out.
/// `step`: samples for each one that was recorded; nothing above 0.45 of the recorded rate is compared.
[[nodiscard]] bool disagree(const std::vector<double>& displacement, const std::vector<double>& acceleration,
                            double displacement_noise, double acceleration_noise, double period, std::size_t step = 1);

/// The variance that smoothed() takes away from a measured acceleration over a window, less that of the noise.
[[nodiscard]] double variance_above(double highest, const std::vector<double>& acceleration, Window window,
                                    double noise, double period);

}  // namespace host_sim::identification
