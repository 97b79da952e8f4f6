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

/// What is left of both, squared and divided by its variance, per sample: 1 where they agree.
[[nodiscard]] double disagreement(const std::vector<double>& fused, const std::vector<double>& displacement,
                                  const std::vector<double>& acceleration, double displacement_noise,
                                  double acceleration_noise, double period);

}  // namespace host_sim::diagnose
