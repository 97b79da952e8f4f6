// Frequency responses for modal analysis programs: universal file format.
#pragma once

#include <string>

#include "host_sim/frf/response_estimate.hpp"

namespace host_sim::frf {

/// ASCII universal file, lines of at most 80 columns: dataset 164 (SI units), then for each output two datasets 58
/// (function at nodal DOF), the response (function type 4, complex, double precision) and its coherence (type 6, real):
///
///   record 6    2(I5,I10),2(1X,10A1,I10,I4)   type, number, version, load case; response and reference: channel name,
///               node (1 foot point, 2 wheel, 3 body, 4 tyre, 5 component or machine), direction 3 (+Z)
///   record 7    3I10,3E13.5                    6 or 4, points, 1: even spacing, first frequency and spacing [Hz]
///   record 8–11 I10,3I5,2(1X,20A1)             frequency; output; input; none: kind of quantity, exponents of length,
///               force and temperature, label, unit
///   record 12   4E20.12                        real and imaginary parts, or coherences
///
/// The format rounds frequencies to six digits. A delayed output has the phase −ωτ (convention e^{+jωt}). A response
/// that is not finite is written as 0 with coherence 0. Source: SDRC I-DEAS universal dataset 58, revision of 30 June
/// 1999, and 164.
[[nodiscard]] std::string to_universal_file(const Responses& responses);

}  // namespace host_sim::frf
