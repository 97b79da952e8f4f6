// Files of the source tree that the build embeds in the program.
#pragma once

#include <string_view>

namespace host_sim {

/// The text of a file that host_sim/CMakeLists.txt names there, by its file name: "paper_linear.toml",
/// "plotly-cartesian.min.js". Another name is a std::logic_error.
[[nodiscard]] std::string_view embedded_file(std::string_view name);

}  // namespace host_sim
