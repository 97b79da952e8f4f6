// The models of a diagnosis, each with the criterion that decides and with its evidence.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host_sim/identification/diagnosis.hpp"

namespace confusion {

/// One model that a diagnosis compared.
struct ComparedModel {
  std::vector<std::string> causes;         ///< "sensor_lag of F", sorted
  double penalised = 0.0;                  ///< χ² with the penalties that decide
  std::map<std::string, double> evidence;  ///< −2 ln, by the error model: "K2" …
};

/// The model that was found, first; the model without effects; the found one without each of its effects, and with the
/// nearest rivals of each in its place. Refitted: nothing that was found changes.
[[nodiscard]] std::vector<ComparedModel> compared_models(host_sim::identification::Identified& identified);

}  // namespace confusion
