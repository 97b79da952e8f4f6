// modelDescription.xml of an FMU.
#pragma once

#include <string>
#include <string_view>

#include "firmware/description/rig_description.hpp"

namespace host_sim::fmu {

/// The rig description as it lies in the FMU: the user's own text, or, where laws stand in files of their own, the same
/// with their numbers inside.
[[nodiscard]] std::string description_in_fmu(const firmware::RigDescription& rig);

/// Of the standard. One library serves both.
enum class Version : unsigned char { fmi2, fmi3 };

/// modelDescription.xml by FMI 2.0.4 or 3.0 for co-simulation. `guid`, in FMI 3.0 the instantiation token: SHA-256 of
/// description_in_fmu(). It names no date: the same rig gives the same bytes.
[[nodiscard]] std::string model_description(const firmware::RigDescription& rig, std::string_view name,
                                            std::string_view guid, Version version);

}  // namespace host_sim::fmu
