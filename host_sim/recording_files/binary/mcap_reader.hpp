// MCAP logs with JSON messages as tables.
#pragma once

#include <string_view>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

[[nodiscard]] constexpr bool is_mcap(std::string_view head) { return head.starts_with("\x89MCAP0\r\n"); }

/// Each number of the JSON messages of a topic is a column, "pose.z" within objects; null and absent ones are NaN. Its
/// unit is the description that the schema gives, where that is a unit. The time of a topic is its member t, time or
/// timestamp where it rises, else the time at which the messages were logged. Left out and listed: topics in other
/// encodings, members that are no numbers. InputError: damaged, compressed chunks, no topic with numbers.
///
/// Source: MCAP format specification, version 0, of Foxglove, 2022.
[[nodiscard]] RawTable table_of_mcap(std::string_view bytes, std::string_view source);

}  // namespace host_sim
