// A TDMS file as a table.
#pragma once

#include <string_view>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// The channels of a TDMS file. Time: a channel of the group that is called time or holds time stamps, else the
/// waveform properties wf_start_offset and wf_increment (and wf_start_time, where channels began at different times).
/// Channels with different time axes keep their own. Units: property unit_string. Without these: a rate among the
/// properties of channel, group or file; without any the columns have no time, and the user may give one. InputError:
/// no channel with numbers.
[[nodiscard]] RawTable table_of_tdms(std::string_view bytes, std::string_view source);

}  // namespace host_sim
