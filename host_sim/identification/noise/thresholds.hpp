// Every number that decides something while residuals are whitened.
#pragma once

#include <cstddef>

namespace host_sim::identification::thresholds {

/// [1] Variance of the channel that moves most, in units of its noise, below which a recording is refused: 1.25 is a
/// motion of half of the noise. Of such a recording no error can fall by more than a tenth, and effects that are as
/// large as the signals passed for named ones where a rig stood still. Half of what is beyond 1, 12 %: the noise's
/// level may be off by 5 %. Twice: a motion of 0.7 of the noise is refused.
inline constexpr double least_motion = 1.25;
/// [Hz] Residuals are compared from 0 up to here: roads, guides and dampers act below 30 Hz, a tyre's wheel hop is at
/// 12 Hz, and lags and delays of sensors still show. Half: lags of 1 ms are hardly told from delays; the
/// same names, in 0.7 of the time. Twice: twice the residuals, mostly noise; the same names.
inline constexpr double highest_frequency = 90.0;
/// [1 / sample rate] and not above this share of the sample rate, where a recorder's own filter ends.
inline constexpr double highest_share_of_rate = 0.45;
/// [Hz] Width of the bands in which the covariance of the noise is one matrix. Derivation: the resonances that carry
/// the input's noise are 2 Hz wide and more (20 % damping at 5 Hz). Half: half the lines for each estimate. Twice: the
/// same names.
inline constexpr double covariance_band = 1.0;
/// [1] Noise of an integrated acceleration in the lowest band, where it is larger than that of any sensor: the gain of
/// one band is its mean, and 1/(1 − (f/f_b)²) of a body mode of 1.5 Hz is 1.8 at 1 Hz, 3.2 in power. With 1, two clean
/// rigs of two are flagged below 1 Hz (zdd_r without z_r, tests/truth none:quarter_car, seeds 1 and 2), with 3.2 none;
/// introduced after seeing these two. Half: the same names. Twice: they, in another order.
inline constexpr double integrated_noise_in_lowest_band = 3.2;
/// [1] Error of the simulation itself, relative to each channel: velocities by differences of fourth order, (ωh)⁴/30 =
/// 4e-5 at 30 Hz and 1 kHz, and linearly implicit parts. Measured against tests/support's reference: at most 2e-4
/// (simulation_test). Half: the same names, in another order. Twice: the same names; without it a recording without
/// noise has an infinite χ².
inline constexpr double simulation_error = 2e-4;
/// [1] of what a recorder's low-pass takes away that a hypothesis with this low-pass may get wrong. Derivation: the
/// analogue and the digital filter of one corner differ by 8 % of their delay at 150 Hz and 1 kHz, and corners of the
/// motion pass either as no straight line between samples. With 0 the masses of two cars with free play behind a filter
/// of fourth order were 0.02 % off, outside of their intervals (rigtwin_confusion --rough 20261228, looked at).
inline constexpr double filter_error = 0.1;
/// [s] Cosine taper at each end of a window. Derivation: slow motion must not leak into fast bands where
/// noise is small; a period of 4 Hz is short against the shortest window (2 s). Half: beside two effects that are
/// right a law without a shape, in one of four recordings. Twice: the same names.
inline constexpr double taper_length = 0.25;
/// [1] Least share of a held channel's noise power where sinc² has its zeros: no renewal is exact. Half and twice: the
/// same names.
inline constexpr double least_held_noise = 0.05;
/// [1] Least share of a filtered channel's noise power above the filter's corner: the filter acts on the signal, too,
/// which the simulation does not know. Half and twice: the same names.
inline constexpr double least_filtered_noise = 0.05;
/// Simulations with seeded input noise that one covariance is estimated from. Derivation: the coherent part is scaled
/// to the known density of the input's noise, so only the incoherent part scatters, by 1/√(3 lines of a band). Half (2)
/// and twice (6): the same names; the time of the noise step is proportional to it.
inline constexpr int noise_realisations = 3;
/// [1] Of the level of white noise that was read off the samples, the level in what a model leaves from which this is the
/// noise: the rest of the first was motion. Derivation: 5000 samples say the level within 2 % (1/√(2 · 1500) and the
/// median), a tenth is four of these. Half and twice of the distance to 1: refits for nothing; no difference, motion in
/// the highest third of the frequencies makes factors.
inline constexpr double quieter = 0.9;
/// [samples] A stretch of a recording that is whitened by itself has so many that were recorded, at least. Derivation:
/// a taper of a quarter at each end leaves eight, and the lines of five frequencies between 0 and half the rate. Half:
/// three. Twice: at 10 Hz what changes within three seconds is one.
inline constexpr std::size_t shortest_whitened = 16;
/// [samples] A shorter window has no covariance.
inline constexpr std::size_t shortest_covariance_window = 16;

/// [standard deviations] of a channel's noise that a step of what is read is large: a knock. Derivation: a
/// sample on the wrong side of it is worth (step/σ)²/5 in χ², 0.18 of its power being below 90 Hz: 7 at 6 σ, as much as
/// an effect costs. Half: more samples are left out. Twice: samples worth up
/// to 29 stay.
inline constexpr double knock = 6.0;

}  // namespace host_sim::identification::thresholds
