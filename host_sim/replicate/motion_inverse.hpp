// The drive that moves the wheel as it is wished: the inverse of a quarter car with its corners.
#pragma once

#include <complex>
#include <vector>

#include "host_sim/replicate/band_inverse.hpp"
#include "host_sim/replicate/drive_model.hpp"

namespace host_sim::replicate {

/// On a wheel that moves as prescribed nothing of a quarter car has to be inverted: body and component follow it, with
/// friction, stops and play, and say what load Φ[z_w] the wheel needs. Below the wheel are a tyre and a machine, which are
/// linear. So a step of the drive u for errors e of the channels is, by frequency,
///
///   (1)  δz_w = H_w H⁺ e                                          H⁺: BandInverse (2), H_w: z_w over the drive
///   (2)  δu   = [δz_w (1 − m_w ω²/Z) + p δΦ/Z] / H_m,             δΦ = Φ[z_w + δz_w] − Φ[z_w]
///
/// with z_w the motion that the rig with its corners makes of u, at all frequencies; Φ the load less m_w z̈_w; Z the
/// stiffness of the tyre F_w/dz_w; H_m the machine z_r/u; p = M/(M + ρ) of BandInverse, which keeps δu within the bands.
/// (2) is exact but for what the drive cannot make above the bands: friction that reverses a little earlier or later.
class MotionInverse {
 public:
  MotionInverse(const DriveModel& model, const BandInverse& inverse);

  /// A rig with a wheel that a machine moves.
  [[nodiscard]] static bool possible(const DriveModel& model);

  /// (1), (2) from a drive of `rig`, the model with its corners at a share.
  [[nodiscard]] std::vector<double> drive(const model::RigParameters<double>& rig, const std::vector<double>& from,
                                          const std::vector<std::vector<double>>& errors) const;

 private:
  using Bins = std::vector<std::complex<double>>;

  /// Φ of a motion of the wheel.
  [[nodiscard]] std::vector<double> load(const model::RigParameters<double>& bare,
                                         const std::vector<double>& wheel) const;

  const DriveModel& model_;
  const BandInverse& inverse_;
  Bins wheel_;     ///< H_w
  Bins of_wheel_;  ///< (1 − m_w ω²/Z)/H_m
  Bins of_load_;   ///< p/(Z H_m)
};

}  // namespace host_sim::replicate
