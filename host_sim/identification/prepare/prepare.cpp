#include "host_sim/identification/prepare/prepare.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/prepare/driving_input.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/identification/prepare/validation.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

/// Of a long recording the beginning stays fitted and the end becomes a held-out recording of its own: minutes say what
/// hours would, and fit into memory. Returns a remark on each.
std::vector<std::string> leave_out_the_middle(std::vector<Record>& records) {
  std::vector<std::string> remarks;
  std::vector<Record> ends;
  for (Record& record : records) {
    firmware::Recording& r = record.recording;
    const UsedSeconds used = used_of_long(record.use);
    const std::size_t n = r.size();
    const auto samples = [&](double seconds) { return static_cast<std::size_t>(seconds / r.sample_period); };
    const std::size_t kept = samples(used.first), end = samples(used.last);
    if (n <= kept + end) continue;
    remarks.push_back(r.source + ": " + shortened(static_cast<double>(n) * r.sample_period, record.use));
    if (end > 0) {
      ends.push_back({cut(r, {n - end, n}), Use::held_out});
      ends.back().recording.lost_rows = 0;  // said of the beginning
      ends.back().recording.gaps.clear();
      record.use = Use::fitted;
    }
    record.recording = cut(r, {0, kept});
  }
  for (Record& record : ends) records.push_back(std::move(record));
  return remarks;
}

/// What a reader of the verdict must know of a recording.
void add_remarks(const PreparedRecording& r, std::vector<std::string>& remarks) {
  const std::string& source = r.recording.source;
  for (const Channel channel : r.channels) {
    const auto c = index(channel);
    const auto stuck = channel == Channel::F ? static_cast<std::ptrdiff_t>(r.stuck) : 0;
    const auto count =
        std::count(r.clipped[c].begin(), r.clipped[c].end(), true) - stuck -
        (r.clipped[c].empty() ? 0 : std::count(r.recording.filled.begin(), r.recording.filled.end(), true));
    if (count > 0) {
      remarks.push_back(source + ": " + std::to_string(count) + " clipped samples of " +
                        std::string(model::name(channel)) + " are left out");
    }
  }
  if (r.stuck > 0) {
    remarks.push_back(
        source + ": x_cmd stands still in " + std::to_string(r.stuck) +
        " samples, where its stroke does not say what a component that sticks carries; F is not compared there");
  }
  if (const std::string road = road_remark(r.input); !road.empty()) remarks.push_back(source + ": " + road);
  if (r.inputs_disagree) {
    remarks.push_back(source + ": z_r and zdd_r are inconsistent; the foot point follows z_r alone");
  }
}

void check_channels(const std::vector<PreparedRecording>& recordings) {
  const PreparedRecording& first = recordings.front();
  for (const PreparedRecording& r : recordings) {
    if (r.channels == first.channels) continue;
    throw firmware::InputError(r.recording.source, 0, "measures other channels than " + first.recording.source,
                               "recordings of the same channels");
  }
}

}  // namespace

UsedSeconds used_of_long(Use use) {
  if (use == Use::held_out) return {thresholds::longest_held_out, 0.0};
  return {thresholds::longest_fitted, use == Use::shared ? thresholds::longest_held_out : 0.0};
}

std::string shortened(double seconds, Use use) {
  const UsedSeconds used = used_of_long(use);
  char text[128];
  const int length = std::snprintf(text, sizeof text, "of %.0f s the first %.0f s are %s", seconds, used.first,
                                   use == Use::held_out ? "held out" : "fitted");
  if (used.last > 0.0) {
    std::snprintf(text + length, sizeof text - static_cast<std::size_t>(length), ", the last %.0f s held out",
                  used.last);
  }
  return text;
}

PreparedData prepare(const firmware::RigDescription& description, std::vector<Record> records) {
  PreparedData data;
  const std::vector<std::string> left_out = leave_out_the_middle(records);
  std::vector<firmware::Recording*> recordings;
  for (Record& record : records) recordings.push_back(&record.recording);
  data.remarks = validate(description, recordings);
  data.remarks.insert(data.remarks.end(), left_out.begin(), left_out.end());
  // What one recording shows of the sensors holds for all: they are explained with the same channels.
  std::vector<SampledRecording> all;
  for (Record& record : records) all.push_back(sampled(description, std::move(record.recording)));
  const bool disagree = std::any_of(all.begin(), all.end(),
                                    [&](const SampledRecording& one) { return inputs_disagree(description, one); });
  for (std::size_t i = 0; i < all.size(); ++i) {
    data.recordings.push_back(prepare_recording(description, std::move(all[i]), records[i].use, disagree));
    add_remarks(data.recordings.back(), data.remarks);
  }
  check_channels(data.recordings);
  if (std::all_of(data.recordings.begin(), data.recordings.end(), [](const auto& r) { return r.fitted.size() == 0; })) {
    throw firmware::InputError(description.source, 0, "every recording is held out", "one to be explained");
  }
  if (description.rig.kind == model::RigKind::hil) {
    data.remarks.emplace_back(
        "hil: machine and component are compared on the recorded x_cmd; the virtual car is computed, hence exact");
  }
  return data;
}

}  // namespace host_sim::identification
