// The numbers that decide in this room. Each says what it decides, where it comes from, and what half and twice do.
#pragma once

#include <array>
#include <cstddef>

namespace host_sim::replicate::thresholds {

/// [s] of motion before and after the target. An inverse is not causal: the drive begins before the target does.
/// Derivation: a body mode of 1.5 Hz with 20 % of critical damping keeps 2 % after 2 s. Half: 15 % of it is left in the
/// first second of the target; twice: nothing changes but the length of the run.
inline constexpr double lead = 2.0;

/// [s] from one event of a target to the next, in which both fade. As `lead`, for the same reason.
inline constexpr double blend = 2.0;

/// Half width of the edges of a band, relative to their frequency: a band with sharp edges rings as long as the target
/// is. At 10 % the ringing is over after 10 periods of the edge. Half: 20 periods; twice: a fifth of an octave of
/// target is judged that is replicated by half.
inline constexpr double band_edge = 0.1;

/// [Hz] Below this no band begins by itself: an acceleration of 0.05 m/s² of noise or drift asks there for 5 mm of
/// stroke or more, and a displacement drifts. --band asks for more.
inline constexpr double lowest_frequency = 0.5;

/// Power of a target's spectrum over that of its sensor's noise above which it is replicated. Derivation: at 4 the part
/// of the error that is noise of the target is half of the target.
inline constexpr double above_noise = 4.0;

/// Of the largest |H|² within an octave: regularisation of the inverse at an antiresonance, where a drive would grow
/// without bound. The iteration takes up what it leaves; half and twice were not measured.
inline constexpr double inverse_floor = 1e-4;

/// [s] length of the pieces of a drive that have secants of their own; their distance is half of it. It must be longer
/// than what an inverse from 0.7 Hz on smears, 2 s. Error on the model after 150 rounds, two rigs with friction and a
/// stop (20 s, 0.7 to 40 Hz): pieces of 0.5 s 3.2 and 15 %, 1 s 1.5 and 5.5 %, 2 s 0.4 and 4.0 %, 5 s 0.1 and 1.6 %, 20
/// s 0.06 and 0.6 %; of 60 s with pieces of 20 s 1.6 %, with one piece 1.3 %.
inline constexpr double piece = 20.0;

/// Secants that are kept. 20 find nothing more than 10.
inline constexpr std::size_t secants = 10;

/// Of the diagonal of the secants' normal equations, each scaled to 1. Keeps them solvable; other values
/// were not compared.
inline constexpr double ridge = 1e-4;

/// A solution ends when its best error fell by less than `least_gain` in `patience` rounds. With a patience of 5 rigs
/// with stops end at two to five times the error: a piece may fail several times before it gets on.
inline constexpr double least_gain = 0.02;
inline constexpr int patience = 40;
inline constexpr int most_rounds = 150;

/// Error on the model below which a solution is exact: a tenth of what the sensors of a rig leave of a target of 4 m/s²
/// in 40 Hz.
inline constexpr double exact = 5e-4;

/// A piece that failed so often takes what it has for its best: its neighbours have changed since.
inline constexpr int most_failures = 3;

/// [s] length of the pieces of a drive that choose their share of a step each. A corner spoils the piece that it is in
/// and the next. Error on the model, 6 s, two rigs with friction, a stop and free play: 80 ms 3.6 and 5.2 %, 125 ms 3.5
/// and 1.6 %; an earlier form of the iteration had 1.9 and 2.8 % with 125 ms and 3.4 and 3.5 % with 250 ms.
inline constexpr double choosing_piece = 0.125;

/// Shares of a step that a piece of the drive may take.
inline constexpr std::array<double, 5> shares_of_step{1.0, 0.6, 0.3, 0.1, 0.0};

/// Pieces behind that count when a piece chooses. Error of the two rigs above with one 5.4 and 3.0 %, with two 2.3 and
/// 3.0 %; at another cost of the drive with two 3.5 and 1.6 %, with three 4.0 and 3.9 %.
inline constexpr std::size_t pieces_ahead = 2;

/// A run that costs more than the best one by this factor is not gone on from. Pieces are better one by one before all of
/// them together are: what a knock does to the next is set right an iteration later.
inline constexpr double borne_cost = 1.5;

/// Costs of a drive: of what it makes where the band shows least of it, by position and by acceleration. They are the
/// relative errors by which the regularised solution is off there; elsewhere in the band it is off by orders of magnitude
/// less, and (2) of solve_along_trajectory makes up for both. With a tenth of the acceleration's cost the drive chatters
/// against corners, which the limit of acceleration then takes back.
inline constexpr double position_cost = 3e-4;
inline constexpr double acceleration_cost = 2e-2;

/// Excess of the force, ÷ its limit, that costs as much as an error as large as the target.
inline constexpr double force_excess = 0.01;

/// Rounds on the rig without its corners: its only nonlinearities are losses and springs, and one round nearly solves it.
inline constexpr int smooth_rounds = 2;

/// Iterations along the trajectory end when the best cost fell by less than `least_gain` in each of
/// `iteration_patience`, or after `most_iterations`.
inline constexpr int iteration_patience = 4;
inline constexpr int most_iterations = 24;

/// Rounds that make up for what the tracking leaves out, and iterations in each.
inline constexpr int outer_rounds = 4;
inline constexpr int rounds_of_outer = 3;

/// Where the solution without limits goes beyond one and the limits cost more than the factor `little_cost`: so many
/// rounds with the limits in the cost, then the multipliers move on.
inline constexpr double little_cost = 1.2;
inline constexpr int rounds_of_limits = 2;
inline constexpr int rounds_of_multipliers = 3;

/// Error on the model above which secants have not found the drive, and the rig is solved along its trajectory: four
/// times slower.
inline constexpr double secants_fail = 0.03;

/// Corners are at these shares of their forces for some rounds each, before they are sharp.
inline constexpr std::array<double, 2> corner_shares{0.2, 0.5};
inline constexpr int rounds_of_share = 15;

/// Rounds of a projection onto the limits; the multipliers go on from drive to drive.
inline constexpr int limit_rounds = 15;

/// Share of each limit that a drive may use: the guard of the controller acts at the whole, and an answer is not the
/// prediction.
inline constexpr double usable_limit = 0.98;

/// A run whose error is larger than that of the best run before by more than this share of it came out worse: two runs
/// of one drive differ by their noise. An estimate, not measured.
inline constexpr double worse = 1.05;

/// A gain between runs below this share of the error is none: what is left is the floor.
inline constexpr double significant_gain = 0.1;

}  // namespace host_sim::replicate::thresholds
