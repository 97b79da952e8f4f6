// Samples of a rig that runs, collected to blocks.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"

namespace host_sim::live {

/// What a rig has said at one instant [SI]; NaN: nothing.
struct LiveSample {
  LiveSample();
  double time = 0.0;  ///< [s]
  std::array<double, model::channel_count> values{};
  std::array<double, firmware::recorded_ducts> ducts{};
};

/// Samples of a recording, with those on both sides that its motion needs.
struct Block {
  firmware::Recording recording;  ///< with the margins
  std::size_t from = 0, to = 0;   ///< the block: samples from + 1 … to of the recording
  /// By channel, of the block's samples: 1: not to be compared (no value, beyond its range). Empty: no such channel.
  std::array<std::vector<char>, model::channel_count> unused{};
  double begins = 0.0, ends = 0.0;  ///< [s]
  bool anew = false;                ///< it does not go on where the block before stopped

  [[nodiscard]] std::size_t size() const { return to - from; }
};

/// Blocks one behind the other. A gap up to thresholds::longest_gap is bridged by straight lines; behind a longer one,
/// or a clock that went back, blocks begin anew.
class BlockBuffer {
 public:
  explicit BlockBuffer(const firmware::RigDescription& description);

  void push(const LiveSample& sample);
  /// The next block, once the samples behind it are there.
  [[nodiscard]] std::optional<Block> take();

 private:
  void keep(const LiveSample& sample, bool recorded);
  [[nodiscard]] Block block() const;

  firmware::RigDescription description_;
  double period_;
  std::size_t samples_per_block_;
  struct Kept {
    LiveSample sample;
    bool recorded;
  };
  std::deque<Kept> kept_;
  bool anew_ = true;
};

}  // namespace host_sim::live
