// RPC III time histories (.rsp, .drv, .tim), the format of chassis rigs.
#pragma once

#include <string_view>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// Whether a file begins with the first record of an RPC III header.
[[nodiscard]] bool is_rpc(std::string_view head);

/// The channels of a time history. The header is NUM_HEADER_BLOCKS blocks of 512 bytes with NUM_PARAMS records of 128
/// (key 32, value 96); the data behind it are groups of PTS_PER_GROUP points, in a group one channel after the other.
///
///   value = count × SCALE.CHAN_n   16-bit counts;   32-bit floats as they are          t = k DELTA_T
///
/// The type is DATA_TYPE, or SHORT_INTEGER where it is absent; where the file has the size of the other type, that one.
/// InputError: another FILE_TYPE, data as text, a header that contradicts itself. A file that is cut off has what is
/// there.
[[nodiscard]] RawTable table_of_rpc(std::string_view bytes, std::string_view source);

}  // namespace host_sim
