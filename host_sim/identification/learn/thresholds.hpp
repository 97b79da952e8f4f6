// Every number that decides something while laws are learned.
#pragma once

#include <array>
#include <cstddef>

namespace host_sim::identification::thresholds {

// The range of a curve ------------------------------------------------------------------------------------------------

/// [1] Share of the samples at each end of the range that no law is held to. Derivation: 30 of a minute's 60 000, some
/// three visits; a value at the end then has a standard error of a third of the force's scatter. Half and twice: the
/// range of a normal distribution ends at 3.5, 3.3 or 3.1 deviations.
inline constexpr double rarely_reached = 5e-4;
/// Samples that a range needs: fewer have no ends. Half and twice: no recording is so short.
inline constexpr std::size_t fewest_samples = 100;
/// Points of a curve on each side of 0. Derivation: with s below, x grows by a factor of e^0.55 from point to point, so
/// that a cubic between them follows a power of up to 3 within 1 %. Half: 5 %. Twice: 31 points, four times the time of
/// a step, and the last ones without samples.
inline constexpr int points_each_side = 7;
/// [rms of x] s of curve_fit.hpp; the innermost point stands at 0.6 s. Derivation: friction that sets in within a tenth
/// of the rms of the velocity has a point on its way. Half: the outer points stand farther apart. Twice: that friction
/// is a step.
inline constexpr double innermost_point = 0.15;
/// Nodes of a free surface on each side of 0: every other of the eight points that its table has there. Looked at
/// (seed 1 of bypass_damper, whose damping changes within 2 and 3 mm of ± 20 mm): the error of held-out data is 1.06
/// times the floor of a bench and 2.8 times that of a car; half of the nodes over the deflection: 1.27 and 7.2 times.
/// Twice: the table has no more points.
inline constexpr int deflection_nodes = 4, velocity_nodes = 4;
/// [rms of the velocity] s of a surface; its velocities stand at 0.35, 0.84, 1.7 and 3.3.
/// Half: friction that sets in slowly is followed, and the outer nodes stand farther apart. Twice: nearly even.
inline constexpr double innermost_velocity = 0.5;
/// [1] How far the table of a family goes on, relative to the largest |x| of all that is recorded: x moves while a law
/// is fitted. From there it is straight: of a power of 3 that is reached by 5 % more, 0.7 % of the force is missing.
/// Half of the excess: a fit may reach the end. Twice: points a tenth farther apart. Derived, not measured.
inline constexpr double table_beyond = 1.1;
/// [1] How far beyond the range a point may stand, relative to the end. Rounding alone asks for more than 1. Half and
/// twice of the excess: no difference.
inline constexpr double beyond_range = 1.02;

// A curve's fit -------------------------------------------------------------------------------------------------------

/// [decades] λ around the value at which penalty and data have the same trace: from no smoothing at all to a straight
/// line. Half: curves of strong laws are bent a little. Twice: no difference.
inline constexpr double least_penalty = -8.0, largest_penalty = 4.0;
/// [χ²/τ] A step of a curve that gains less ends the fit: it is worth one residual. Half and twice: one step more or
/// less.
inline constexpr double curve_settled = 1.0;
/// Steps of a curve's fit and of a family's at most. Looked at: curves of seed 1 settle in 3 to 5, families in 4 to 8.
inline constexpr int curve_steps = 5, family_steps = 12;
/// [1] of stiffness × rms deflection: a force that matters, unit of the forces in a fit, unless the effects that a law
/// replaces are larger. A fit does not depend on it, but for its bounds (estimate/thresholds.hpp, largest_law_force).
/// Half and twice: no difference.
inline constexpr double force_share = 0.1;

// Which curves and families -------------------------------------------------------------------------------------------

/// Grid on which a family's exponent and width are searched before a fit moves them: steps that a fit bridges. Half:
/// no difference. Twice: the same names.
inline constexpr double exponent_step = 0.05, width_factor = 1.15;
/// [s] of recordings on which curves are compared before the whole is fitted. Laws act all the time, so that 20 s tell
/// places apart. Half: laws over deflection have few slow periods. Twice: twice the time.
inline constexpr double seconds_of_curves = 20.0;
/// Curves continued after one step, curves fitted on the whole, and families beside each. Looked at (seed 1): the right
/// family is among the first two of the right curve; the right curve among the first two. Half: some are missed. Twice:
/// twice the time.
inline constexpr std::size_t continued_curves = 4, fitted_curves = 3, fitted_families = 3;
/// Effects that are added beside the best curve of each kind where it leaves more than noise, and candidates that are
/// fitted for each. Experiment: a real damper (mr_damper of ../shared/real, A1 and A3) has two beside its curve, a
/// mount and a mass. Half and twice: the third record is still predicted within 11 %; none: 15 %, and no law.
inline constexpr std::size_t grown_effects = 2, grown_candidates = 3;
/// Curves and families that are fitted on the whole, of those that were on a part. Derivation: a law that wins by the
/// margin there wins by two thirds of it on 20 s of 30, and the free curve and two families lie between. Looked at:
/// seed 20261130 of rigtwin_confusion --laws with four recognises as many laws as 20261128 with all twelve. Twice: half
/// as much time again.
inline constexpr std::size_t fitted_on_whole = 4;

/// [s] Shortest time constant of a Maxwell branch; eight of them, each three times the last, end at 4.4 s. Derivation:
/// below, a branch is a dashpot up to 90 Hz (1/(2π 90 Hz) = 1.8 ms); two in one of the gaps differ by less than 8 %
/// from one between them. Half: the first is viscous damping.
inline constexpr double shortest_time = 2e-3;
/// Steps of a stack's fit, and rounds in which branches are left out. Forces of branches enter linearly where the
/// deflection is the input (one step), nearly so elsewhere.
inline constexpr int stack_steps = 5, stack_rounds = 3;
/// [range of the deflection] Lost motion that a stack of sliders is begun with; from there it is free. Derivation: a
/// factor of 2 apart, a fit moves each to its neighbour; a tenth of the least is a quarter of a per cent of the stroke.
inline constexpr std::array gaps{0.025, 0.05, 0.1, 0.2};

/// [rms of the velocity] Width with which friction that follows the load begins; [1] exponent with which damping along
/// the stroke does. Fits move both. Half and twice: the same laws.
inline constexpr double sets_in_at_first = 0.2, stroke_exponent_at_first = 2.0;

// What is believed ----------------------------------------------------------------------------------------------------

/// [χ²/τ] by which a law must beat the effects it replaces, beside its own penalty: odds of e⁶. Derivation: the
/// catalogue wins a tie, and three places with seven families are tried, 2 ln 21 = 6. Half: odds of e³ for the best of
/// 21. Twice: a law of 12 deviations is missed.
inline constexpr double law_margin = 12.0;
/// [χ²/τ] and on held-out windows, a third as long as the fitted ones: a third of it. Half and twice: the same names.
inline constexpr double law_margin_held_out = 4.0;
/// [1] Error of the held-out windows, relative to that without it, below which a law is taken although more than noise
/// is left: the middle between what real records leave with laws that are right and with laws that are not. Looked at:
/// stacks for a friction damper, learned on two of its three records, 0.53, 0.76 and 0.57; curves of a servo-hydraulic
/// machine and of a quarter-car bench, and second laws beside right ones, 0.93 to 1.19. Of the distance to 1, half:
/// the same laws. Twice: one of the three stacks is lost.
inline constexpr double law_replaces_error = 0.85;
/// [1] Share of the dry friction in whose place a curve stands, from which its step at rest is that friction.
/// Derivation: the step is its force at 0.15 rms. Friction that sets in within 0.1 rms has nine tenths of itself there,
/// a power p that was taken for friction 0.15^p: an eighth for 1.1. Half: between the two as well. Twice: no curve is
/// friction.
inline constexpr double steps_like_friction = 0.5;
/// [1] Of what is beyond noise on held-out windows, the share that a law may leave whose limit is the effect it
/// replaces: friction that sets in softly, in the place of dry friction. The noise of a driving channel blurs where it
/// sets in, so that its own truth leaves a rest (0.59 and 0.73, seed 100 of rigtwin_confusion --laws). Half: neither is
/// learned.
inline constexpr double refines_error = 0.8;
/// [1] and a free surface, whose nodes are coarse beside a law that changes within a few millimetres: the middle, as a
/// ratio, between what it left of such laws (0.001 to 0.013, seed 20270105 of bypass_damper) and of a positioning
/// system whose friction it would have replaced (0.5). Half and twice: the same.
inline constexpr double surface_leaves = 0.1;
/// Values of the simplest family of curves: what a free curve is expected to cost in the end.
inline constexpr double fewest_values = 2.0;
/// [ln] Odds are capped, so that they stay finite numbers.
inline constexpr double most_odds = 300.0;

// What is shown -------------------------------------------------------------------------------------------------------

/// [1] Share of the largest force of sliders beyond which all of them are said to slide, and passes of a side that tell
/// its mean and scatter. Derivation: sliders on a grid of halves reach nine tenths where the last but one slides; the
/// scatter of three values is known to a half. Half of the passes: no scatter.
inline constexpr double sliding = 0.9;
inline constexpr std::size_t fewest_passes = 3;
/// [1] Exponents this far from that of an effect are its own, if the effect explains as much: that decides.
inline constexpr double exponent_of_effect = 0.3;
/// [1] Slope beyond a knee, relative to that before it, up to which the fall of friction is tried as Stribeck's. Half
/// and twice: the same names, since the fit of the effect decides.
inline constexpr double flat_beyond_knee = 0.25;
/// Steps of that effect's fit, which begins where the law ended.
inline constexpr int effect_steps = 8;

/// [%] Difference of the sides of a power below which words and numbers are those of one power. Half and twice: other
/// words for a difference that nobody would act on.
inline constexpr double same_on_both_sides = 1.0;
/// [1] Half width of the band of a curve that is not known at all, relative to the law. Half and twice: as wide to a
/// reader.
inline constexpr double widest_band = 10.0;
/// Measured points behind a curve in the report.
inline constexpr std::size_t points_shown = 600;
/// Turns through the whole range whose path a loop in the report is as long as: more lie on one another.
inline constexpr double loop_turns = 4.0;

}  // namespace host_sim::identification::thresholds
