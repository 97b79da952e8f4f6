// Which measurement on the first rig would narrow the prediction most.
#pragma once

#include <string>
#include <vector>

#include "host_sim/transfer/predict/prediction.hpp"

namespace host_sim::transfer {

/// A further recording of a minute on the first rig, and what it would do to the component's part of the bands.
struct NextMeasurement {
  std::string what;  ///< "twice the level", "sines from 4 to 8 Hz", "4 ducts open", "half of the noise of F"
  double remaining;  ///< the component's standard deviation with it ÷ without
  double band;       ///< the whole width of the band of the wheel load with it ÷ without
};

/// Each is rehearsed (plan/rehearsal.hpp) with the rig as diagnosed:
///
///   (1)  C′ = (C⁻¹ + JᵀJ)⁻¹                    J: of the rehearsed recording, its parameters those of the posterior
///   (2)  remaining = √(tr(g C′ gᵀ)/tr(g C gᵀ))   g: relative changes of quantities and responses with the component
///
/// best first. `motion`: the road of the first recordings; candidates that the firmware would stop are left out with a
/// remark.
struct NextMeasurements {
  std::vector<NextMeasurement> list;
  std::vector<std::string> remarks;
};
[[nodiscard]] NextMeasurements next_measurements(const firmware::RigDescription& from,
                                                 const identification::Identified& first, const Posterior& posterior,
                                                 const Sensitivity& sensitivity, const Budget& wheel_load);

}  // namespace host_sim::transfer
