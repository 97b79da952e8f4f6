// What the noise of a measured input makes of the simulated channels.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "host_sim/identification/predict/hypothesis.hpp"

namespace host_sim::identification {

struct InputNoiseCovariance {
  std::vector<Eigen::MatrixXcd> spectrum;  ///< N(f) of Whitening (2), a matrix for each thresholds::covariance_band;
                                           ///< empty: the input carries no noise
  std::array<double, model::channel_count> variance{};  ///< of each channel [SI²]
};

/// N(f): the recording is simulated with its input, and thresholds::noise_realisations times with seeded noise p of the
/// input sensors' size added. With D the differences of the channels and P the noise, band by band:
///
///   (1)  g = Σ D P* / Σ |P|²                                    gain from the input's noise to the channels
///   (2)  N = g gᴴ S_p + Σ (D − g P)(D − g P)ᴴ / ((n − 1) Σw²)    coherent part, and events that begin earlier or later
///   (3)  S_p = σ_z², of an acceleration that is integrated σ_a², with a fused accelerometer
///        1/(1/σ_z² + (4 sin²(πfh)/h²)²/σ_a²); σ² times the h(f) of its colour
///
/// The second term of (2) is as uncertain as the instants of events are: when a contact sticks depends on the noise.
/// Scaling the first term to the known density (3) makes a few realisations enough.
[[nodiscard]] InputNoiseCovariance input_noise_covariance(const PreparedRecording& recording,
                                                          const Hypothesis& hypothesis, const InitialState& start,
                                                          Window window);

}  // namespace host_sim::identification
