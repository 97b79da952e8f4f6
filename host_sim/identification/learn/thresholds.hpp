// Every number that decides something while laws are learned.
#pragma once

#include <cstddef>

namespace host_sim::identification::thresholds {

/// [1] Share of the samples at each end of the range that no law is held to: 30 of 60 000.
inline constexpr double rarely_reached = 5e-4;
/// Samples that a range needs.
inline constexpr std::size_t fewest_samples = 100;
/// Points of a curve on each side of 0, the innermost point [rms of x] and how far beyond the range a point may stand.
inline constexpr int points_each_side = 7;
inline constexpr double innermost_point = 0.15, beyond_range = 1.02;
/// [decades] λ around the value at which penalty and data have the same trace.
inline constexpr double least_penalty = -8.0, largest_penalty = 4.0;
/// [χ²] A step of a curve that gains less ends the fit.
inline constexpr double curve_settled = 1.0;
/// Grid on which a family's exponent and width are searched before a fit moves them.
inline constexpr double exponent_step = 0.05, width_factor = 1.15;
/// [s] of recordings on which curves are compared before the whole is fitted.
inline constexpr double seconds_of_curves = 20.0;
/// Curves and families that are fitted on the whole.
inline constexpr std::size_t continued_curves = 4, fitted_curves = 3, fitted_families = 3;
/// Steps of a curve's fit and of a family's.
inline constexpr int curve_steps = 5, family_steps = 12;
/// [1] of stiffness × rms deflection: a force that matters.
inline constexpr double force_share = 0.1;
/// [1] Widest band of a curve, relative to that of noise alone: more is not known at all.
inline constexpr double widest_stretch = 30.0;
/// Measured points behind a curve in the report.
inline constexpr std::size_t points_shown = 600;
/// [ln] Odds are capped, so that they stay finite numbers.
inline constexpr double most_odds = 300.0;
/// [χ²/τ] by which a law must beat the effects it replaces, on fitted and on held-out windows.
inline constexpr double law_margin = 12.0, law_margin_held_out = 4.0;
/// [1] Where more than noise is left beside a law: share of what the effects leave on held-out data that it explains.
inline constexpr double law_explains = 0.25;

}  // namespace host_sim::identification::thresholds
