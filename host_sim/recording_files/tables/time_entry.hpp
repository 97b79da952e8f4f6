// What a rig description says of the time of files that need more than the name of a column.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "firmware/description/values/channel_map.hpp"

namespace host_sim {

/// [channels] t = { column = "row number at 1000 Hz" }                          no column is the time
/// [channels] t = { column = "Zeit 2, 5 lines skipped", scale = 0.001 }         above the table stand lines that mislead
struct TimeEntry {
  std::optional<double> rate{};  ///< [Hz] the rows are samples at this rate
  std::size_t skip = 0;          ///< lines of text at the begin that are not looked at
};

/// Takes such an entry out of the map: what stays is the column's name, or nothing where a rate stands in its place.
[[nodiscard]] TimeEntry take_time_entry(firmware::ChannelMap& channels);

/// Writes the entry into the map, from which take_time_entry() reads it.
void put_time_entry(const TimeEntry& entry, firmware::ChannelMap& channels);

}  // namespace host_sim
