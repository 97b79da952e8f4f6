// Every number that decides something while parity relations are checked.
#pragma once

#include <array>
#include <cstddef>

namespace host_sim::identification::thresholds {

/// [s] Blocks of the spectra, half overlapping: lines of 0.5 Hz, the lowest band has two. Half: the lowest band has
/// one. Twice: half as many blocks. Half and twice: the same names on 12 recordings of 800 s (bench, seed 11).
inline constexpr double parity_block = 2.0;
/// [s] of each recording that is checked. Derivation: 120 blocks; a relation that holds on them holds. Half and twice:
/// the same names on 12 recordings of 800 s (bench, seed 11).
inline constexpr double parity_length = 120.0;
/// [s] left out at the beginning of a recording, since the component's start is unknown: its slowest state of our rigs
/// decays with 0.2 s. Half: e⁻⁵ remains. Twice: 2 s less data.
inline constexpr double parity_settling = 2.0;
/// [1] Relative error of a relation's largest term that is not looked into: differences, interpolation, the B-spline's
/// leakage (1e-4 of a second derivative at 25 Hz). Half and twice: the same names.
inline constexpr double parity_model_error = 1e-3;
/// [Hz] Edges of the bands; smooth windows pass nothing above the last.
inline constexpr std::array<double, 12> parity_band_edges{0.5, 1.0,  2.0,  3.0,  4.5,  6.5,
                                                          9.0, 13.0, 18.0, 26.0, 40.0, 60.0};
inline constexpr std::size_t parity_bands = parity_band_edges.size() - 1;
/// [standard deviations] of a band's power beyond noise, and share of the noise, from which a relation fails.
/// Experiment: over 30 rigs without any effect (tests/truth, groups none, seeds 1 … 10) no relation reached 4. Half: at
/// the edge of these. Twice: the same names. Tuned on our own generator.
inline constexpr double parity_significance = 8.0, parity_share = 0.15;
/// [1] Relative change of the component's parameters below which the fit of a relation has converged, and its most
/// steps.
inline constexpr double parity_converged = 1e-3;
inline constexpr int parity_steps = 4;
/// [1] Difference for the derivative of the component's force to one of its parameters.
inline constexpr double parity_difference = 0.01;

/// [1] Share of the squared excess that the likely fault location may leave unexplained; and by how much a location may
/// be worse than the best and still be named beside it; and how many are named at most. Experiment: of 52 single
/// effects in a car (tests/truth, seed 1) 46 are placed right, two of them with a twin. Half and twice: the same names.
/// Tuned on our own generator.
inline constexpr double location_leaves = 0.1, location_equal = 0.02;
inline constexpr int most_locations = 3;

/// [1] Shares of a residual's power from which a description says that it follows the motion linearly, or goes with a
/// law beyond that. Half: two laws are said where one acts. Twice: nothing is said of most. By eye, on our own
/// generator.
inline constexpr double described_linear = 0.3, described_law = 0.2;
/// [ln²] Variance of the logarithm of the motion from second to second from which its power law is said; and the factor
/// between first and last third from which a drift is said. By eye, on our own generator.
inline constexpr double described_variation = 0.02, described_drift = 1.6;

// An event (disturbed_span.hpp) ---------------------------------------------------------------------------------------

/// [s] Blocks in which a relation's residual is looked at, and how many times the median block it must exceed.
/// Derivation: 10 samples of noise at 1 kHz, smoothed over 5 ms, have an rms within 2 of its median in all of 10⁴
/// blocks; 4 is a push of four times the noise. Half of the factor: a loud road marks blocks. Twice: the ends of a soft
/// push are cut.
inline constexpr double span_block = 0.01, span_deviations = 4.0;
/// Quieter blocks inside an event: a relation that is differentiated twice shows a push at its two ends alone when it
/// is soft; 0.1 s. Half: a push of 0.4 s becomes two. Twice: two knocks become one.
inline constexpr std::size_t span_gap = 10;
/// [1] Less than this share of the power of the loudest run is what the relation is wrong by while the rig still moves:
/// of a push that left a motion of its own size for thirty times its own length, a relation that is 3 % wrong leaves
/// 30 · 0.03².
inline constexpr double span_share = 0.03;

}  // namespace host_sim::identification::thresholds
