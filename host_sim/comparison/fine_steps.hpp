// Rigs whose forces bend, and how finely they are stepped.
#pragma once

#include "model/rig/rig_parameters.hpp"

namespace host_sim {

/// [s] The longest step of a rig whose forces bend: inside a step the instant of a corner is known only at the step's
/// end, an error ∝ step, and a curve is a polynomial through the last steps. Experiment: a rig of tests/truth with 50 N
/// of friction; at 1 ms the friction is found 0.1 % too large, so 0.025 % at this step. Half: half of that, at half the
/// speed. Twice: twice of that.
inline constexpr double longest_bent_step = 0.25e-3;

/// true: an active effect has a corner (model::Corner), as dry friction, free play, a stop, a limit of velocity have.
[[nodiscard]] bool has_corners(const model::RigParameters<double>& rig);
/// True if a rig has an effect with free play (model::Corner::free_play).
[[nodiscard]] bool has_free_play(const model::RigParameters<double>& rig);

/// true: the rig takes several model steps per sample, as it has a corner, a law or an effect that adds a force.
/// The three may stand for each other (a cubic spring and a curve over the deflection), so all are stepped alike.
[[nodiscard]] bool is_stepped_finely(const model::RigParameters<double>& rig);

/// Steps of longest_bent_step · slower in a period [s], 1 at least. `slower`: how much longer than longest_model_step
/// the steps of the recording may be (model_rate.hpp).
[[nodiscard]] int fine_steps(double period, double slower = 1.0);

/// `fine` of them for a rig that is stepped finely and can be, otherwise one.
[[nodiscard]] int steps_of(const model::RigParameters<double>& rig, double period, int fine);

}  // namespace host_sim
