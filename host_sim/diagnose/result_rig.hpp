// The rig description that a diagnosis leaves.
#pragma once

#include <string>
#include <string_view>

#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// How the first line of such a file begins: one that begins otherwise is not ours to replace.
inline constexpr std::string_view result_rig_mark = "# rigtwin diagnose";

/// rig.toml: the description with the effects that were found and the refitted parameters, for every other command.
/// `given`: the file name of the description that was given.
[[nodiscard]] std::string result_rig(const RigDescription& found, std::string_view given);

}  // namespace host_sim::diagnose
