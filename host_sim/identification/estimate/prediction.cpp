#include "host_sim/identification/estimate/prediction.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/identification/common/parallel.hpp"

namespace host_sim::identification {

void predict_recording(const IdentificationProblem& problem, const Hypothesis& hypothesis, std::size_t recording,
                       bool half_substeps, Prediction& prediction) {
  const ProblemRecording& r = problem.recordings()[recording];
  if (!r.is_fitted()) return;
  const PreparedRecording& samples = *r.samples;
  Resolution resolution = r.resolution();
  resolution.half = half_substeps;
  auto truth = std::make_shared<const Response>(true_channels(
      hypothesis.rig, samples, samples.input, hypothesis.starts[recording], r.fit_whitening->window().to, resolution));
  Spectra seen;
  for (std::size_t c = 0; c < samples.channels.size(); ++c) {
    const model::Channel channel = samples.channels[c];
    const auto& values = (*truth)[index(channel)];
    const bool affected = has_sensor_effect(hypothesis.rig, channel);
    seen.push_back(r.fit_whitening->spectrum(
        samples, c, affected ? sensor_readings(hypothesis, samples, channel, values) : values));
  }
  prediction.truth[recording] = std::move(truth);
  prediction.seen[recording] = std::move(seen);
}

Prediction predict(const IdentificationProblem& problem, const Hypothesis& hypothesis, bool half_substeps) {
  const std::size_t count = problem.recordings().size();
  Prediction prediction{std::vector<std::shared_ptr<const Response>>(count), std::vector<Spectra>(count)};
  for (std::size_t r = 0; r < count; ++r) predict_recording(problem, hypothesis, r, half_substeps, prediction);
  return prediction;
}

Prediction predict_sensor(const IdentificationProblem& problem, const Hypothesis& hypothesis, const Prediction& base,
                          model::Channel channel) {
  Prediction prediction = base;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    for (std::size_t c = 0; c < r.samples->channels.size(); ++c) {
      if (r.samples->channels[c] != channel) continue;
      prediction.seen[i][c] = r.fit_whitening->spectrum(
          *r.samples, c, sensor_readings(hypothesis, *r.samples, channel, (*base.truth[i])[index(channel)]));
    }
  }
  return prediction;
}

Eigen::VectorXd residuals(const IdentificationProblem& problem, const Prediction& prediction) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(problem.residual_count()));
  double* out = values.data();
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    r.fit_whitening->whiten(prediction.seen[i], out);
    out += r.fit_whitening->count();
  }
  return values;
}

std::vector<Response> read_all(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const auto& recordings = problem.recordings();
  std::vector<Response> responses(recordings.size());
  for_all(recordings.size(), [&](std::size_t i) {
    const PreparedRecording& samples = *recordings[i].samples;
    responses[i] =
        read_channels(hypothesis, samples, samples.input, hypothesis.starts[i], 0, recordings[i].resolution());
  });
  return responses;
}

bool stays_finite(const PreparedRecording& recording, const Response& readings) {
  return std::all_of(recording.channels.begin(), recording.channels.end(), [&](model::Channel channel) {
    double sum = 0.0;
    for (const double value : readings[index(channel)]) sum += value * value;
    return std::isfinite(sum);
  });
}

bool stays_finite(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const std::vector<Response> responses = read_all(problem, hypothesis);
  for (std::size_t i = 0; i < responses.size(); ++i) {
    if (!stays_finite(*problem.recordings()[i].samples, responses[i])) return false;
  }
  return true;
}

}  // namespace host_sim::identification
