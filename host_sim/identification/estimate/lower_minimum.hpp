// Lower minima beside the one where a fit ended.
#pragma once

#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::identification {

/// With corners a Jacobian of differences over more than a standard deviation is mostly what friction and free play
/// make of other samples (of a car with friction 70 to 90 % of the columns of its masses), and its fit ends beside the
/// minimum. So it goes on with the Jacobian of refine_jacobian().
///
/// And χ² has steps: where a knock or a change of sign passes from one sample to the next, one residual jumps.
/// A fit that follows slopes ends at the first of them. So it is tried again from around where it ended,
///
///   (1)  u' = u + L n,   L Lᵀ: covariance of Fit (3),   n: normal, independent
///
/// that is from where the parameters may as well be, with the same Jacobian, from four places at once. The best becomes
/// u where it is better, thresholds::lower_rounds times. Then the fit goes on there. Where all four end where they
/// began the valley is smooth, and the first round is the last. Nothing without corners. Draws are the same in every run. Source: D. J. Wales and J. P. K. Doye, J. Phys. Chem. A 101, 1997 (basin
/// hopping).
void find_lower_minimum(const IdentificationProblem& problem, Fit& fit);

}  // namespace host_sim::identification
