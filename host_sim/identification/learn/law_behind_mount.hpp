// A law over velocity behind a spring in series, read off a measured force and stroke without a simulation.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// Behind a mount of stiffness k the component moves by less than the machine, and how much less the force says:
///
///   (1)  x_i = x_act − F/k,   v_i = ẋ_i           inside of the mount
///   (2)  F = F₀ + s x_act + f(v_i)                f piecewise linear, f(0) = 0: linear in F₀, s and its points
///   (3)  k: where (2) leaves least of F
///
/// With the right k the force is one curve over v_i, with another one a loop. The noise of F stands on both sides of
/// (2), so what is found is where a fit by simulation begins. x_act and F are taken as recorded, velocities by central
/// differences. Source: the hysteresis loop of a damper dynamometer, J. C. Dixon, The Shock Absorber Handbook, 2007,
/// chapter 10 (compliance of rods and bushes).
struct LawBehindMount {
  double stiffness = 0.0;     ///< k [N/m]
  double offset = 0.0;        ///< F₀ [N]
  std::vector<double> at;     ///< v_i of the points [m/s], rising, with 0
  std::vector<double> force;  ///< f there [N]
};

/// Of all that is fitted. nullopt: x_act or F are not recorded or do not move, or no k inside of the range of (3),
/// F_rms/x_rms … 1000 F_rms/x_rms, leaves less than its neighbours.
[[nodiscard]] std::optional<LawBehindMount> law_behind_mount(const IdentificationProblem& problem);

}  // namespace host_sim::identification
