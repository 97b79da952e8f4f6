// Everything a transfer finds.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/transfer/predict/next_measurement.hpp"
#include "host_sim/transfer/predict/overlap.hpp"
#include "host_sim/transfer/validate/both_rigs.hpp"
#include "host_sim/transfer/validate/validation.hpp"

namespace host_sim::transfer {

/// A prediction that was made in another way, for comparison.
struct Alternative {
  Prediction prediction;
  std::optional<Validation> validation;
};

struct Transfer {
  Posterior posterior;
  SecondRig second;
  Overlap overlap;
  Prediction prediction;
  std::optional<Validation> validation;       ///< with recordings of the second rig
  std::optional<Alternative> with_own;        ///< the second rig with its own effects, as its recordings show them
  std::optional<ComponentModel> naive_model;  ///< the first rig's own effects ignored
  std::optional<Alternative> naive;
  BothRigs both;
  NextMeasurements next;
  std::vector<std::string> remarks;
  std::string component_verdict;  ///< of the first rig's diagnosis, in a sentence

  [[nodiscard]] bool holds() const;  ///< validated, in the bands, and excited alike
};

}  // namespace host_sim::transfer
