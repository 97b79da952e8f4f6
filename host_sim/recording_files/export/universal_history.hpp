// Recordings as time histories in universal files, for programs of modal and noise analysis.
#pragma once

#include <functional>
#include <string_view>

#include "firmware/recording/recording.hpp"

namespace host_sim {

/// Passes an ASCII universal file to `take`: dataset 164 (SI units), then one dataset 58 per column, function type 1
/// (time response), real, double precision. ID line 1 holds the column's name, which record 6 cuts to ten letters. A
/// missing value is NaN.
///
/// The format keeps 13 digits of a value and six of the times. Equally spaced samples are written as first time and
/// period (reading back takes the whole rate in Hz that the six digits stand for), missing rows as NaN. Other stamps
/// stand beside the values; OutputError (for `file`) where six digits do not tell them apart.
void format_universal(const firmware::Recording& recording, std::string_view file,
                      const std::function<void(std::string_view)>& take);

}  // namespace host_sim
