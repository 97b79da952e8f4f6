// Every number that decides something while parameters are estimated.
#pragma once

namespace host_sim::identification::thresholds {

// Free parameters -----------------------------------------------------------------------------------------------------

/// [coordinate] Differences for the Jacobian: 1 % of a tolerance; 0.1 % of an effect's parameter or of the motion's
/// size. Derivation: the truncation error, half of the step's share of the curvature, stays below a per cent. Half: the
/// same names. Twice: 1 % error of the Jacobian where a stop closes (fit_test), which costs steps, not accuracy.
inline constexpr double tolerance_difference = 1e-2, effect_difference = 1e-3, start_difference = 1e-3;
/// [coordinate] Trust radius of a state at the start: three times the motion. And its bounds. Half and twice: the same
/// names.
inline constexpr double start_trust_radius = 3.0, start_bound = 10.0;
/// [coordinate] Trust radius of an effect's parameter: a factor of e, or twice a signed value. Half and
/// twice: the same names.
inline constexpr double effect_trust_radius = 1.0;
/// [1] Range up to which a number without unit is a shape, and the share of it that is the scale of its coordinate:
/// where it is near neutral, a step may still change it by as much. Half and twice of the share: one step more or less.
inline constexpr double range_of_shape = 10.0, shape_scale = 0.02;
/// [1/s] Velocity at the start for one metre of motion: a mode of 3 Hz.
inline constexpr double start_rate = 20.0;
/// Lowest coordinate of a positive parameter without a lower bound of its own: e⁻¹² = 6e-6 of its start.
inline constexpr double lowest_logarithm = -12.0;
/// [1] A tolerance of 1 and more leaves a parameter this share of its value at least: it does not change its sign.
inline constexpr double least_share_of_value = 1e-3;

/// [1] A described parameter is at most so many times too large or too small: more is a wrong unit, which unit_check
/// says.
inline constexpr double parameter_range = 3.0;

/// [standard deviations] Differences for the last Jacobian of a rig with corners. Derivation: within a standard
/// deviation the data do not tell two rigs apart, so that hardly a corner falls into another sample. Measured: twice
/// and half give the same minimum (drift:2026122802); a tenth the same, 1 % of a tolerance, which is ten of them, one
/// that is 17 higher in χ².
inline constexpr double corner_difference = 0.5;

// Lower minima beside a fit (lower_minimum.hpp) -----------------------------------------------------------------------

/// Rounds of four tries, and steps of each. Half of the rounds: of a rig with free play (rough:no_road:2026122902) the
/// minimum is missed. Twice: twice the time.
inline constexpr int lower_rounds = 6, lower_steps = 6;
/// Jacobians of one descent at most; the second gains a few in χ², the third nothing.
inline constexpr int slope_rounds = 3;
/// [χ²] Where all tries of a round end as near, the valley is smooth and there is nothing to be found. Derivation: a
/// smooth valley is found again to 0.01; a residual that jumps is worth tens.
inline constexpr double smooth_valley = 1.0;

// Faults of the recording (predict/recording_faults.hpp) --------------------------------------------------------------

/// [s], [1] Scales of a clock's offset and rate, of which a fit moves as far in its first step: 2 ms are a phase of 1
/// rad at 80 Hz, where a linear step still helps; 100 ppm shift the end of 20 s by as much. And their bounds: 50 ms is
/// the delay of a network, 2000 ppm the error of the worst RC oscillator. Half and twice of the scales: the same names.
inline constexpr double offset_scale = 2e-3, rate_scale = 1e-4, largest_offset = 50e-3, largest_rate = 2e-3;
/// [Hz] Corners of a filter. Below the lowest it is a sensor's lag; above the highest 90 Hz, the end of the residuals,
/// is left as it is within a phase of 0.1 rad.
inline constexpr double lowest_corner = 10.0, highest_corner = 900.0;
/// [Hz] Scale and bound of what hum is off the mains' nominal frequency: grids keep ± 0.2 Hz in operation, ± 0.5 Hz
/// before they shed load.
inline constexpr double hum_scale = 0.01, hum_range = 0.5;
/// [1] Scale and bound of a drift over the recording: a parameter that loses nine tenths does not drift, it breaks.
/// And of its curvature κ = T/time constant: at 20 it is over in the first eighth of the recording.
inline constexpr double drift_scale = 0.1, largest_drift = 0.9, largest_curvature = 20.0;
/// [coordinate] Difference for the Jacobian: 1 % of each scale, as of a tolerance.
inline constexpr double fault_difference = 1e-2;

// Learned laws (predict/placed_law.hpp) -------------------------------------------------------------------------------

/// [coordinate] Difference for the Jacobian of a law's values: a thousandth of its largest force, as of an effect.
inline constexpr double law_difference = 1e-3;
/// [1] Bound of a law's force, relative to its size where the fit began: a law that grows by more has found another
/// explanation. Half and twice: the same names.
inline constexpr double largest_law_force = 50.0;
/// [largest deflection] A learned lost motion is no smaller. Derivation: beside the stroke it is nothing, and a stack
/// without it is tried, too. Half and twice: no difference.
inline constexpr double narrowest_gap = 1e-3;

// What a fit leaves ---------------------------------------------------------------------------------------------------

/// [standard deviations] of a channel's power in a band beyond its noise, on fitted and on held-out data, from which it
/// counts as more than noise. Derivation: 13 bands × 7 channels, so noise reaches 4 in one of 300 recordings; 8 leaves
/// room for noise that is known to some per cent. Half: the share below decides alone. Twice: an effect of 100 standard
/// deviations that is spread over all bands (100/√91 each) still passes for noise. Derived, not measured.
inline constexpr double significant_deviations = 8.0;
/// [1] and by what share of the noise: the simulation's own error stays below it, without corners. Half and twice: the
/// same names.
inline constexpr double significant_share = 0.15;

/// [1] A recording of noise alone is said to leave more than noise once in a thousand. Half and twice: the limit of z
/// moves by 0.15 of 4.7.
inline constexpr double family_error = 1e-3;
/// Stretches of time that are tested, and the shortest [s]: half a period of the slowest band must fit.
inline constexpr double stretches = 8.0, shortest_stretch = 2.0;
/// Residuals that a test needs: fewer are no band.
inline constexpr double fewest_tested = 6.0;
/// [1] Least error of the variance of a channel's noise.
inline constexpr double noise_variance_error = 0.01;
/// [1] Error of a residual's variance where noise of the input blurs corners of the model. Recordings of 20 s of
/// tests/truth with friction that was named right left 1.1 to 2.8 times their noise in F or zdd_w (6 of 9). Half: 4 of
/// those are flagged. Twice: none.
inline constexpr double corner_power_error = 1.0;
/// Stretches of time in verdict.json and report at most.
inline constexpr double most_seconds_shown = 240.0;

// Intervals and what is left open -------------------------------------------------------------------------------------

/// [s] Shortest block of residuals, and blocks at most: longer than residuals stay alike (a mode of 1 Hz with 20 %
/// damping forgets in 0.8 s), and as many as give Student's t a few per cent. Half and twice of the block:
/// the same names. Of the number: the same names on 12 recordings of 800 s (bench, seed 11).
inline constexpr double shortest_block = 1.5, most_blocks = 30.0;
/// [1] χ² per residual from which bands are held against each other. Below, noise alone would widen what one or two
/// bands determine by Student's t of one or two. Half and twice of the value itself: the same names.
inline constexpr double model_is_wrong = 1.2;
/// [1] Relative standard deviation of a combination of parameters that the data leave open. Half and twice: the same
/// names.
inline constexpr double undetermined_deviation = 0.3;
/// [1] Smallest entry of a null vector that is said, of its largest; entries that differ by less are in one ratio.
inline constexpr double least_entry = 0.1, alike_entries = 0.1;

// The virtual car of a hil rig ----------------------------------------------------------------------------------------

/// [1] A tyre law is listed where it takes away this share of the power that a linear tyre leaves. Derivation: the
/// numbers are exact up to their differences, so a real law takes away nearly all. Half and twice: no difference
/// where a cubic law takes away over 99 %, as in virtual_car_estimate_test and our own generator.
inline constexpr double law_takes_away = 0.5;
/// [1] and moves F_w by this share of its rms: five times what velocities by differences leave.
inline constexpr double law_moves = 1e-3;
/// [1] Rounding of the sums may be this share of the variance of a law's parameter. Derivation: the share by which
/// the interval may be wrong. Half and twice: the same laws, as deflections tell a cubic law from a line by 1e-1 or,
/// where they stand still, by rounding alone.
inline constexpr double rounding_share = 1e-3;
/// Lowest values of F_w that are equal as written, from which a wheel flew; and the distance of that value from the
/// bound of the law [1]. Two equal samples happen by rounding. Half and twice: the same names.
inline constexpr int equal_lowest_loads = 4;
inline constexpr double lift_off_distance = 0.05;
/// Neighbouring samples of the tyre's residual are off alike (differences over five samples): one in so many counts.
inline constexpr double correlated_samples = 10.0;
/// [1] Relative difference to a described value without a tolerance from which a parameter is off. Derivation: half a
/// unit in the third digit of 100; nobody describes a rig more exactly. Half: a drift of the stiffness by 10 % left
/// 0.04 % of the damping, 15 standard deviations, which this must not name either. Twice: an error of 1 % would have no
/// name.
inline constexpr double rounding = 0.005;
/// [1] Share of what the equations of the virtual car leave that the right numbers may leave: they are exact, so less
/// than a millionth is left. Half and twice: the same, where a mass is off by 8 % and leaves 1e-6.
inline constexpr double freed_number_leaves = 0.1;
/// [1] What velocities by differences of fourth order are off, relative to the values estimated from them.
inline constexpr double difference_error = 3e-5, law_difference_error = 1e-4;

/// [1] A factor on a reading is sought up to this and down to its inverse. Derivation: a half bridge in the place of a
/// full one is 2; what is further is a wrong unit, a sign or another signal, which prepare/unit_check names. Beside a law
/// that is not known, a factor of 0.02 or 90 makes a channel say nothing, and every model fits.
inline constexpr double largest_factor = 3.0;

}  // namespace host_sim::identification::thresholds
