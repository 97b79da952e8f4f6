// Every number that decides something while a model is selected. The penalties stand in selection_criterion.hpp.
#pragma once

#include <cstddef>

namespace host_sim::identification::thresholds {

// The search --------------------------------------------------------------------------------------------------------

/// Effects of one model at most. The criterion ends a search, after five effects where five hide (tests/truth, many);
/// this only bounds its time. Half: a fifth effect is never found. Twice: no difference expected.
inline constexpr std::size_t most_effects = 8;
/// [standard deviations] of χ², in a band or altogether, up to which a model leaves nothing but noise: one more effect
/// is looked for beside the best model alone, and no further minimum. Derivation: 91 bands and channels under noise
/// reach 4 in one of 300 recordings. It is no proof that nothing is left: an effect that gains 300 of χ² in all may
/// show in no band. Half: in two of three recordings twice the candidates, for nothing. Twice: a second minimum is not
/// looked for. Derived.
inline constexpr double leaves_noise = 4.0;
/// [χ²] by which another candidate must be better to replace an effect: above the solver's own 0.01 and below what any
/// parameter costs. Half and twice: no difference expected.
inline constexpr double replaces = 1.0;
/// [χ²] by which an effect at a limit of its law may be better than the parameter that does the same and still is that
/// parameter. Derivation: 2 ln 20, odds that count as not told apart (assess/thresholds.hpp). Half and twice: odds of
/// 4.5 and of 400; equal causes differ by less than 1.
inline constexpr double tie = 6.0;
/// [1] Of what simpler effects leave beyond noise, the most that a law with a shape of its own may leave, and how much
/// less of χ² than in the fitted windows it may explain in the held-out ones. Derivation: a table of 33 points follows
/// a power of 3 within some per cent of the force at its ends, some 1e-3 of the power; an effect that is missing beside
/// it leaves more than a fiftieth where it can be named at all: what a step or a table gets wrong about a strong law is
/// a rest, and still the law.
inline constexpr double nearly_all = 0.02, held_out_like_fitted = 2.0;
/// [1] A value this near to a bound of its card stands at it: a fit stops there, up to rounding. Half and twice: no
/// difference.
inline constexpr double at_bound = 1e-3;
/// [χ²] What a late sensor costs beyond another cause. Derivation: every machine is late and few sensors are, 10 to 1:
/// 2 ln 10. It decides where both do the same.
inline constexpr double late_sensor = 4.6;
/// [1] Power of a ripple over the travel, relative to the median of all periods, from which it is a candidate.
/// Derivation: under noise 255 independent periods have powers of an exponential distribution; one of 250
/// recordings has one above 16 medians. Half: nearly every recording has a candidate, which costs time and no verdict.
/// Twice: a ripple must be 1.4 times as large.
inline constexpr double ripple_prominence = 16.0;
/// Bins between half of a channel's largest |value| and the largest, in which a limit behind a filter is looked for.
/// Derivation: 1 % wide, less than a fit bridges and more than a rounded top is uneven. Half and twice: starts that
/// differ by 1 %. Derived, not measured.
inline constexpr std::size_t top_bins = 50;
/// [1] How much more often the most frequent top comes than the others. Derivation: |value| of a Gaussian process falls
/// with height, and a limit that cuts off 4 % of the time holds six times what a bin beside it does. A sine of one
/// amplitude, which spends 9 times as long in the last bin, is a candidate, too, and that costs no simulation. Half and
/// twice: limits that cut off 2 %, or 8 %, of the time.
inline constexpr std::size_t top_prominence = 6;
/// [1] of a channel's noise: two samples nearer than this stand still. Derivation: of white noise 2.8 % of neighbours
/// do, behind a low-pass of a tenth of the sample rate 7 %, while behind a limit all do but those just after it was
/// reached; half of them is asked for. Half and twice: the same verdicts on the recording of fault_candidates_test.
inline constexpr double still = 0.05;
/// [1] Periods of a ripple in the range of travel, at most. Derivation: the teeth of a motor, 72 a turn, over three
/// turns. Half: the cogging of a motor over two turns is found. Twice: twice the time of (1) in ripple_period.hpp.
inline constexpr double most_ripples = 256.0;
/// Samples in which it is looked for: the power of a ripple as large as the noise is then some 5000 medians. Half and
/// twice: no difference, half and twice 10 ms.
inline constexpr std::size_t ripple_samples = 20'000;
/// Rounds of elimination and swaps at most: each round that changes something lowers the criterion, so it ends anyway.
inline constexpr int most_rounds = 4;
/// [1] Of the promise that makes an effect worth its penalty, the share from which a candidate is fitted: promises are
/// linear and may be three times too low. Half: twice the fits. Twice: the same names.
inline constexpr double promising = 1.0 / 3.0;
/// [1] and the share of the best promise below which no more than `always_fitted` candidates are fitted.
inline constexpr double promising_beside_best = 1.0 / 3.0;
inline constexpr std::size_t always_fitted = 3;
/// [1] share of the best start's promise from which a second start is fitted, too.
inline constexpr double second_start = 0.3;
/// Rivals that are fitted again beside the others as they are now; and the share of what the effect explains that they
/// must explain to be. The others are further away than a few steps would bring them.
inline constexpr std::size_t near_rivals = 2;
inline constexpr double rival_explains = 0.3;
/// Simpler effects of the same part of the rig that are tried in the place of an effect, and the second ones that are
/// fitted beside each. One part has few: half is the nearest alone, twice are all.
inline constexpr std::size_t split_effects = 2;
/// [χ²] A rival that is further away in the fitted windows, three times the held-out ones, cannot come closer in these:
/// of a rival 200 away they say 67 ± 2√67 more. Half: close calls are judged on the fitted windows alone. Twice: more
/// simulations for the same names. Derived.
inline constexpr double beyond_held_out = 200.0;
/// Rounds of golden section for the phase of a hold's clock: 0.618¹⁰ = 1 % of what the renewals allow.
inline constexpr int clock_rounds = 10;
/// [1] Growing shares of the fitted windows in refit_by_continuation(): from a tenth (one or two periods, few minima)
/// on, each 1.4 to 1.6 times the last. Tuned on our own generator (bump stops and backlash, seed 1).
inline constexpr double continuation_shares[] = {0.1, 0.16, 0.25, 0.35, 0.5, 0.7};
/// [1] Factor on a gap or a clearance from which the fit is tried again, either way, where a rest is left. A gap that
/// was fitted 2.6 % too small, with 2.2 times the χ², came right from 5 % more (single:quarter_car:backlash,
/// 2026120500). Half and twice were not tried.
inline constexpr double distance_shift = 1.05;

/// [steps of the model] Work that a diagnosis may spend on each fitted recording before stages are left out (budget.hpp):
/// 15 to 20 s of one core, since whole diagnoses of benches and cars take 9 to 14 ns a step. Half: the slowest real
/// recordings are told without laws. Twice: twice the time of the slowest.
inline constexpr double most_work = 1.5e9;

/// Steps of a fit that tell the starts of a machine's effects apart, and how many of the best are followed to the end
/// (search_apart.hpp). Derivation: a start in another valley is a factor away after three steps, each of which may move
/// a time constant by a factor of e; two, since the first steps of a pair may be led by the other effect. All starts to
/// the end: the same machine on mts_0A, in 17 500 simulations of a whole diagnosis in the place of 12 900.
inline constexpr int first_steps = 3, starts_to_the_end = 2;

// Neighbouring laws ---------------------------------------------------------------------------------------------------

/// [s] over which the amplitude of an effect is averaged: longer than what a quarter car or a bench remembers (a few
/// tenths of a second), shorter than a rough stretch of road. Half: one law that the catalogue does not hold is flagged
/// that was not. Twice: the same names.
inline constexpr double constancy_window = 0.5;
/// By which a size that is not constant must raise −2 ln evidence to count: χ² of one degree of freedom exceeds 30 in
/// 4e-8 of cases; true effects of tests/truth reached 11 (seed 1, 20 effects), neighbouring laws 3800 and more. Half:
/// 1e-4 for each effect of two parameters. Twice: neighbours of less than 60. Derived, and looked at.
inline constexpr double inconstant_gain = 30.0;
/// [1] and the relative change of the size by one deviation of the logarithm of its amplitude, or of time. The
/// amplitude of a stationary road varies by some 30 % from half second to half second, so powers of velocity that
/// differ by less than 0.07 are taken for one. True effects: at most 0.013, neighbouring laws at least 0.2. Half: what
/// the simulation gets wrong may count. Twice: a power that differs by 0.13 passes. Derived, and looked at.
inline constexpr double inconstant_share = 0.02;
/// [1] Of an effect beside which another law at the same place is not constant: √ of that gain relative to the gain of
/// the effect from which the two are doubted together. Looked at: viscous beside quadratic damping for a power of 1.47,
/// 0.13; the dry friction of a real carriage (EMPS) beside a small stop, 0.03. Half: the latter is doubted too. Twice:
/// near the former.
inline constexpr double imitated_share = 0.06;

// Parameters as suspects ---------------------------------------------------------------------------------------------

/// [χ²] Price of a parameter that is not as described, beside that of an effect with one parameter: 2 ln 100. A
/// described value is wrong in one of a hundred rigs (prior); where an effect does the same (viscous damping and the
/// damping of the suspension) the effect is named. Half: 1 in 10. Twice: 1 in 10 000. Either way, 13 recordings, seed
/// 11, keep every name.
inline constexpr double violation = 9.2;
/// Parameters that are freed at most, and suspects that are fitted for each.
inline constexpr std::size_t most_freed = 3, fitted_suspects = 4;
/// [1] Of what the best suspect explains, the share from which another is tried alone beside effects: beside an effect
/// that is not there yet, the wrong one of two may explain more. Half: twice the searches. Twice: the best only.
inline constexpr double equal_suspects = 0.5;
/// [1] Cosine between what an effect and what a parameter change in the residuals from which the effect is a limit of
/// its law that the parameter is, too. Derivation: √(1 − 0.99²) = 0.14 of what it changes is left, which an effect of
/// 20 standard deviations shows; where it does not, the two are no more than a tie (above) apart.
inline constexpr double at_the_limit = 0.99;
/// [1] Of the χ² that an effect at a limit of its law explains, the share by which it may be better than the parameter
/// and still is the parameter: what lies within the error of a model of fixed steps says nothing of a law's form.
/// Without it a stiffness 5 % off, 1e6 in χ², was a relaxation of 47 s, 12 in χ² better. Derivation: (ωΔt)²/12 of the
/// amplitude is 0.8 % at 50 Hz and 1 ms; its square. What the two cost stays as it is.
inline constexpr double model_error_of_limit = 1e-4;
/// Effects that are tried in the place of each.
inline constexpr std::size_t suspect_rivals = 4;
/// [1] Share of what an effect changes in the residuals that a parameter may leave by its slope and still is fitted in
/// its place. Derivation: over a change of 30 % slopes change by as much, which is 0.3² of the power. Half: a gain of
/// 0.9 may hide the spring that it is. Twice: more fits.
inline constexpr double unlike = 0.1;
/// [1] Odds up to which a parameter in the place of an effect is looked for: what is further off is no matter.
inline constexpr double listed_odds = 1e3;
/// [1] Where neither leaves noise alone: error of the recordings with freed parameters, relative to that of effects
/// alone. Half and twice of the distance to 1: no name of 13 recordings, seed 11, changes.
inline constexpr double parameters_replace_error = 0.9;

// Faults of the recording ---------------------------------------------------------------------------------------------

/// Faults of one model at most: those of issue reports hold two (a clock and a drift). Beside most_effects.
inline constexpr std::size_t most_faults = 3;
/// [χ²] Choice of the channels that a clock or filter acts on, for each channel measured: 2 ln 2 is the prior of each
/// to be one of them. Derived.
inline constexpr double group_choice = 1.386;
/// [χ²] A filter is a limit of a clock that is late, and a clock that is late of a sensor's delay: the simpler cause
/// wins by the penalty of its parameters, nothing else.
/// Groups of channels whose promise is largest, of which a fit or a scan of corners starts. Half of 2: the second best
/// is missed where a missing effect shifts phases. Twice: twice the fits.
inline constexpr std::size_t tried_groups = 2;
/// ln of the probability that a recording has one fault of a kind: one of a hundred. Effects say theirs on their cards;
/// a rig has drives and springs more often than two clocks. Half and twice of the probability: 1.4 in the evidence.
inline constexpr double fault_log_prior = -4.6;
/// The same of an effect: one of thirty. How wide its parameters are spread before a recording is seen: positive ones
/// over four decades, in natural logarithms, others over two of the scales from which their fits start.
inline constexpr double effect_log_prior = -3.4, prior_decades = 9.2, prior_scales = 2.0;
/// Candidates of faults that are fitted at most beside a model; effects that are tried in the place of a fault.
inline constexpr std::size_t fitted_faults = 4, fault_rivals = 4;
/// [Hz] Corners from which a filter's fit starts: each a factor of 2 from the next, the trust radius is a factor of e.
inline constexpr double filter_corners[] = {40.0, 80.0, 160.0, 320.0};
/// [1] Relative distance of two corners, read off the noises of two channels, that are tried as one filter; its fit to
/// the signals decides. Looked at: one filter of 196 Hz came out as 171 and 222 Hz. Half: such a pair is two sensors'
/// faults. Twice: all filters of a factor of 1.7 are tried as one first.
inline constexpr double alike_filters = 0.3;
/// Instants between which a parameter is free, so that a drift can be told from a size that goes up and down, and the
/// curvatures κ that are tried for the drift. Half: up and down is not seen. Twice: the same
/// names where dampings and stiffnesses drift (5 recordings, seed 11).
inline constexpr int drift_pieces = 6;
inline constexpr double drift_curvatures[] = {-3.0, 0.0, 3.0, 10.0};
/// [1] What the free sizes gain beyond the drift, as a share of its gain: a curvature between those above costs some
/// per cent. [χ²] And in any case: four degrees of freedom reach 18.5 in one of 1000. Half and twice: the same
/// names.
inline constexpr double drift_remainder = 0.1, drift_of_noise = 18.5;
/// [Hz] of mains and railways.
inline constexpr double mains_frequencies[] = {50.0, 60.0, 16.7};
/// [1] Power of a line beside the bins around it from which it is a candidate: of 14 residuals each, noise reaches 5 in
/// one of 10⁷ bins (χ² of 14). And the deviations of an amplitude from which a channel holds the line.
inline constexpr double line_above_neighbours = 5.0, least_line = 5.0;

/// [times what the best model leaves beyond noise] from which another model is not extended by a further effect.
/// Derivation: the further effect would have to explain nine tenths of what is left, where the best model's own next
/// effect stands against one tenth. Without it the same 50 of 56 rough recordings (seed 1) come right; with friction a
/// diagnosis takes a third longer. Half and twice: the same names.
inline constexpr double far_behind = 10.0;

// Steps of χ² ---------------------------------------------------------------------------------------------------------

/// [χ²] Effects that gain less beside friction or free play are looked at: twice the step of a sample in which 40 N of
/// friction turn. Half and twice were not measured.
inline constexpr double gain_of_steps = 400.0;
/// [1] Share of what a parabola gains at a quarter, half and three quarters of an effect's size, in the mean, below
/// which it is a step. Derivation: half way between both; 0.13 for the step that was seen.
inline constexpr double on_the_way = 0.5;

// Events from outside (external_event.hpp) ----------------------------------------------------------------------------

/// Events of one diagnosis at most: each costs a refit, all together one or two searches. A record with more of them is
/// a rough one. Half: of four knocks two are left; one law that the catalogue does not hold is flagged that was
/// not. Twice: the same names.
inline constexpr std::size_t most_events = 4;
/// [s] Length of the stretches whose power is compared.
inline constexpr double event_stretch = 0.25;
/// [1] of the power beyond noise is left beside events, at most, for them to be looked at: a law that is missing is
/// left in every stretch. Derivation: half. Without it the same 50 of 56 rough recordings (seed 1) come right; an
/// unknown law takes twice as long. Half and twice: the same names.
inline constexpr double left_beside_events = 0.5;
/// [1] Power of the loudest stretch, relative to that of three quarters of the stretches: where these are noise (below
/// `only_noise_else`), 2 is 15 standard deviations of 300 residuals; beside a missing effect the road itself makes
/// stretches up to eight times as loud (tests/truth, seeds 1 to 3). Half: searches for nothing. Twice: weak pushes are
/// not looked for. Either way (1) of external_event.hpp decides.
inline constexpr double loud_in_noise = 2.0, loud_in_rest = 8.0, only_noise_else = 1.5;
/// [1] The event lasts until a stretch is quieter than this, relative to the usual one.
inline constexpr double quiet_again = 1.25;
/// [1] More of a recording is no event.
inline constexpr double most_left_out = 0.3;
/// [s] Before the instant at which a balance fails, as much is left out: two of its blocks. Derived.
inline constexpr double event_margin = 0.02;
/// [s] What is left out in addition behind each event, again and again while a rest is left: the body's motion of a car
/// falls by 1/e in about as long. [1] of the recordings that may be left out in all: of four knocks in 20 s, the motion
/// of each for 3 s is 0.6. Half of the latter: such a recording (rigtwin_confusion --rough 20261125, looked at) is
/// unexplained. Neither adds an event to 40 recordings without one (neighbour_laws, drift, many, daq, sweeps, seeds 1
/// and 2).
inline constexpr double event_tail = 0.5, most_left_out_in_all = 0.7;
/// [Hz] A push has no faster details: 20 parameters a second.
inline constexpr double event_bandwidth = 10.0;

// How much data ------------------------------------------------------------------------------------------------------

/// [times the power of noise] from which a part of the recordings tells candidates apart, and its length [s].
/// Derivation: 12 s at 40 times the noise hold as much as 480 s at the noise. Half and twice: the same names.
inline constexpr double far_above_noise = 40.0, seconds_far_above_noise = 12.0;
/// [1] A part that would be more than this share of the longest window saves nothing.
inline constexpr double most_of_window = 0.75;

// A rig that the catalogue does not hold as a whole ------------------------------------------------------------------

/// [1] Share of the power beyond noise that a model must explain to be the whole of it; below, the search is repeated
/// with an allowed model error. Tuned on our own generator (unknown:*, seed 1). Half of the value itself: a
/// hysteresis that was unexplained gets a name, with a rest beside it. Twice: the same names.
inline constexpr double explains_all = 0.97;
/// [1] Below this, rivals are compared only after that search: over the 235 recordings of tests/confusion (seed 1)
/// comparing never raised such a model to explains_all, and took a third of the time. Tuned on our own generator.
inline constexpr double explains_most = 0.9;
/// [s] of recordings for the search under model error, together: errors of the model differ from one second to the
/// next, unlike noise. Experiment: with 20 s of ../shared/real's Quanser bench it blames sensors, with 24 s guides.
/// Twice: twice the time.
inline constexpr double seconds_under_model_error = 24.0;
/// [1] The pooled error that a model found there must stay below, relative to the one it replaces; and where it needs
/// effects of sensors. Several sensors bend any channel into place, while what a rig does has one cause for all
/// channels. Half and twice of the value itself: the same names.
inline constexpr double replaces_error = 0.98, sensors_replace_error = 0.75;
/// Effects that are tried beside a component that is judged apart, those first that explain most where it is fitted.
/// As many as always_fitted and one more. Half and twice were not tried.
inline constexpr std::size_t grown_apart = 4;
/// Effects and faults from which parameters are tried before these are compared with their rivals. Experiment: a mass
/// off by 14 % beside an offset was four effects, and took 34 000 simulations instead of 7000 (rough, parameters_off
/// 2026122301). Half: tried where comparing is cheap. Twice: as without.
inline constexpr std::size_t many_causes = 3;

}  // namespace host_sim::identification::thresholds
