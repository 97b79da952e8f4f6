// Measured frequency responses as a page.
#pragma once

#include <string>

#include "host_sim/frf/response_estimate.hpp"

namespace host_sim::frf {

/// "F_w ÷ z_r is largest at 12.6 Hz: 467 kN/m (95 %: 463 … 471), coherence 0.9997." One sentence an output.
[[nodiscard]] std::string sentence(const Responses& responses);

/// Magnitude and phase with 95 % bounds and coherence, a figure an output; what was chosen, as a table.
[[nodiscard]] std::string response_page(const Responses& responses);

}  // namespace host_sim::frf
