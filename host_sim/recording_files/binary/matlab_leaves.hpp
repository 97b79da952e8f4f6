// The contents of a MATLAB file, structures and cells included, through matio.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/recording_files/binary/isolated_reader.hpp"

namespace host_sim {

/// Every array and text of a MATLAB 5 or 7.3 file: variable "a" as "a", a field as "a.b", an element of a structure
/// array or cell as "a(2).b" and "a{2}" (a single element has no number), up to eight levels deep. In a child process.
/// InputError for damaged files: a crash or early end of the library, elements of a MATLAB 5 file that do not fill it,
/// fewer variables read than there are elements.
[[nodiscard]] std::vector<Leaf> read_matlab_leaves(const std::filesystem::path& file);

}  // namespace host_sim
