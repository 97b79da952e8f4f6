// The page of a replication: what test engineers look at.
#pragma once

#include <string>

#include "host_sim/replicate/replication.hpp"

namespace host_sim::replicate {

/// Error by run; target against reached (before the first run: predicted) in time with the worst second first,
/// spectrum, level crossings; rainflow matrix and relative pseudo-damage of every channel; the limits that are used;
/// the drive.
[[nodiscard]] std::string report_page(const Replication& replication);

/// The same in some lines for a terminal.
[[nodiscard]] std::string summary(const Replication& replication);

/// "stopped: goal …", in one sentence.
[[nodiscard]] std::string stop_sentence(const Replication& replication);

}  // namespace host_sim::replicate
