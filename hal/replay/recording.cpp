#include "hal/replay/recording.hpp"

namespace hal::replay {

std::string_view Recording::check() const {
  if (time.empty()) return "a recording has at least one row";
  for (std::size_t row = 1; row < time.size(); ++row) {
    if (time[row] <= time[row - 1]) return "the time of a recording rises from row to row";
  }
  for (const Column& column : columns) {
    if (!column.values.empty() && column.values.size() != time.size()) return "a column has a value for each row";
    if (!column.taken.empty() && column.taken.size() != column.values.size())
      return "a column has a stamp for each value";
  }
  return {};
}

}  // namespace hal::replay
