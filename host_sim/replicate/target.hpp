// What a rig shall do: the target of a replication.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"

namespace host_sim::replicate {

/// Frequencies that are replicated [Hz].
struct FrequencyBand {
  double lowest = 0.0, highest = 0.0;

  /// 1 inside, 0 outside, half a cosine at the edges, which lie within 1 ± thresholds::band_edge of the limits.
  [[nodiscard]] double weight(double frequency) const;
};

struct TargetChannel {
  model::Channel channel;
  double weight = 1.0;  ///< of its relative error
  FrequencyBand band{};
  std::string remark{};  ///< why the band is what it is, where it was not given; empty: it was
};

/// Samples [from, to).
struct Part {
  std::size_t from, to;
};

/// The channels at the rig's rate, with the motion from and to rest before and after:
///
///   lead | event | blend | event | … | lead
///
/// In lead and blend an event goes on as its mirror image, faded by half a cosine. The error counts the events alone.
struct Target {
  double period = 0.0;
  std::vector<TargetChannel> channels;
  std::vector<std::vector<double>> values;  ///< by channel [SI]
  std::vector<Part> events;

  [[nodiscard]] std::size_t size() const { return values.empty() ? 0 : values.front().size(); }
};

/// How the target is asked for.
struct TargetRequest {
  std::vector<std::pair<model::Channel, double>> channels;                     ///< with weights
  std::vector<std::pair<std::optional<model::Channel>, FrequencyBand>> bands;  ///< of a channel, or of all others
};

/// "zdd_w,F_w:0.5" and "0.7:40" or "F_w=1:20". UsageError.
[[nodiscard]] TargetRequest parse_request(const std::string& channels, const std::vector<std::string>& bands);

/// InputError where a recording lacks a channel, runs at another rate than the rig, or is in units that no rig reaches;
/// UsageError where the rig has no such channel.
[[nodiscard]] Target make_target(const firmware::RigDescription& description, const TargetRequest& request,
                                 const std::vector<firmware::Recording>& recordings);

}  // namespace host_sim::replicate
