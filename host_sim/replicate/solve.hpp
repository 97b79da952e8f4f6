// The drive that makes the model do what the target shows.
#pragma once

#include <string>
#include <vector>

#include "host_sim/replicate/band_inverse.hpp"
#include "host_sim/replicate/drive_limits.hpp"
#include "host_sim/replicate/drive_model.hpp"
#include "host_sim/replicate/solve_input.hpp"
#include "host_sim/replicate/target.hpp"

namespace host_sim::replicate {

/// A drive and what the model makes of it.
struct Solution {
  std::vector<double> drive;            ///< [m]
  DriveModel::Answer answer;            ///< of the model, by channel of the target
  std::vector<double> error;            ///< rms(target − answer − offset) / rms(target), in the band, by channel
  std::vector<double> error_unlimited;  ///< the same without limits; empty: no limit was in the way
  LimitsUsed used;
  int rounds = 0;
};

/// Non-linear least squares on the model, with limits:
///
///   (1)  min_u Σ_c w_c ∫ b_c |t_c − d_c − y_c(u)|² df,   u within the limits;   w, b as in BandInverse, d the offset
///
/// Multisecant quasi-Newton method. E_k = t − d − y(u_k) in its band; ΔE, ΔU are the differences of the last rounds:
///
///   (2)  γ_j = argmin ‖h_j (E_k − ΔE γ)‖            in each piece j of the drive, h_j a Hann window, Σ_j h_j = 1
///   (3)  u_{k+1} = P(u_k − Σ_j h_j ΔU γ_j + H⁺(E_k − Σ_j h_j ΔE γ_j))
///
/// H⁺: BandInverse (2), of a quarter car the step of MotionInverse; P: limits. A rig forgets, so the Jacobian has the form
/// of a band along time: secants of pieces see it where one secant for the whole drive sees a mean. Corners: first of the
/// rig without them, then as they are. The best drive found is kept: more rounds never make it worse. Work and memory are
/// linear in the length of the drive (FFT: times its logarithm). Where it stays far from the target (thresholds::secants_fail:
/// much friction in free play), solve_along_trajectory() is asked as well, and the better drive is taken. Source: H. Fang, Y.
/// Saad, Numer. Linear Algebra Appl. 16 (2009), 197–221 (multisecant); the pieces are ours.
[[nodiscard]] Solution solve(const DriveModel& model, const Target& target, const BandInverse& inverse,
                             const DriveLimits& limits, const SolveInput& input, const SolveProgress& progress = {});

}  // namespace host_sim::replicate
