// Which sensors hum, where the line of the mains stands in the residuals of several channels.
#pragma once

#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// A sensor that hums, and the amplitude of it [SI].
struct HummingSensor {
  model::Channel channel{};
  Interval amplitude{};
};

/// Hum of a sensor that drives the simulation passes through the model into every channel. In lines at the mains'
/// frequency f, as complex amplitudes,
///
///   (1)  ρ_c = h_c − G_c h_in                 of the residual of channel c;  h: hum of a sensor
///   (2)  h_in = w h_z + (1 − w) q h_a         of the driving position, where z_r and z̈_r are fused (input_fusion.hpp);
///                                             h_in = h_z or q h_a where one of them drives alone
///   (3)  δ = q h_a − h_z                      of what the two say of each other, where they are fused
///   (4)  q = T² M/g,  w = 1/(1 + κ g²)        g = −4 sin² πfT,  M = 1 + g/12,  κ = (σ_z/(T² σ_a))²;  T: sample period
///
/// G_c is the difference of two simulations, with and without a line on the input. The deviation of each line is that
/// of its neighbours in the spectrum, and thresholds::hum_model_error of G_c h_in. Of all sets of sensors the one is
/// right whose hums explain ρ and δ with the least χ² + 2 · parameter for each sensor (SelectionCriterion). Unlike a
/// set of channels, which hum each by itself, the input's hum needs two numbers for all of them.
///
/// `hypothesis`: without hum. The first recording that is fitted is used. Empty: none hums, or none of those that hum
/// drives the simulation.
[[nodiscard]] std::vector<HummingSensor> humming_sensors(const IdentificationProblem& problem,
                                                         const Hypothesis& hypothesis, double frequency);

}  // namespace host_sim::identification
