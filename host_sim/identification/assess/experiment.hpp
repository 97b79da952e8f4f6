// Experiment design: which experiment would tell two models apart.
#pragma once

#include <string>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// The experiment that separates two hypotheses best, in words with the factor by which it does so better than the
/// fitted recordings did. Tried, by simulating both from rest:
///
///   other level       three times and a third of the recorded excitation
///   other band        sines over a band instead of the recorded excitation, with its rms velocity and at most three
///                     times its displacement
///   other ducts open  each other number of open ducts
///   another sensor    each channel of the rig that was not measured, with noise of 1 % of its rms
///   the other rig     the component alone on a bench, moved as it was here; a component that was recorded in a loop
///                     with a virtual car in a real car on that road. All its channels with noise of 1 % of their rms
///
///   (1)  separation = Σ_channels Σ_k (one_k − other_k)²/σ_c²
///
/// Where nothing separates twice as well as the recordings, that is said. Source: discrimination between models, W.
/// Hunter and A. Reiner, Technometrics 7, 1965; the sines' phases after M. Schroeder, IEEE Trans. Inf. Theory 16, 1970.
[[nodiscard]] std::string best_experiment(const IdentificationProblem& problem, const Hypothesis& one,
                                          const Hypothesis& other);

}  // namespace host_sim::identification
