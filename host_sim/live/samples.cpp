#include "host_sim/live/samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host_sim/live/thresholds.hpp"

namespace host_sim::live {

using model::Channel;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Values with straight lines over those that are missing.
std::vector<double> bridged(std::vector<double> values) {
  std::size_t last = values.size();  // finite value before k
  for (std::size_t k = 0; k <= values.size(); ++k) {
    if (k < values.size() && !std::isfinite(values[k])) continue;
    const std::size_t first = last == values.size() ? 0 : last + 1;
    for (std::size_t i = first; i < k; ++i) {
      if (last == values.size()) {
        values[i] = k < values.size() ? values[k] : 0.0;
      } else if (k == values.size()) {
        values[i] = values[last];
      } else {
        values[i] =
            values[last] + (values[k] - values[last]) * static_cast<double>(i - last) / static_cast<double>(k - last);
      }
    }
    last = k;
  }
  return values;
}

/// F of a hil rig is not compared while its command stands still: the stroke does not say what a component that sticks
/// carries (identification/prepare/prepared_recording.cpp). Nine digits of a recording; two samples on either side.
void leave_out_standstill(const firmware::Recording& recording, std::size_t from, std::vector<char>& unused) {
  const std::vector<double>& command = recording[Channel::x_cmd];
  if (command.empty() || unused.empty()) return;
  constexpr double digits = 1e-9;
  constexpr std::size_t reach = 2;
  double largest = 0.0;
  for (const double x : command) largest = std::max(largest, std::abs(x));
  if (!(largest > 0.0)) return;
  for (std::size_t k = 0; k + 1 < command.size(); ++k) {
    if (std::abs(command[k + 1] - command[k]) > digits * largest) continue;
    for (std::size_t i = k - std::min(k, reach); i <= k + 1 + reach; ++i) {
      if (i > from && i - from - 1 < unused.size()) unused[i - from - 1] = 1;
    }
  }
}

}  // namespace

LiveSample::LiveSample() {
  values.fill(none);
  ducts.fill(none);
}

BlockBuffer::BlockBuffer(const firmware::RigDescription& description)
    : description_(description),
      period_(description.period()),
      samples_per_block_(static_cast<std::size_t>(std::lround(thresholds::block / description.period()))) {}

void BlockBuffer::push(const LiveSample& sample) {
  if (!kept_.empty()) {
    const double steps = (sample.time - kept_.back().sample.time) / period_;
    const bool bridgeable = steps > 0.5 && (steps - 1.0) * period_ <= thresholds::longest_gap;
    if (!bridgeable) {
      kept_.clear();
      anew_ = true;
    } else {
      const double before = kept_.back().sample.time;
      for (long missing = 1; missing < std::lround(steps); ++missing) {
        LiveSample gap;
        gap.time = before + static_cast<double>(missing) * period_;
        gap.ducts = kept_.back().sample.ducts;
        keep(gap, false);
      }
    }
  }
  keep(sample, true);
}

void BlockBuffer::keep(const LiveSample& sample, bool recorded) { kept_.push_back({sample, recorded}); }

std::optional<Block> BlockBuffer::take() {
  if (kept_.size() < samples_per_block_ + 2 * thresholds::margin + 1) return std::nullopt;
  Block next = block();
  next.anew = anew_;
  anew_ = false;
  kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(samples_per_block_));
  return next;
}

Block BlockBuffer::block() const {
  Block b;
  b.from = thresholds::margin;
  b.to = b.from + samples_per_block_;
  const std::size_t count = b.to + thresholds::margin + 1;
  firmware::Recording& r = b.recording;
  r.sample_period = period_;
  r.source = "live";
  for (std::size_t k = 0; k < count; ++k) r.time.push_back(kept_[k].sample.time);
  b.begins = r.time[b.from];
  b.ends = r.time[b.to];
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    std::vector<double> values;
    bool any = false;
    for (std::size_t k = 0; k < count; ++k) {
      values.push_back(kept_[k].sample.values[c]);
      any = any || std::isfinite(values.back());
    }
    if (!any) continue;
    const auto range = firmware::trusted_range(description_, c);
    std::vector<char>& unused = b.unused[c];
    unused.resize(b.size(), 0);
    for (std::size_t k = b.from + 1; k <= b.to; ++k) {
      if (!std::isfinite(values[k]) || (range && !range->holds(values[k]))) unused[k - b.from - 1] = 1;
    }
    r.channels[c] = bridged(std::move(values));
  }
  for (std::size_t d = 0; d < r.ducts.size(); ++d) {
    if (!std::isfinite(kept_.front().sample.ducts[d])) continue;
    for (std::size_t k = 0; k < count; ++k) r.ducts[d].push_back(kept_[k].sample.ducts[d]);
  }
  if (description_.rig.kind == model::RigKind::hil) {
    leave_out_standstill(r, b.from, b.unused[index(Channel::F)]);
  }
  return b;
}

}  // namespace host_sim::live
