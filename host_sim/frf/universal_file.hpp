// Frequency responses for modal analysis programs: universal file format.
#pragma once

#include <string>

#include "host_sim/frf/response_estimate.hpp"

namespace host_sim::frf {

/// ASCII universal file: dataset 164 (SI units), then for each output two datasets 58 (recording_files/export/
/// universal_records.hpp), the response (function type 4, complex) and its coherence (type 6, real). Response and
/// reference are named by their channels.
///
/// The format rounds frequencies to six digits. A delayed output has the phase −ωτ (convention e^{+jωt}). A response
/// that is not finite is written as 0 with coherence 0.
[[nodiscard]] std::string to_universal_file(const Responses& responses);

}  // namespace host_sim::frf
