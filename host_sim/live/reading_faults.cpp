#include "host_sim/live/reading_faults.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/live/thresholds.hpp"

namespace host_sim::live {

std::vector<ReadingChange> ReadingFaults::look_at(const LiveSample& sample) {
  std::vector<ReadingChange> changes;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    Followed& f = channels_[c];
    const double value = sample.values[c];
    if (!std::isfinite(value)) {
      if (f.seen && !f.bad && sample.time - f.last_at > thresholds::lost) {
        f.bad = true;
        changes.push_back({ReadingChange::Kind::lost, model::channel_at(c), f.last_at, sample.time});
      }
      continue;
    }
    if (!f.seen || value != f.last) {
      if (f.bad) changes.push_back({ReadingChange::Kind::returned, model::channel_at(c), sample.time, sample.time});
      f.bad = false;
      f.same_since = sample.time;
      f.moves = false;
    }
    f.seen = true;
    f.last = value;
    f.last_at = sample.time;
  }
  return changes;
}

std::vector<ReadingChange> ReadingFaults::compare(const Block& block, model::Channel channel,
                                                  const std::vector<double>& model, double deviation) {
  Followed& f = channels_[index(channel)];
  const auto& values = block.recording[channel];
  if (values.empty() || f.bad || !f.seen) return {};
  for (std::size_t k = 0; k < model.size(); ++k) {
    const std::size_t at = block.from + 1 + k;
    if (block.recording.time[at] < f.same_since) continue;  // of a value that has changed since
    f.low = f.moves ? std::min(f.low, model[k]) : model[k];
    f.high = f.moves ? std::max(f.high, model[k]) : model[k];
    f.moves = true;
  }
  if (block.ends - f.same_since < thresholds::stuck || !f.moves ||
      f.high - f.low < thresholds::stuck_move * deviation) {
    return {};
  }
  f.bad = true;
  return {{ReadingChange::Kind::stuck, channel, f.same_since, block.ends}};
}

}  // namespace host_sim::live
