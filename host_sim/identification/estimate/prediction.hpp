// Predictions of a hypothesis for a whole problem, and their whitened residuals.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/identification/noise/identification_problem.hpp"

namespace host_sim::identification {

/// By recording of the problem; empty for one that is not fitted.
struct Prediction {
  std::vector<std::shared_ptr<const Response>> truth;  ///< channels before their sensors
  std::vector<Spectra> seen;                           ///< of the readings
};
[[nodiscard]] Prediction predict(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                 bool half_substeps = false);

/// Predicts one recording again, in place.
void predict_recording(const IdentificationProblem& problem, const Hypothesis& hypothesis, std::size_t recording,
                       bool half_substeps, Prediction& prediction);

/// The prediction of a hypothesis that differs from that of `base` in the sensor of one channel only: no simulation.
[[nodiscard]] Prediction predict_sensor(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                        const Prediction& base, model::Channel channel);

/// One of several hypotheses that are predicted together.
struct Variation {
  Hypothesis hypothesis;
  std::optional<std::size_t> recording{};  ///< the only one in which it differs from a base; none: in all of them
};

/// residuals(problem, predict(problem, hypothesis, half_substeps)) of each variation, bit for bit, with simulations
/// side by side (comparison/side_by_side.hpp). Recordings in which a variation does not differ are those of `base`;
/// nullptr: those of the last variation, which then is the base.
[[nodiscard]] std::vector<Eigen::VectorXd> residuals_of_each(const IdentificationProblem& problem,
                                                             const std::vector<Variation>& variations,
                                                             bool half_substeps, const Prediction* base);
/// The same of several channels: also where the hypotheses differ in faults of the recording that act on them.
[[nodiscard]] Prediction predict_readings(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                          const Prediction& base, const std::vector<model::Channel>& channels);

/// Whitened residuals of the fitted windows, recording after recording (noise/whitening.hpp).
[[nodiscard]] Eigen::VectorXd residuals(const IdentificationProblem& problem, const Prediction& prediction);

/// Readings of every recording in full.
[[nodiscard]] std::vector<Response> read_all(const IdentificationProblem& problem, const Hypothesis& hypothesis);

/// Measured minus read of a channel at the compared samples of the fitted window; 0 where a sample is not to be used.
[[nodiscard]] std::vector<double> measured_minus_read(const ProblemRecording& recording, model::Channel channel,
                                                      const std::vector<double>& readings);

/// Whether the simulation of every recording stays finite from its first to its last sample, what is held out too: the
/// sum of the squares of each explained channel is a number.
[[nodiscard]] bool stays_finite(const IdentificationProblem& problem, const Hypothesis& hypothesis);
[[nodiscard]] bool stays_finite(const PreparedRecording& recording, const Response& readings);

}  // namespace host_sim::identification
