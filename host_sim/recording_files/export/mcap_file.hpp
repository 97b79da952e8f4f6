// Recordings as MCAP files with JSON messages, for PlotJuggler and Foxglove.
#pragma once

#include <functional>
#include <string_view>

#include "firmware/recording/recording.hpp"

namespace host_sim {

/// Passes the bytes of an MCAP file to `take`: one topic "/rigtwin" with one JSON object per sample, keys "t" and the
/// columns' names, a missing value is null. Schema: JSON Schema with the units as descriptions. Chunks of one second or
/// 1 MiB without compression, each with its checksum and message index; chunk index and statistics in the summary, so
/// that viewers can seek.
///
/// Log time is the time stamp in whole nanoseconds; a recording that begins before 0 is shifted to begin at 0 (the
/// value of "t" is not). Source: MCAP specification, mcap.dev/spec, format version 0.
void format_mcap(const firmware::Recording& recording, const std::function<void(std::string_view)>& take);

}  // namespace host_sim
