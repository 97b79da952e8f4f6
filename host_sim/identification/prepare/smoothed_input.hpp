// A measured input without the noise that lies above its motion.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "host_sim/identification/prepare/noise_spectrum.hpp"

namespace host_sim::identification {

/// A position that drives a rig is differentiated twice, which makes its noise grow with f²: the last digit of an
/// encoder, 5e-8 m at 1 kHz, becomes 5 N on a mass of 95 kg. So the noise above the motion is taken away before.
///
///   (1)  y_k = Σ_j g_j x_{k+j},   g_j ∝ sinc(2 f_e jT) Kaiser(j/n),   |j| < n = smoothing_reach/T,   Σ g = 1
///
/// passes to 1e-5 what lies thresholds::smoothing_transition below the edge f_e, and stops what lies as far above. It
/// has no phase. Beyond the ends the signal goes on as
///
///   (2)  x_{−j} = 2 (c₀ + c₂ j²) − x_j,   c: cubic through the first 1/f_e seconds, least squares
///
/// so that value, slope and curvature continue. Source: A. V. Oppenheim, R. W. Schafer, Discrete-Time Signal
/// Processing, 1999, ch. 7.3.
[[nodiscard]] std::vector<double> smoothed(const std::vector<double>& signal, double edge, double period);

/// f_e [Hz] that keeps what lies below a frequency.
[[nodiscard]] double smoothing_edge(double known);

/// White or filtered noise of a position.
struct PositionNoise {
  double level;  ///< [m] rms of recorded samples, were it white
  NoiseColour colour{};
};

/// The highest frequency at which a position is above its noise [Hz], 10 … 90 and 0.45 of the recorded rate. `step`:
/// samples for each one that was recorded.
[[nodiscard]] double known_up_to(const std::vector<double>& position, const PositionNoise& noise, double period,
                                 std::size_t step = 1);

/// f_e [Hz] for a position with this noise. nullopt: nothing is to be taken away, or what (1) would take away is more
/// than thresholds::smoothed_noise times the noise somewhere, and so motion: a step, which the spectrum of a whole
/// recording hardly shows.
[[nodiscard]] std::optional<double> edge_of_motion(const std::vector<double>& position, const PositionNoise& noise,
                                                   double period, std::size_t step);

}  // namespace host_sim::identification
