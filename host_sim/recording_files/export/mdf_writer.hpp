// Recordings as MDF 4 files.
#pragma once

#include <functional>
#include <string_view>

#include "firmware/recording/recording.hpp"

namespace host_sim {

/// Passes the bytes of an MDF 4.10 file to `take`: one group, sorted, its records 64-bit floats, t the master, then the
/// channels and extra columns with their units; no compression. Missing values are NaN, times stay as recorded.
/// Source: ASAM MDF 4.2.0, "Measurement Data Format", 2019.
void format_mdf(const firmware::Recording& recording, const std::function<void(std::string_view)>& take);

}  // namespace host_sim
