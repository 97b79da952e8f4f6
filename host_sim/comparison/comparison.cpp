#include "host_sim/comparison/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/unread_columns.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/comparison/model_rate.hpp"
#include "host_sim/comparison/start_state.hpp"

namespace host_sim {

namespace {

/// Of a recording and its measuring ranges; samples beyond these do not count.
std::vector<StaticValue> take_off_constants(const model::RigParameters<double>& rig, firmware::Recording& recording,
                                            firmware::MeasuringRanges& ranges) {
  UnusableSamples unusable;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (!ranges[c]) continue;
    for (const double sample : recording.channels[c]) unusable[c].push_back(!ranges[c]->holds(sample));
  }
  std::vector<StaticValue> values = static_values(rig, recording, unusable);
  tare(values, recording);
  for (const StaticValue& value : values) {
    auto& range = ranges[index(value.channel)];
    if (range) range = firmware::MeasuringRange{range->lower - value.value, range->upper - value.value};
  }
  return values;
}

}  // namespace

ComparedRecording::ComparedRecording(const firmware::RigDescription& description, firmware::Recording recording,
                                     StartChoice choice, RecordedAs recorder)
    : recording_(std::move(recording)),
      step_(model_steps_per_sample(recording_.sample_period, description.rig.kind == model::RigKind::hil
                                                                 ? 1.0 / description.sample_rate
                                                                 : longest_step(description.rig.kind, recording_))),
      range_(description.range),
      tared_(take_off_constants(description.rig, recording_, range_)),
      simulated_(interpolated(recording_, step_)),
      input_(simulation_input(description.rig, simulated_)),
      fine_(fine_steps(input_.period, longest_step(description.rig.kind, recording_) / longest_model_step)),
      recorder_(std::move(recorder)) {
  if (recorder_.moved) recorder_.moved(recording_, simulated_, input_);
  constexpr std::size_t least = 16;  // fewer samples resolve no band and no state at the start
  if (recording_.size() < least) {
    throw firmware::InputError(recording_.source, 0, "only " + std::to_string(recording_.size()) + " samples",
                               "at least 16");
  }
  for (const model::Channel channel : response_channels(description.rig.kind, input_)) {
    if (!recording_.has(channel)) continue;
    const auto& data = recording_[channel];
    Judged judged{channel, 0.0, {}, 0};
    const auto& filled = recording_.filled;
    if (const auto& range = range_[index(channel)]; range || !filled.empty()) {
      judged.trusted.assign(data.size(), true);
      for (std::size_t k = 0; k < data.size(); ++k) {
        const bool recorded = filled.empty() || !filled[k];
        const bool within = !range || range->holds(data[k]);
        judged.trusted[k] = recorded && within;
        if (recorded && !within) ++judged.clipped;
      }
    }
    double sum = 0.0, squares = 0.0, count = 0.0;
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (!trusted(judged, k)) continue;
      sum += data[k];
      count += 1.0;
    }
    const double mean = count > 0.0 ? sum / count : 0.0;
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (trusted(judged, k)) squares += (data[k] - mean) * (data[k] - mean);
    }
    judged.data_rms = count > 0.0 ? std::sqrt(squares / count) : 0.0;
    judged.count = count;
    judged_.push_back(std::move(judged));
  }
  if (judged_.empty()) {
    std::string wanted;
    for (const model::Channel channel : response_channels(description.rig.kind, input_)) {
      wanted += (wanted.empty() ? "" : ", ") + std::string(model::name(channel));
    }
    throw firmware::InputError(
        recording_.source, 0,
        "nothing is measured that a " + std::string(model::name(description.rig.kind)) + " answers with",
        "at least one of " + wanted +
            firmware::unread_columns(recording_, response_channels(description.rig.kind, input_).front()));
  }
  at_rest_ = choice == StartChoice::rest ||
             (choice == StartChoice::automatic && begins_at_rest(description.rig, input_, simulated_));
}

Response ComparedRecording::simulate(const model::RigParameters<double>& rig) const {
  Response response = host_sim::simulate(
      rig, input_, at_rest_ ? resting(rig, input_) : estimated_start(rig, input_, simulated_, range_), 0,
      steps_of(rig, input_.period, fine_),
      recorder_.varied ? recorder_.varied(rig, input_.size(), input_.period) : RigVariation{});
  if (recorder_.recorded) recorder_.recorded(simulated_, input_.channel, response);
  if (step_ == 1) return response;
  for (std::vector<double>& values : response) {
    for (std::size_t k = 0; k * step_ < values.size(); ++k) values[k] = values[k * step_];
    if (!values.empty()) values.resize(recording_.size());
  }
  return response;
}

std::size_t ComparedRecording::residual_count() const {
  std::size_t count = 0;
  for (const Judged& judged : judged_) {
    if (judged.data_rms > 0.0) count += recording_.size();
  }
  return count;
}

void ComparedRecording::residuals(const Response& response, std::vector<double>& out) const {
  for (const Judged& judged : judged_) {
    if (!(judged.data_rms > 0.0)) continue;
    const auto& data = recording_[judged.channel];
    const auto& simulated = response[index(judged.channel)];
    const double weight = 1.0 / (judged.data_rms * std::sqrt(judged.count));
    for (std::size_t k = 0; k < data.size(); ++k) {
      out.push_back(trusted(judged, k) ? weight * (simulated[k] - data[k]) : 0.0);
    }
  }
}

RecordingComparison ComparedRecording::compare(const Response& response) const {
  const double rate = 1.0 / recording_.sample_period;
  RecordingComparison result{
      recording_.source, static_cast<double>(recording_.size()) / rate, input_.channel, at_rest_, {}, 0, {}, tared_};
  result.missing = static_cast<std::size_t>(std::count(recording_.filled.begin(), recording_.filled.end(), true));
  result.remark = recording_.remark;
  const std::vector<Band> bands = resolved_bands(recording_.size(), rate);
  for (const Judged& judged : judged_) {
    const auto& data = recording_[judged.channel];
    const auto& simulated = response[index(judged.channel)];
    std::vector<double> error(data.size(), 0.0);
    double squares = 0.0;
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (!trusted(judged, k)) continue;
      error[k] = simulated[k] - data[k];
      squares += error[k] * error[k];
    }
    ChannelComparison channel{judged.channel, 0.0, 0.0, judged.data_rms, judged.clipped, {}};
    channel.error_rms = std::sqrt(squares / judged.count);
    channel.nrmse =
        judged.data_rms > 0.0 ? channel.error_rms / judged.data_rms : std::numeric_limits<double>::quiet_NaN();
    const BandRms error_bands = band_rms(error, rate, bands);
    const BandRms data_bands = band_rms(data, rate, bands);
    for (std::size_t i = 0; i < bands.size(); ++i) {
      channel.bands.push_back({bands[i], error_bands.rms[i], data_bands.rms[i]});
    }
    result.channels.push_back(std::move(channel));
  }
  return result;
}

}  // namespace host_sim
