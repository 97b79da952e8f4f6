// Writes a rig description as TOML.
#pragma once

#include <string>

#include "firmware/description/rig_description.hpp"

namespace firmware {

/// The complete description. Numbers have the shortest decimals that read back to the same bits, so
/// parse_rig(format_rig(d)) equals d. Comments of the original file are lost.
[[nodiscard]] std::string format_rig(const RigDescription& description);

}  // namespace firmware
