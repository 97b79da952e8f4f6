#include "firmware/recording/recording.hpp"

#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/unread_columns.hpp"

namespace firmware {
namespace {

// For a recording that may be changed and for one that may not.
template <class AnyRecording>
auto& column_of(AnyRecording& recording, Quantity quantity) {
  if (quantity == time_quantity) return recording.time;
  return quantity < first_duct ? recording.channels[quantity - 1] : recording.ducts[quantity - first_duct];
}

}  // namespace

const std::vector<double>& Recording::required(model::Channel channel, std::string_view purpose) const {
  if (!has(channel)) {
    throw InputError(source, 0, "there is no channel " + std::string(model::name(channel)),
                     "that channel: it " + std::string(purpose) + unread_columns(*this, channel));
  }
  return (*this)[channel];
}

Recording Recording::without_samples() const {
  Recording empty;
  empty.sample_period = sample_period;
  empty.comments = comments;
  empty.source = source;
  empty.remark = remark;
  empty.lost_rows = lost_rows;
  empty.gaps = gaps;
  empty.ignored_columns = ignored_columns;
  return empty;
}

const std::vector<double>& values(const Recording& recording, Quantity quantity) {
  return column_of(recording, quantity);
}

std::vector<double>& values(Recording& recording, Quantity quantity) { return column_of(recording, quantity); }

std::vector<double> sample_times(std::size_t count, double rate, std::size_t first) {
  std::vector<double> times(count);
  for (std::size_t k = 0; k < count; ++k) times[k] = static_cast<double>(first + k) / rate;
  return times;
}

}  // namespace firmware
