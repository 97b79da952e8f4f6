// Experiment design: which experiment would tell two models apart.
#pragma once

#include <optional>
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

/// A sine of the component alone on a bench, and how much better a second of it separates two hypotheses than a second
/// of the recordings does.
struct SineTest {
  double frequency = 0.0, amplitude = 0.0;  ///< [Hz], [m]
  double separates = 0.0;                   ///< [1]
};

/// The sine that separates best by (1), with the noise of F that the recordings have, else 1 % of the rms of the
/// spring's force in them: of the
/// frequencies and amplitudes of thresholds::sine_*, those that the component has already been moved by, in travel and
/// in velocity. nullopt: nothing separates thresholds::separates_better times as well, or no such bench is a rig.
[[nodiscard]] std::optional<SineTest> best_sine(const IdentificationProblem& problem, const Hypothesis& one,
                                                const Hypothesis& other);

}  // namespace host_sim::identification
