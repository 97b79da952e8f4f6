// Measured and simulated channels over time and frequency, for figures.
#pragma once

#include <vector>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// A channel of the first recording held out (else fitted), for figures.
struct Overlay {
  model::Channel channel;
  std::vector<double> time, measured, refit, after;                  ///< some seconds in the middle
  std::vector<double> frequency;                                     ///< [Hz]
  std::vector<double> data, error_before, error_refit, error_after;  ///< densities [unit²/Hz]
  double noise;                                                      ///< density of the sensor's noise [unit²/Hz]
};

[[nodiscard]] std::vector<Overlay> overlays_of(const IdentificationProblem& problem, const Hypothesis& given,
                                               const Hypothesis& refit, const Hypothesis& after);

}  // namespace host_sim::identification
