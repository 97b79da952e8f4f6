// A rig description as the text of a TOML file.
#pragma once

#include <string>

#include "host_sim/rig_description.hpp"

namespace host_sim {

/// The description with everything it says, numbers with the shortest decimals that read back to the same bits:
/// parse_rig(format_rig(d)) is d. Comments of the file it came from are not kept.
[[nodiscard]] std::string format_rig(const RigDescription& description);

}  // namespace host_sim
