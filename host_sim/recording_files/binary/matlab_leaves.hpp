// The contents of a MATLAB file, structures and cells included, through matio.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/recording_files/binary/isolated_reader.hpp"

namespace host_sim {

/// Every array and text of a MATLAB 5 or 7.3 file: variable "a" as "a", a field as "a.b", an element of a structure
/// array or cell as "a(2).b" and "a{2}" (a single element has no number), up to eight levels deep. In a child process.
/// InputError for damaged files: a crash or early end of the library, elements of a MATLAB 5 file that do not fill it,
/// fewer variables read than there are elements.
/// Objects, function handles and sparse matrices of the workspace are leaves of LeafKind::other with the reason as
/// text.
[[nodiscard]] std::vector<Leaf> read_matlab_leaves(const std::filesystem::path& file);

/// The bytes of each element of a MATLAB 5 file, in their order; none where the file is no such file or breaks off.
[[nodiscard]] std::vector<std::uint64_t> matlab_element_sizes(const std::filesystem::path& file);

/// Whether a file begins as one of MATLAB 4 does, and its matrices. InputError: it is cut off or damaged.
[[nodiscard]] bool is_matlab_4(std::string_view head);
[[nodiscard]] std::vector<Leaf> read_matlab_4_leaves(std::string_view bytes, std::string_view source);

}  // namespace host_sim
