// Recordings as RPC III time histories, for the software of chassis rigs.
#pragma once

#include <functional>
#include <string_view>

#include "firmware/recording/recording.hpp"

namespace host_sim {

/// Passes the bytes of an RPC III file to `take`: 32-bit floats, one channel per column but t, names in DESC.CHAN_n and
/// units in UNITS.CHAN_n. The points of a frame are the largest power of two up to 1024 that divides the number of
/// rows, so that the frames end where the recording ends; the last group is filled with the last value. t begins at 0.
/// Missing rows and values are NaN. OutputError: the rows lie on no even grid.
void format_rpc(const firmware::Recording& recording, std::string_view file,
                const std::function<void(std::string_view)>& take);

}  // namespace host_sim
