// The noise of a sensor: declared, or estimated from its samples.
#pragma once

#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"

namespace host_sim::identification {

/// rms of the white noise in samples of a smooth signal, from sixth differences:
///
///   (1)  σ² = median over stretches of 64 samples of  mean (δ⁶x)² / Σ w²,   w = 1 −6 15 −20 15 −6 1
///
/// A signal below a tenth of the sample rate leaves less than 4e-3 of its amplitude in δ⁶x. The median ignores
/// stretches with events. Source: T. Gasser, L. Sroka, C. Jennen-Steinmetz, Residual variance and residual pattern in
/// nonlinear regression, Biometrika 73, 1986 (differences of second order there).
[[nodiscard]] double estimated_noise(const std::vector<double>& samples);

/// rms of a channel's noise [SI]: as the rig description declares it, else estimated; of a channel that is held, from
/// its new values.
[[nodiscard]] double sensor_noise(const firmware::RigDescription& description, const firmware::Recording& recording,
                                  model::Channel channel);

}  // namespace host_sim::identification
