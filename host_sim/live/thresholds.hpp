// Every number that decides something in a diagnosis while the rig runs.
#pragma once

#include <cstddef>

namespace host_sim::live::thresholds {

// Blocks and windows ------------------------------------------------------------------------------------------------

/// [s] of samples that are scored together. Derivation: a window must begin within a tenth of the 5 s in which a fault
/// is to be named, so that few healthy samples dilute it, and a body mode of 1.5 Hz moves through a third of a period
/// in it, so that neighbouring scores are not one. What correlation is left the scale of a score holds (score_test.hpp,
/// 4). Half: twice the tests. Twice: up to half a second of a fault is lost.
inline constexpr double block = 0.25;
/// Samples on both sides of a block that its motion needs: differences of eighth order take four
/// (comparison/measured_motion.hpp), accelerations of these one more. Half: the motion at the ends of a block is wrong.
/// Twice: everything is 8 ms later.
inline constexpr std::size_t margin = 8;
/// Blocks of the longest window: the 5 s within which a fault is to be named. Half: a fault must be 1.4 times as large.
/// Twice: the same, smaller; but later than asked for.
inline constexpr std::size_t window = 20;
/// [s] of motion in which noise and sizes are found (identification/prepare), before anything is simulated. Derivation:
/// four times the shortest recording that a diagnosis takes. Half and twice: noise known to 1.4 times, 0.7 times.
inline constexpr double acquaintance = 10.0;
/// [s] after which a simulation that began at rest, while the rig moved, has forgotten it: exp(−ζωt) of a body mode of
/// 1 Hz at ζ = 0.2 is 2e-3. Half: 0.04, which the first blocks of the baseline hold. Twice: nothing more.
inline constexpr double run_in = 5.0;
/// Blocks of motion from which on the baseline is known well enough to test against. Derivation: with ν = 79 the
/// quantile of Student's t at the level below is 7.2, with ν = ∞ it is 6.2: a fault must be a sixth larger at most.
/// Half: 8.6. Twice: 6.6, after 20 s more.
inline constexpr std::size_t baseline = 80;

/// [1] of the noise of what drives the rig, by which it moves in a block that is tested. Derivation: noise alone is
/// 1 ± 0.05 of itself over 250 samples. Half: blocks of a rig at rest are tested, in which no cause but an offset shows.
/// Twice: motion is missed that shows friction.
inline constexpr double moves = 2.0;

// Names -------------------------------------------------------------------------------------------------------------

/// [1/h] False names, of all candidates together: one in 100 h, which is what is asked for. The level of a single test
/// is this rate divided by the tests in an hour, two-sided: candidates × windows × blocks (Bonferroni; windows that
/// share blocks make it smaller). 40 candidates: 0.01/(40 · 20 · 14 400) = 8.7e-10, 6.1 standard deviations.
/// Half, twice: 0.1 standard deviations.
inline constexpr double false_names_per_hour = 0.01;
/// [1] of the rise of the residual that a named cause explains at least: more than it leaves. Half: a cause is named
/// that leaves three quarters. Twice: nothing is named.
inline constexpr double least_share = 0.5;
/// [standard deviations] by which that rise may be overrated: one of 700 is, and weak faults rise little above noise.
inline constexpr double rise_doubt = 3.0;
/// [χ²] A cause that gains this much less is no rival: odds of 1000 to 1, as in a verdict (identification/assess), is
/// 2 ln 1000. Half: 32 to 1. Twice: 10⁶ to 1, and a fault is said with more rivals.
inline constexpr double rival = 13.8;
/// [χ²] A parameter of the description must explain this much more than an effect, as in a diagnosis of recordings
/// (identification/select): 2 ln 100. Half and twice: 10 to 1 and 10⁴ to 1; it decides where both do the same.
inline constexpr double described_value = 9.2;
/// Blocks that a fault lasts before it is named: a second. In the latest so many, at most half of its window, it must
/// still be there with half its size; a push from outside is over then. Half: a push is named that lasts half a second.
/// Twice: names come a second later.
inline constexpr std::size_t lasting = 4;

// Readings ----------------------------------------------------------------------------------------------------------

/// [s] Without a value a sensor is lost. Derivation: a controller bridges 20 ms and then stops a run that needs the
/// channel; a reader that drops datagrams does so for less. Half and twice: said so much sooner or later.
inline constexpr double lost = 0.5;
/// [s] and [standard deviations of what the model leaves]: a value that stood still so long, while the model moved so
/// far, is stuck. Derivation: with steps of a converter of q, what is left is q/√12 at least, so within a step the model
/// moves 3.5 of them at most; 6 is one of 10⁹ of noise. Half: a coarse converter is stuck. Twice: later.
inline constexpr double stuck = 0.25, stuck_move = 6.0;
/// [s] A gap up to this is bridged with straight lines and not compared, as recordings are (firmware/recording);
/// behind a longer one the simulations begin anew.
inline constexpr double longest_gap = 0.02;

}  // namespace host_sim::live::thresholds
