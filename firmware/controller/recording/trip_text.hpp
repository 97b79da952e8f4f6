// Why a rig is in safe, in words.
#pragma once

#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/loop/refusals.hpp"

namespace firmware::controller {

/// "force of F (25100, limit 2.5e+04)", "interlock door", "reference_ended".
[[nodiscard]] std::string trip_text(const Trip& trip, const RigDescription& rig);

/// One after the other, with "; " between them. Empty: none.
[[nodiscard]] std::string refusals_text(const Refusals& refusals, const RigDescription& rig);

}  // namespace firmware::controller
