// The rig as its Kalman filter computes it.
#pragma once

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/kalman/kalman_settings.hpp"

namespace firmware {

/// EstimatorEquations know springs, dampers, FDVA, one relaxing branch and top mount. This is the rig in these terms,
/// for the motion over the road of `settings`:
///
///   (1)  k = E{f x}/E{x²},  c = E{f v}/E{v²}       curves and surfaces f, x and v Gaussian, as the filter's own
///                                                  stationary covariance has them; dry parts of laws are left out
///   (2)  k₁ s + Maxwell branch                     air spring, isothermal and its heat
///   (3)  F_s = i F(i d) + k_l d                    lever at rest: stiffnesses and dampings times i², A_p times i
///
/// With (3) the filter's piston travels y/i: flow A_p ẏ, inertance, losses of both powers and all forces at the wheel
/// are those of the rig. (1) after Roberts and Spanos, Random Vibration and Statistical Linearization, 1990.
/// InputError for an air spring with a skyhook: the force of its area is no input of the filter.
[[nodiscard]] model::RigParameters<double> filtered_rig(const RigDescription& description,
                                                        const KalmanSettings& settings);

}  // namespace firmware
