// Prediction error: how far rig and model are apart, by channel, on data that was not fitted.
#pragma once

#include <map>
#include <optional>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// rms of simulated − measured ÷ rms of measured over the held-out windows (contract.md: "gap").
struct PredictionError {
  double before, refit, after;        ///< rig as described, tolerances refitted, effects added
  double noise_floor;                 ///< what a perfect model leaves: noise of the channel's sensor and of the input's
  std::optional<double> catalogue{};  ///< with effects of the catalogue alone, where a law was learned beside them
};

/// Of every channel; empty where nothing is held out. `catalogue`: nullptr where no law was learned.
[[nodiscard]] std::map<model::Channel, PredictionError> prediction_errors(const IdentificationProblem& problem,
                                                                          const Hypothesis& given,
                                                                          const Hypothesis& refit,
                                                                          const Hypothesis& after,
                                                                          const Hypothesis* catalogue);

}  // namespace host_sim::identification
