// The sampled loop with a compensator as one linear map, from the code that runs on the rig.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "firmware/loop/compensation/compensator.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim::compensation {

using Complex = std::complex<double>;

/// One period of virtual car, compensator, machine and component:
///
///   (1)  x⁺ = A x + B₀ [z_r, ż_r] + B₁ [z_r⁺, ż_r⁺],   y = C x + D [z_r, ż_r],   y = (F_w, x, x_act)
///
/// The columns are steps of model::VirtualCar, firmware::compensation::Compensator and model::RigModel from unit
/// vectors: no second implementation. The rig must be linear (stability::sampled_part). Start-up, rate and limits do
/// not act. adaptive_time_series has the coefficients that it settles at (arrived_series); adaptive_virtual_damping has
/// its whole damping.
struct CompensatedLoop {
  Eigen::MatrixXd a, b_before, b_now, c, d;
  double period{};

  enum Output : int { wheel_load, wanted, reached };

  /// Largest modulus of the eigenvalues of A; stable below 1.
  [[nodiscard]] double spectral_radius() const;
  /// (F_w, x, x_act) ÷ z_r at ω [rad/s].
  [[nodiscard]] Eigen::Vector3cd response(double omega) const;
};

/// \param settings      nullptr: no compensation
/// \param force_factor  of the measured force, before the compensator: for gain margins
[[nodiscard]] CompensatedLoop compensated_loop(const model::RigParameters<double>& rig, double period,
                                               const firmware::compensation::Settings* settings,
                                               double force_factor = 1.0);

}  // namespace host_sim::compensation
