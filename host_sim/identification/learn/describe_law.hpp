// What a learned law looks like, in an engineer's words with numbers.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host_sim/identification/estimate/uncertainty.hpp"
#include "host_sim/identification/learn/learned_law.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// The shapes. x: velocity or deflection at the place, b: slope that the rig itself has there (damping or stiffness of
/// suspension or tyre), c, c′, p, w, r: values of a family (predict/placed_law.hpp).
///
/// | shape                | family           | numbers                                                               |
/// | -------------------- | ---------------- | --------------------------------------------------------------------- |
/// | power law            | power            | exponent p; coefficient c/r^p                                         |
/// | asymmetric           | two_slopes       | compression b + c/r, rebound b + c′/r, rebound_harder_by_per_cent     |
/// | asymmetric power law | two_powers       | exponent p, rebound_harder_by_per_cent 100 (c′/c − 1)                 |
/// | smooth friction      | soft_sign        | force c, velocity w: 76 % of the force are reached there              |
/// | stribeck             | falling          | break_away F_c, sliding F_c − c, velocity w; F_c: dry friction beside |
/// | degressive           | knee             | slopes b + c/r below, b + c′/r above the knee w; the upper is lower   |
/// | progressive          | knee, one_sided  | the upper slope is larger: "stiffens from w on"                       |
/// | degressive           | levelling        | slope_at_rest b + c/r, half_at: where half of c/r is left; c < 0:      |
/// |                      |                  | progressive                                                            |
/// | hysteresis           | sliders          | force Σ c_i, half_travel: within it half of the force builds up;       |
/// |                      |                  | lost_motion, where there is a gap                                      |
/// | relaxation           | maxwell          | stiffness Σ c_i/r, time_constant: its ends are the smallest and the    |
/// |                      |                  | largest T_i                                                           |
/// | follows the load     | follows_load     | share c/(k r) of the spring's load, velocity w                        |
/// | along the stroke     | along_stroke     | exponent p, damping at the end of the stroke                          |
/// | surface              | free_surface     | damping that is added at −2r, 0 and 2r, force at v = 0 at both ends   |
/// | degressive,          | points           | slope_at_rest, slope_at_end: where those of both sides differ alike by |
/// | progressive          |                  | more than their intervals; rebound_harder_by_per_cent                  |
/// | asymmetric           | points           | rebound_harder_by_per_cent, where only that is more than its interval  |
/// | curve                | points           | none                                                                  |
///
/// Numbers are known as their parameters are (estimate/uncertainty.hpp). The band of the curve is Uncertainty (5) of
/// gᵀu at each point, g the change of the curve with the law's values u: the likelihood's, the sandwich over blocks of
/// time and the jackknife over bands, whichever is widest there. Where the truth is a law of the family it holds the
/// curve with 95 % at each point (learn/law_band_test).
[[nodiscard]] std::vector<DescribedLaw> describe_laws(const IdentificationProblem& problem, const Fit& fit,
                                                      const Uncertainty& known);

/// The curves of a rig description at suspension and tyre, beside what the recordings show there: the curve's force at
/// the motion of a hypothesis, plus the force that its residual stands for. `words` is the law's name.
[[nodiscard]] std::vector<DescribedLaw> described_curves(const IdentificationProblem& problem,
                                                         const firmware::RigDescription& description,
                                                         const Hypothesis& hypothesis);

}  // namespace host_sim::identification
