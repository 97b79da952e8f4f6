// The results of a sweep as a page.
#pragma once

#include <string>

#include "host_sim/sweep/merge.hpp"

namespace host_sim::sweep {

/// A sentence on cases and failures; histograms of the numbers that a suspension is judged by; their mean over the two
/// settings that vary most, as a matrix; the table of spreads. `merged`: of this folder.
[[nodiscard]] std::string sweep_page(const Merged& merged);

/// "240 cases, 2 of them failed; rms_F_w from 431 to 552 N …"
[[nodiscard]] std::string sentence(const Merged& merged);

}  // namespace host_sim::sweep
