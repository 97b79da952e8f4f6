// The last seconds of a run, thinned out without losing its peaks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

namespace host_sim::watch {

/// Lowest and highest value of each channel in each interval of equal width:
///
///   (1)  i = ⌊t/width⌋,  low_i = min v(t), high_i = max v(t)  over all samples of interval i
///
/// A page draws both, so a peak of one sample is seen however slowly the page is drawn. Intervals without a sample are
/// left out: a gap stays a gap. At most `capacity` intervals are kept, the oldest ones go.
class Envelope {
 public:
  struct Interval {
    std::int64_t index = 0;
    std::vector<double> low, high;  ///< by channel; NaN: no value
  };

  /// `width` of an interval [s].
  Envelope(double width, std::size_t capacity) : width_(width), capacity_(capacity) {}

  /// Forgets everything; from now on these channels.
  void begin(std::vector<std::string> channels);

  /// The samples of one instant [s] by name; unknown names are ignored. A time before the newest interval forgets
  /// everything before it: the clock has begun anew.
  void add(double time, const std::vector<std::pair<std::string, double>>& values);

  [[nodiscard]] const std::vector<std::string>& channels() const { return channels_; }
  /// Those that are complete (all but the newest), in order of time.
  [[nodiscard]] std::size_t complete() const { return intervals_.empty() ? 0 : intervals_.size() - 1; }
  [[nodiscard]] const Interval& operator[](std::size_t i) const { return intervals_[i]; }

 private:
  double width_;
  std::size_t capacity_;
  std::vector<std::string> channels_;
  std::deque<Interval> intervals_;
};

}  // namespace host_sim::watch
