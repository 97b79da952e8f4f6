// What the noise of a measured input makes of the simulated channels.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "host_sim/diagnose/hypothesis.hpp"

namespace host_sim::diagnose {

/// By channel of the evidence and frequency.
struct CarriedNoise {
  std::vector<Eigen::MatrixXcd> spectrum;               ///< N(f) of Whitening (2), a matrix for each band
  std::array<double, model::channel_count> variance{};  ///< of each channel [SI²]
};

/// N(f), a matrix for each band: the simulation is driven by the input and by the input with noise of the
/// size that its sensors have, several times, and the differences of the channels are correlated. What depends on the
/// exact instant of an event – a contact that sticks, a stop that is reached – is thereby as uncertain as it is.
/// Nothing where the input is a number without noise.
[[nodiscard]] CarriedNoise carried_noise(const Evidence& evidence, const Hypothesis& hypothesis,
                                         const InitialState& start, Window window);

}  // namespace host_sim::diagnose
