// Texts that people write, read whole.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace firmware {

/// The bytes of a file of at most 1 MiB: a description has some hundred lines, and a device may never end. InputError
/// if it is a directory, cannot be read or is larger; `expected` says in the message what the file should be ("a rig
/// description in TOML").
[[nodiscard]] std::string read_small_text(const std::filesystem::path& file, std::string_view expected);

}  // namespace firmware
