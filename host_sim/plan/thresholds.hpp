// Every number that decides something while an experiment is planned.
#pragma once

#include <cstddef>

namespace host_sim::plan::thresholds {

/// [standard deviations] from which an effect shows. Derivation: of some 60 effects that are not there, noise makes one
/// look like this in one of six recordings, so it shows and is not yet to be believed. Half: noise shows all the time.
/// Twice: what diagnose asks of an effect with one parameter (√40 = 6.3).
inline constexpr double shows = 3.0;
/// [standard deviations] at which effects are told apart, and that an effect must keep beside its nearest rival to be
/// named. Derivation: diagnose asks for 6.3; 10 leaves three standard deviations of luck and a tenth for what is not
/// linear. Half: named in one of ten. Twice: named always, at sizes twice as large as necessary.
inline constexpr double told_apart = 10.0;
/// [1] Relative error of a size. Half: one simulation more for each size. Twice: 10 % of a size.
inline constexpr double size_error = 0.05;
/// [1] Sizes are looked for within this factor of where a fit would start, and in so many simulations. Derivation: a
/// card's starts lie within a factor of 100 of what recordings show; from there as far again. Half and twice: no
/// difference for the rigs of host_sim/rigs.
inline constexpr double range = 1e4;
inline constexpr int most_trials = 12;
/// [1] Share of the start at which an effect with a corner counts as absent: its step has as many substeps there, and
/// what they change belongs to no effect.
inline constexpr double absent = 1e-4;
/// [1] Share of the start's significance below which an effect that is as small as it can be simulated counts as
/// absent. Half and twice: no difference for the rigs of host_sim/rigs.
inline constexpr double vanishes = 0.1;
/// [1] A rival that leaves less than this of an effect is the same effect for this experiment: no size tells them
/// apart. Derivation: the linear answer of a rival is off by some per cent of the effect where laws have corners.
inline constexpr double same = 0.03;

/// [1] Share of an effect that a rival leaves in its nearest size from which on its parameters are not fitted: it does
/// not look like the effect. Derivation: 0.8 is a correlation of 0.6. Twice: twice the fits.
inline constexpr double unlike = 0.8;
/// A rival's fit has so many steps at most, and ends where one gains less than this share of what is left (squared).
/// Derivation: what is left is asked for within size_error, twice it squared.
inline constexpr int refit_steps = 8;
inline constexpr double refit_gain = 2.0 * size_error;
/// The nearest rivals whose parameters are fitted. Half: misses the rival that bends most. Twice: twice the time.
inline constexpr std::size_t refitted = 4;
/// Sizes that are tried until a name is promised: what is left beside a rival that bends grows slower than the effect.
inline constexpr int promise_trials = 4;
/// A law that could imitate others is looked for where those leave a rest, and tests of a rest have no linear answer.
/// So diagnose is rehearsed with sizes that grow by this factor, so many of them at most; promised is the next one,
/// which leaves as much luck as told_apart does: 10/6.3.
inline constexpr double promise_step = 1.6;
inline constexpr int promise_steps = 5;
/// Rivals that are subtracted one after the other from a law before diagnose is rehearsed with it: with less than
/// `shows` beside them there is no rest to be found.
inline constexpr int subtracted_rivals = 3;
/// In so many recordings with other noise it must leave a rest: near its limit a test of a rest is luck.
inline constexpr int rehearsed_noises = 2;
/// [s] of the road that diagnose is rehearsed on at most; a longer one shows smaller sizes. Twice: twice the time.
inline constexpr double rehearsed_diagnosis = 32.0;
/// Number of rigs, at random ends of their tolerances, that must reach a limit or a clearance, too, before it is
/// promised. Half: a rig in three misses it, if one parameter decides. Twice: twice the time.
inline constexpr int rigs_within_tolerances = 4;

/// [1] Half width of the relative 95 % interval from which a parameter counts as open: ± half of its value. Half and
/// twice: other words for the same interval, which stands beside them.
inline constexpr double open = 0.5;
/// [1] Share of the largest entry below which a parameter is no part of an open combination.
inline constexpr double part_of_combination = 0.1;

/// [s] of a stationary road that stand for the whole, once it is half as long again. Derivation: 12 s of it are fitted,
/// ten periods of the slowest mode of a car, whose signatures have a scatter of √(2/20) = 0.3 in their squares, 15 % in
/// sizes. Half: twice that. Twice: twice the time.
inline constexpr double stretch = 16.0;
/// [s] Step of the rehearsals where friction, free play or stops act; diagnose steps twice as finely. Derivation: at 1 ms
/// friction is found 0.1 % too large (comparison/fine_steps.hpp), sizes are asked for to 5 %. Twice: a free play of some
/// micrometres is promised four times too large (paper_rig_fdva). A rehearsed diagnosis steps as the run that it looks
/// at was simulated: at 1 ms.
inline constexpr double step_with_corners = 0.5e-3, step_of_diagnosis = 1e-3;
/// [s] of another road that are rehearsed at most; of a longer one the beginning, and significances grow with √duration.
/// Derivation: a class B road has 50 periods of the slowest mode in it. Twice: twice the time.
inline constexpr double longest = 120.0;
/// [s] of the rehearsals that advice compares: what is compared is the same road. Half: the least that diagnose takes
/// with its held-out quarter. Twice: twice the time.
inline constexpr double advice_duration = 16.0;
/// [1] Gain of one effect that counts at most, either way: advice that makes one effect visible and no other is not
/// better than advice that helps all.
inline constexpr double most_gain = 10.0;
/// [1] from which advice is worth a sentence.
inline constexpr double worth_saying = 1.1;
/// Rivals of an effect that are listed at most.
inline constexpr std::size_t most_rivals = 8;

}  // namespace host_sim::plan::thresholds
