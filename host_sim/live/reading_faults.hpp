// Sensors that show nothing, or one value all the time: seen in the samples themselves.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host_sim/live/samples.hpp"

namespace host_sim::live {

/// What happened to a channel.
struct ReadingChange {
  enum class Kind : unsigned char { stuck, lost, returned } kind;
  model::Channel channel;
  double since, at;  ///< [s]
};

/// Follows every channel that has had values. Lost: none for thresholds::lost. Stuck: the same value, to the bit, for
/// thresholds::stuck while the model moved by thresholds::stuck_move standard deviations of what it leaves.
class ReadingFaults {
 public:
  /// The channels that `sample` completes a loss of, or that have values again.
  [[nodiscard]] std::vector<ReadingChange> look_at(const LiveSample& sample);

  /// A block of the model's motion: the channels that stand still in it. `deviation`: of what the model leaves.
  [[nodiscard]] std::vector<ReadingChange> compare(const Block& block, model::Channel channel,
                                                   const std::vector<double>& model, double deviation);

  [[nodiscard]] bool is_bad(model::Channel channel) const { return channels_[index(channel)].bad; }

 private:
  struct Followed {
    bool seen = false, bad = false;
    double last = 0.0;             ///< value
    double last_at = 0.0;          ///< [s] when there was one
    double same_since = 0.0;       ///< [s]
    double low = 0.0, high = 0.0;  ///< of the model since then
    bool moves = false;            ///< low and high hold something
  };
  std::array<Followed, model::channel_count> channels_{};
};

}  // namespace host_sim::live
