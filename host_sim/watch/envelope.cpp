#include "host_sim/watch/envelope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace host_sim::watch {

void Envelope::begin(std::vector<std::string> channels) {
  channels_ = std::move(channels);
  intervals_.clear();
}

void Envelope::add(double time, const std::vector<std::pair<std::string, double>>& values) {
  constexpr double farthest = 1e12;  // [s]: an index beyond it is no clock's
  if (!(std::abs(time) < farthest)) return;
  const auto index = static_cast<std::int64_t>(std::floor(time / width_));
  if (!intervals_.empty() && index < intervals_.back().index) intervals_.clear();
  if (intervals_.empty() || index > intervals_.back().index) {
    const std::vector<double> nothing(channels_.size(), std::numeric_limits<double>::quiet_NaN());
    intervals_.push_back({index, nothing, nothing});
    if (intervals_.size() > capacity_) intervals_.pop_front();
  }
  Interval& interval = intervals_.back();
  for (const auto& [name, value] : values) {
    const auto found = std::find(channels_.begin(), channels_.end(), name);
    if (found == channels_.end()) continue;
    const auto c = static_cast<std::size_t>(found - channels_.begin());
    interval.low[c] = std::fmin(interval.low[c], value);  // of NaN and a number the number
    interval.high[c] = std::fmax(interval.high[c], value);
  }
}

}  // namespace host_sim::watch
