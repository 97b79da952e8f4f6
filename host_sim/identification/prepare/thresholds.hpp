// Every number that decides something while recordings are prepared.
//
// Each line of comment: unit; what it decides; where it comes from; what half and twice of it do.
#pragma once

#include <cstddef>

namespace host_sim::identification::thresholds {

// Length of recordings ----------------------------------------------------------------------------------------------

/// [s] A shorter recording is refused. Derivation: its fitted three quarters must hold two periods of a body mode of
/// 1.5 Hz between tapers of 0.25 s: (2/1.5 + 0.5)/0.75 = 2.4. A channel then has 330 residuals up to 90 Hz, against
/// some 20 parameters and states. Half: less than one period, so stiffness and start are not told apart. Twice: refuses
/// recordings of 3.5 s, of which several say as much as a long one.
inline constexpr double shortest_recording = 2.5;
/// [s] left out where a recording that is wholly held out begins in motion: of where it began, a lag of 65 ms forgets
/// all but 1 %, and hysteresis all but 1 % within two turns at 7 Hz. Measured: of the record mts_0A of ../shared/real
/// from 9 Hz on, which begins in full motion, x_act has an error of 8.8 % with its first 0.3 s and of 6.8 % without
/// (half: 6.8 %, twice: 6.9 %); the truth of the Bouc–Wen benchmark without the force of its hysteresis at the start is
/// off by 3.5 and 1.5 % of dz_b with them (two multisines), by 0.01 and 0.001 % without.
inline constexpr double forgets_start = 0.3;
/// [s] Fitted at most, of each recording. Derivation: standard errors fall with √T, time and memory grow with T; a
/// recording of an hour is to take some seconds and less than 300 MB. On 10 recordings of a bench with one effect (seed
/// 11), half and twice: the same names; the median error of an effect's parameter is 0.08 % with half, 0.03 % with
/// this, 0.014 % with twice, at twice the time.
inline constexpr double longest_fitted = 120.0;
/// [s] Held out at most, of each recording: a quarter, as of a short one. Half and twice: the same names on those 10
/// recordings.
inline constexpr double longest_held_out = 40.0;
/// One part in so many of a recording is held out at its end, as contract.md says.
inline constexpr std::size_t held_out_part = 4;

/// [s] Of a faster recording every n-th sample is kept. Derivation: what is compared ends at 90 Hz, and a simulation
/// with this step is exact to 4e-5 at 30 Hz. Half: noise √2 smaller at twice the time. Twice: 6e-4 at 30 Hz, which
/// shows.
inline constexpr double shortest_period = 1e-3;

/// [recorded rate] up to which interpolated samples are what was recorded (signal/interpolation.hpp). Half: loses half
/// of what a recording of 100 Hz says. Twice: beyond half the rate there is nothing.
inline constexpr double recorded_share_of_rate = 0.45;

/// [SI] A larger sample is refused. Derivation: 10⁸ squares of it, in units of noise down to 1e-20 of it, are below
/// 1.8e308. Half and twice: no difference.
inline constexpr double largest_sample = 1e100;

// Sample and hold ---------------------------------------------------------------------------------------------------

/// [samples per value] A channel that keeps each value for longer is held. Derivation: noise makes a chance repetition
/// of 16-bit values rarer than 1 in 1000, so 1 is a free-running channel; the fastest hold that shows is 2 samples or,
/// in turns of 1 and 2, 1.5. Half: every channel is held. Twice: holds of 2 samples pass for noise.
inline constexpr double held_samples_per_value = 1.5;

/// [steps] Median change of the values of a rounded channel that repeats them since it stays on a step. A channel that
/// is held moves by many steps, or its rounding does not matter. Half: none is. Twice: changes of 2 steps, a hold of a
/// coarse channel, pass for rounding where its instants are irregular.
inline constexpr double rounded_change = 1.5;

// Noise that is not as declared --------------------------------------------------------------------------------------

/// [ln] by which the estimates of two octaves may differ for the noise to count as white. Derivation: each scatters by
/// 1 to 2 % in 20 s; noise behind a filter of a third of the sample rate differs by 0.3. Half: a tenth of the good
/// channels stay as declared. Twice: noise of 90 Hz more or less passes for white.
inline constexpr double white_noise = 0.10;
/// [ln] up to which noise counts as declared, and from which the difference is a fault of the recording that is named.
/// The first is three times the scatter of the estimate; the second a person would mind. Half of the first: estimates
/// replace declarations for nothing. Twice: noise 10 % louder adds a fifth to the power, which counts as unexplained.
inline constexpr double noise_as_declared = 0.05, noise_named = 0.18;
/// [1] of a channel's rms about its mean: noise that nobody declared, of a channel whose spectrum is motion up to the
/// highest frequency, is not taken for less. Derivation: the simulation
/// with which the channel is compared is exact to 2e-4 of it (noise::simulation_error). Half: white noise of 1e-4, half
/// the error that is there, on a channel without noise. Twice: 0.8 µm on a tyre deflection of 2 mm rms, a sixtieth of a
/// good sensor's noise.
inline constexpr double model_exactness = 2e-4;
/// [1] Coherence of two channels above the motion that is driven, from which what is there is motion. Derivation: noise
/// is then less than a tenth of the power, and eight blocks of two independent noises reach a coherence of 0.9 in the
/// median of their lines never. Half: a channel loses noise of half its power there. Twice is no coherence.
inline constexpr double coherent_motion = 0.9;
/// [1] A declared noise is right to this factor either way: one standard deviation of its logarithm. What the samples
/// show outweighs it, since a level that counts as known is known ten times as exactly; coloured noise is wrong by no
/// more, since motion may look like it: what friction left of an acceleration at 333 Hz was noise behind 141 Hz, four
/// times as loud as declared. Half, twice: of white noise that is known to 10 % and ten times as loud as declared 1.9 %
/// or 0.5 % less is believed, instead of 0.8 %.
inline constexpr double usual_noise_factor = 3.0;
/// [1] Relative standard error of a level from which the spectrum does not tell noise from tails of corners.
/// Derivation: a power that is known to 20 % is off by less than what a missing effect adds. Half, twice: the same
/// names.
inline constexpr double noise_level_known = 0.10;

// The colour of noise ------------------------------------------------------------------------------------------------

/// [Hz] From here on a spectrum holds noise and the tails of corners, no motion that is driven; at low sample rates
/// from this share of the rate on. Derivation: as noise::highest_frequency. Half: roads up to 40 Hz and their leakage
/// are near. Twice: corners of 60 Hz leave a slope only.
inline constexpr double noise_begins = 90.0, noise_begins_share = 0.25;
/// [1 / sample rate] and up to here: a filter's zero at the Nyquist frequency says nothing.
inline constexpr double noise_ends_share = 0.49;
/// [Hz] and bands, below noise_begins, in which a channel must hold the noise that it is said to have: slower is drift.
/// Bands of 4 Hz, of lines of 1 Hz. And [1] how much more noise than power is too much: what a fit above 90
/// Hz says of 20 Hz is off by a factor of two. At 1.5 a digital filter was rejected for a level 8 % too high.
inline constexpr double slowest_noise_seen = 2.0, motion_spectrum_bands = 22.0, most_noise_of_power = 4.0;
/// [1] Share of its power to which the form of a low-pass is known at 0 Hz; at f it is this ÷ (1 − 2fT), since near
/// the Nyquist frequency there depends on what noise is between samples: until d of (2) is fitted. Derivation: noise
/// that is a value a sample and read a fortieth of a sample early has 0.88 of the power of (2) at 0.40/T, 0.77 at
/// 0.45/T, 0.5 at 0.48/T, so the share is 0.12, 0.24 and 0.6 there. At none such noise behind 73 Hz was noise of 1.8
/// times the level behind 54 Hz. Half and twice were not measured.
inline constexpr double form_known_to = 0.024;
/// [samples] How much sooner or later than it is renewed noise that is a value a sample may be read, and the standard
/// deviation of that: 0.022 to 0.049 were seen. Taken for none, a twentieth makes 98 Hz and 0.92 of the level of 93 Hz
/// of second order, and 80 Hz and 1.12 of the level of 93 Hz of first order. Where nothing is said of it, the corner of
/// a filter of first order at 250 Hz is known to 40 % and its filter not seen; half of the standard deviation leaves
/// levels 8 % off.
inline constexpr double latest_reading = 0.1, usual_reading = 0.03;
/// Bands of that range: 8 Hz at 1 kHz, half of the lowest corner's slope. Half: the colour of one noise is not said.
/// Twice: the same names.
inline constexpr double noise_spectrum_bands = 50.0;
/// [1] Power, relative to the lowest band, below which a filter leaves what rounding hides. Half and twice: 60 Hz of
/// an order of 4 are seen up to 190 Hz, or 170.
inline constexpr double least_filtered_power = 1e-4;
/// [1] Lowest corner, relative to the beginning: below, only the product of level and corner is seen.
inline constexpr double lowest_corner_share = 0.4;
/// [1] Half width of such a corner, relative to itself: it has no lower end.
inline constexpr double unseen_corner = 2.0;
/// Orders of low-passes that recorders and amplifiers have.
inline constexpr int highest_filter_order = 4;
/// [1] Share of the lowest power above the motion that is noise at least, where tails hide it. Half and twice: the
/// guess is replaced when the effect behind the tail was found.
inline constexpr double least_of_tail = 0.1;
/// [standard deviations of a band's power] above the lowest band that ChannelNoise::highest_level lies: the lowest of
/// 50 bands of one noise is 2.2 below it, so three leave a level alone that is right. At none a level behind a filter
/// was 11 % too low, and one of two clean recordings of a filtering recorder was called unexplained.
inline constexpr double highest_level_deviations = 3.0;
/// [1] Relative half width of a corner from which it is not named, and the relative distance of two corners that count
/// as one: a filter's parts differ by some per cent. The first was 0.3 as long as the instant of reading was taken for
/// known, with the same names at half and twice of both; since then a filter of 254 Hz of first order is known to 0.43.
inline constexpr double corner_known = 0.5, same_corner = 0.1;
/// [−2 ln likelihood] Price of a corner or a tail: as SelectionCriterion::parameter.
inline constexpr double colour_price = 10.0;
/// [−2 ln likelihood] Price of a corner that is not that of the other channels: a recorder's filters are alike, and a
/// tail is not exactly what (4) of noise_spectrum.hpp says. Half and twice: the same names.
inline constexpr double other_corner_price = 50.0;

/// Tails of a motion over white noise: an acceleration behind a low-pass of fourth order falls with n = 3, a position
/// with n = 5. Flatter ones are those of (4), or noise behind a filter; a steeper one ends within a few bands. A road
/// made of held noise falls faster by sin²x/x², so a floor may cost other_corner_price more than a colour.
inline constexpr int flattest_motion = 3, steepest_motion = 5;
/// [largest sample] Noise below it may be rounding: decimals of five digits round by 3e-6, floats by 2e-8.
inline constexpr double least_floor = 1e-5;

// Single samples -----------------------------------------------------------------------------------------------------

/// [standard deviations] of a sample from its neighbours from which it is an outlier. Derivation: 160 000 samples (20 s
/// at 1 kHz, eight channels) of normal noise whose scale is known to 10 % reach 5.85 once in a thousand recordings.
/// Half: 200 samples of noise are left out in each recording. Twice: outliers of 13 … 20 deviations stay in.
inline constexpr double outlier_deviations = 6.5;
/// [standard deviations] and that the farthest outlier of a channel must reach. Experiment: contacts of stops and free
/// play that last a sample stood up to 9.7 deviations off (tests/truth daq, seeds 100 and 110). Half: counts as
/// outliers what these leave. Twice: a channel with few outliers of 10 … 20 deviations keeps them.
inline constexpr double surest_outlier = 10.0;
/// [1] of a channel's largest |value|: how far an interpolation overshoots the limit at which the channel is cut off.
/// Derivation: a cubic through a corner of a sine 1.3 times the limit overshoots by 4 % at most with 20 samples a
/// period, so twice the distance to 1 only sorts more values, and half of it would do. And samples at the limit at
/// least: a value with nine digits comes again by chance in no recording.
inline constexpr double overshoot = 0.9;
inline constexpr std::size_t fewest_at_limit = 4;
/// [1] Least scale, relative to the median distance of a channel's samples from their median: an outlier below 2e-4 of
/// it is less than the simulation's own error (noise::simulation_error). Half and twice: no difference where a channel
/// has noise.
inline constexpr double least_outlier_scale = 3e-5;
/// [1] What samples beside an outlier leave at most, relative to noise. Derivation: a mean of six squares or more is
/// above 2.5² with a chance of 2e-6. Half: a third of the outliers are taken for motion. Twice: jumps of 20 deviations
/// count as outliers.
inline constexpr double quiet_beside_outlier = 2.5;
/// [standard deviations] by which an outlier must be likelier than a jump. Derivation: of an outlier of 6.5 deviations
/// the best jump explains a third at most. Half: the same names. Twice: outliers below 8 deviations stay in.
inline constexpr double no_jump = 4.0;
/// Outliers of a channel that stand alone, from which two side by side are no pulse but two of them. Half: one knock
/// and a short pulse suffice. Twice: in one of twelve recordings with five outliers two of them stay in.
inline constexpr std::size_t strikes_often = 3;
/// [1] and their size, relative to the median of those that stand alone: one cause makes outliers of one order. Half
/// and twice: the same names.
inline constexpr double alike_outliers = 0.5;
/// [1] Share of a channel's samples that are outliers at most: more is how the channel is. Half and twice: the same
/// names; recorders with one flipped bit in 300 samples are known.
inline constexpr double most_outliers = 0.01;
/// λ of sample_faults.hpp (8) from which outliers are motion. Derivation: each of ten channels is compared with nine,
/// so random ones are taken for motion in 90 · 2 e^{−2λ²} = 7e-4 of all recordings. Half: in half of them. Twice: a
/// hundred outliers at one place are needed, instead of 25.
inline constexpr double places_of_motion = 2.5;
/// [s] From this sample period on, a knock of the rig may be as short as a sample: an outlier must not show in another
/// channel. Derivation: contacts of steel last 1 to 5 ms. Half: one outlier in ten beside friction stays in. Twice: a
/// knock of 3 ms on a channel of 300 Hz counts as outlier.
inline constexpr double knock_length = 2e-3;
/// [standard deviations] of another channel from which it shows there.
inline constexpr double shows_in_another = 4.0;

/// [steps] Error of values that are rounded: text holds six digits, so a step of which a channel has a thousand is
/// written to a thousandth. Half: the same names. Twice: a fifth of the values of any channel are on any grid.
inline constexpr double grid_error = 0.05;
/// [1] Share of the distances that are multiples of the step. The rest is for rows that a recorder filled in itself.
/// Half and twice of the value itself: the same names.
inline constexpr double on_the_grid = 0.99;
/// Distances between different values from which a step is told: eight numbers are multiples of their lowest quarter
/// by chance once in 0.1⁻⁶.
inline constexpr std::size_t fewest_distances = 8;
/// [1] rms of rounding ÷ step: 1/√12.
inline constexpr double rounding_error = 0.2887;
/// [1] Share of a channel's noise that is rounding, from which the step is said. Derivation: as noise_named, where the
/// noise is declared: 1 − e^(−2 · 0.05) of the power is more than the estimate scatters. Half: said of recordings where
/// nobody sees it. Twice: steps of 1.8 standard deviations are not said.
inline constexpr double rounding_said = 0.10;

// Two sensors of the foot point ---------------------------------------------------------------------------------------

/// [standard deviations] of a band's power by which z_r and zdd_r contradict each other. Derivation: 13 bands, a normal
/// distribution: a chance of 1e-8 under noise. Half: 2 % of good recordings lose the fusion. Twice: an error of a
/// sensor must be √2 times as large to be noticed, since its power is compared. Both are derived, not measured.
inline constexpr double input_disagreement = 6.0;
/// [1] and by what share of the noise, since the declared noise is itself known to some per cent only. Half, twice: the
/// same names.
inline constexpr double input_disagreement_share = 0.1;
/// [1] A position says something of its motion up to the highest frequency whose power is so many times that of its
/// noise.
/// Derivation: a Welch estimate of 20 s scatters by 0.2, so 3 is not reached by noise. Half: noise passes for motion.
/// Twice: the same names.
inline constexpr double power_above_noise = 3.0;
/// [Hz] the bounds of that frequency: below, no rig is described by its foot point; above, nothing is whitened.
inline constexpr double lowest_known_frequency = 10.0, highest_known_frequency = 90.0;
/// [s] half length of the filter of smoothed_input.hpp, and [Hz] half the width of its edge (signal/kaiser.hpp),
/// 92/(14.4 · 2 reach). Half the length: an edge of ± 32 Hz. Twice: ends twice as long depend on how the signal was
/// continued.
inline constexpr double smoothing_reach = 0.1;
inline constexpr double smoothing_transition = 92.0 / (14.4 * 2.0 * smoothing_reach);
/// [standard deviations] of the noise: what is taken away from an input, at most. Derivation: 600 000 normal values
/// hold one beyond 6 with a chance of 1e-3. Half: no recording of 5 s passes. Twice: a step of the road passes that is
/// 24 times its noise, of which half is overshoot.
inline constexpr double smoothed_noise = 6.0;

// Units and signs -----------------------------------------------------------------------------------------------------

/// [s] of the middle of a recording that are simulated to check units, the first of them left out while the simulated
/// start decays (four periods of a body mode of 1.5 Hz leave e⁻⁶ at 20 % damping). Half and twice: the same names.
inline constexpr double unit_check_length = 12.0, unit_check_settling = 4.0;
/// [1] squared correlation from which a channel follows its simulation. Experiment: of 185 recordings of our own
/// generator (all groups, seed 1) none is refused, and each wrong unit is found (validation_test). Half and twice: the
/// same names.
inline constexpr double unit_check_correlation = 0.5;
/// [ln] distance from a unit's factor within which a factor is taken for it: e^0.35 = 1.4. Derivation: less than half
/// the distance between any two units (a factor of 9.8 at least). Half: a gain error of 20 % hides a unit. Twice: a
/// factor of 2, still no two units overlap.
inline constexpr double unit_factor_distance = 0.35;
/// [ln] and within which it certainly is that: 0.15 = 16 %, what parameters inside usual tolerances make of a channel.
/// A description that is 500 times too soft is 0.7 from a thousand. Half: a damping that is 10 % off lets millimetres
/// pass. Twice: nearly unit_factor_distance, so guesses are refused.
inline constexpr double unit_factor_certain = 0.15;
/// [1] factors between which a channel counts as right, or as right with the sign swapped: no effect of the catalogue
/// within its bounds makes more of it. Tuned on our own generator.
inline constexpr double lowest_right_factor = 0.4, highest_right_factor = 2.5;
/// [s] Of a shorter recording nothing is checked, since it will be refused for its length with a better message.
inline constexpr double shortest_validated = 1.0;

}  // namespace host_sim::identification::thresholds
