#include "host_sim/identification/estimate/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"

namespace host_sim::identification {
namespace {

/// Hypotheses that are simulated at once keep this many numbers at most [1], 32 MB: eight over two minutes at 1 kHz
/// with four channels. Half of it would cost longer recordings half of their lanes; twice would double the memory of a
/// diagnosis of an hour.
constexpr std::size_t most_numbers = 4'000'000;
constexpr std::size_t most_at_once = 8;

Resolution resolution_of(const ProblemRecording& recording, bool half_substeps) {
  Resolution resolution = recording.resolution();
  resolution.half = half_substeps;
  return resolution;
}

/// Spectra of the readings of a recording.
Spectra spectra_of(const ProblemRecording& recording, const Hypothesis& hypothesis, const Response& truth) {
  const PreparedRecording& samples = *recording.samples;
  Spectra seen;
  for (std::size_t c = 0; c < samples.channels.size(); ++c) {
    const model::Channel channel = samples.channels[c];
    const auto& values = truth[index(channel)];
    const bool affected = is_altered(hypothesis, channel);
    seen.push_back(recording.fit_whitening->spectrum(
        samples, c, affected ? sensor_readings(hypothesis, samples, channel, values) : values));
  }
  return seen;
}

/// Some variations of one recording that are simulated at once.
struct Batch {
  std::size_t recording;
  std::vector<std::size_t> variations;
};

std::vector<Batch> batches_of(const IdentificationProblem& problem, const std::vector<Variation>& variations) {
  std::vector<Batch> batches;
  for (std::size_t r = 0; r < problem.recordings().size(); ++r) {
    const ProblemRecording& recording = problem.recordings()[r];
    if (!recording.is_fitted()) continue;
    std::vector<std::size_t> moved;
    for (std::size_t v = 0; v < variations.size(); ++v) {
      if (!variations[v].recording || *variations[v].recording == r) moved.push_back(v);
    }
    const std::size_t numbers = recording.fit_whitening->window().to * recording.samples->channels.size();
    const std::size_t share = (moved.size() + free_processors() - 1) / free_processors();
    const std::size_t size = std::clamp<std::size_t>(std::min(share, most_numbers / numbers), 1, most_at_once);
    for (std::size_t first = 0; first < moved.size(); first += size) {
      const auto begin = moved.begin() + static_cast<std::ptrdiff_t>(first);
      batches.push_back({r, {begin, begin + static_cast<std::ptrdiff_t>(std::min(size, moved.size() - first))}});
    }
  }
  return batches;
}

}  // namespace

void predict_recording(const IdentificationProblem& problem, const Hypothesis& hypothesis, std::size_t recording,
                       bool half_substeps, Prediction& prediction) {
  const ProblemRecording& r = problem.recordings()[recording];
  if (!r.is_fitted()) return;
  auto simulated = true_channels_of_each({{&hypothesis, &hypothesis.starts[recording], &r.samples->input}}, *r.samples,
                                         r.fit_whitening->window().to, resolution_of(r, half_substeps));
  prediction.truth[recording] = std::make_shared<const Response>(std::move(simulated.front()));
  prediction.seen[recording] = spectra_of(r, hypothesis, *prediction.truth[recording]);
}

Prediction predict(const IdentificationProblem& problem, const Hypothesis& hypothesis, bool half_substeps) {
  const std::size_t count = problem.recordings().size();
  Prediction prediction{std::vector<std::shared_ptr<const Response>>(count), std::vector<Spectra>(count)};
  for (std::size_t r = 0; r < count; ++r) predict_recording(problem, hypothesis, r, half_substeps, prediction);
  return prediction;
}

Prediction predict_sensor(const IdentificationProblem& problem, const Hypothesis& hypothesis, const Prediction& base,
                          model::Channel channel) {
  return predict_readings(problem, hypothesis, base, {channel});
}

Prediction predict_readings(const IdentificationProblem& problem, const Hypothesis& hypothesis, const Prediction& base,
                            const std::vector<model::Channel>& channels) {
  Prediction prediction = base;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    for (std::size_t c = 0; c < r.samples->channels.size(); ++c) {
      const model::Channel channel = r.samples->channels[c];
      if (std::find(channels.begin(), channels.end(), channel) == channels.end()) continue;
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

std::vector<Eigen::VectorXd> residuals_of_each(const IdentificationProblem& problem,
                                               const std::vector<Variation>& variations, bool half_substeps,
                                               const Prediction* base) {
  const auto& recordings = problem.recordings();
  std::vector<std::vector<Spectra>> seen(variations.size(), std::vector<Spectra>(recordings.size()));
  const std::vector<Batch> batches = batches_of(problem, variations);
  for_all(batches.size(), [&](std::size_t b) {
    const std::size_t i = batches[b].recording;
    const ProblemRecording& r = recordings[i];
    std::vector<SimulatedRig> rigs;
    for (const std::size_t v : batches[b].variations) {
      const Hypothesis& hypothesis = variations[v].hypothesis;
      rigs.push_back({&hypothesis, &hypothesis.starts[i], &r.samples->input});
    }
    const auto simulated =
        true_channels_of_each(rigs, *r.samples, r.fit_whitening->window().to, resolution_of(r, half_substeps));
    for (std::size_t j = 0; j < simulated.size(); ++j) {
      const std::size_t v = batches[b].variations[j];
      seen[v][i] = spectra_of(r, variations[v].hypothesis, simulated[j]);
    }
  });
  std::vector<Eigen::VectorXd> values(variations.size());
  for_all(variations.size(), [&](std::size_t v) {
    values[v].resize(static_cast<Eigen::Index>(problem.residual_count()));
    double* out = values[v].data();
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      if (!recordings[i].is_fitted()) continue;
      const bool moved = !variations[v].recording || *variations[v].recording == i;
      recordings[i].fit_whitening->whiten(moved ? seen[v][i] : (base != nullptr ? base->seen : seen.back())[i], out);
      out += recordings[i].fit_whitening->count();
    }
  });
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

std::vector<double> measured_minus_read(const ProblemRecording& recording, model::Channel channel,
                                        const std::vector<double>& readings) {
  const PreparedRecording& samples = *recording.samples;
  const Window window = recording.fit_whitening->window();
  const std::vector<double>& measured = samples.recording[channel];
  const std::vector<bool>& clipped = samples.clipped[index(channel)];
  std::vector<double> left(window.size() / samples.step, 0.0);
  for (std::size_t k = 0; k < left.size(); ++k) {
    const std::size_t at = window.from + k * samples.step;
    if (clipped.empty() || !clipped[at]) left[k] = measured[at] - readings[at];
  }
  return left;
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
