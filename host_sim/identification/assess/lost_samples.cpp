#include "host_sim/identification/assess/lost_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "host_sim/identification/assess/thresholds.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"

namespace host_sim::identification {

namespace {

/// Outliers of a channel that are not what the model reads there.
double outliers_of(const PreparedRecording& r, std::size_t channel, const Response& read) {
  const Outliers& outliers = r.outliers[channel];
  const auto count = static_cast<double>(outliers.count);
  if (outliers.at.empty() || !r.explains(model::channel_at(channel))) return count;
  double explained = 0.0;
  for (std::size_t i = 0; i < outliers.at.size(); ++i) {
    const std::size_t k = outliers.at[i];
    const double to_recorded = std::abs(read[channel][k] - outliers.values[i]);
    const double to_mended = std::abs(read[channel][k] - r.recording.channels[channel][k]);
    if (to_recorded < to_mended) explained += 1.0;
  }
  return count - std::round(count * explained / static_cast<double>(outliers.at.size()));
}

bool has_outliers(const PreparedRecording& r) {
  return std::any_of(r.outliers.begin(), r.outliers.end(), [](const Outliers& o) { return o.count > 0; });
}

/// Outliers and rounding, by channel.
std::vector<RecordingFault> sample_faults(const IdentificationProblem& problem, const Hypothesis& found) {
  std::array<double, model::channel_count> outliers{}, steps{};
  std::array<bool, model::channel_count> declared{};
  for (std::size_t i = 0; i < problem.samples().size(); ++i) {
    const PreparedRecording& r = problem.samples()[i];
    Response read{};
    if (has_outliers(r)) read = read_channels(found, r, r.input, found.starts[i], 0, {r.substeps});
    for (std::size_t c = 0; c < model::channel_count; ++c) {
      outliers[c] += outliers_of(r, c, read);
      steps[c] = std::max(steps[c], r.rounding[c]);
      declared[c] = declared[c] || r.declared_noise[c];
    }
  }
  std::vector<RecordingFault> faults;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const auto add = [&](const char* name, const char* key, const Interval& value, bool is_cause) {
      faults.push_back({name, {model::channel_at(c)}, {{key, value}}, thresholds::highest_confidence});
      faults.back().is_cause = is_cause;
    };
    if (outliers[c] > 0.0) add("outliers", "count", {outliers[c], outliers[c], outliers[c]}, true);
    constexpr double written = 0.01;  // [1] a step is known as well as text holds it
    if (steps[c] > 0.0) {
      add("quantisation", "step", {steps[c], (1.0 - written) * steps[c], (1.0 + written) * steps[c]}, declared[c]);
    }
  }
  return faults;
}

}  // namespace

std::vector<RecordingFault> lost_samples(const IdentificationProblem& problem, const Hypothesis& found) {
  constexpr double confidence = thresholds::highest_confidence;
  const auto counted = [](double value) { return Interval{value, value, value}; };
  std::vector<RecordingFault> faults;
  std::size_t lost = 0;
  for (const PreparedRecording& r : problem.samples()) {
    lost += r.recording.lost_rows;
    for (const firmware::Recording::Gap& gap : r.recording.gaps) {
      faults.push_back({"gap", {}, {{"from_s", counted(gap.from)}, {"to_s", counted(gap.to)}}, confidence});
    }
  }
  if (lost > 0) faults.push_back({"lost_rows", {}, {{"count", counted(static_cast<double>(lost))}}, confidence});
  for (RecordingFault& fault : sample_faults(problem, found)) faults.push_back(std::move(fault));
  return faults;
}

}  // namespace host_sim::identification
