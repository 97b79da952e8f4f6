// Rig descriptions for tests: texts to be changed in one place, and the files that come with the project.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>

#include "firmware/description/rig_description.hpp"
#include "tests/support/rig_descriptions.hpp"

namespace support {

/// The root of the source tree.
inline const std::filesystem::path source{RIGTWIN_SOURCE_DIR};

/// Measurements and samples that stay outside the repository; tests without them are skipped.
inline const std::filesystem::path shared = source.parent_path() / "shared";

/// The description of a rig that comes with the project: "paper_hil_fdva", …
inline std::string rig_file(const std::string& name) { return source / "host_sim" / "rigs" / (name + ".toml"); }

/// The rig that it describes.
inline firmware::RigDescription rig(const std::string& name) { return firmware::read_rig(rig_file(name)); }

/// `text` with its one occurrence of `from` replaced.
inline std::string with(std::string_view text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string_view::npos) << "the text has no \"" << from << '"';
  if (at == std::string_view::npos) return std::string(text);
  EXPECT_EQ(text.find(from, at + 1), std::string_view::npos) << "the text has more than one \"" << from << '"';
  return std::string(text.substr(0, at)) + std::string(to) + std::string(text.substr(at + from.size()));
}

/// The number of the line in which `words` begin, from 1; 0: nowhere.
inline std::size_t line_of(std::string_view text, std::string_view words) {
  const std::size_t at = text.find(words);
  if (at == std::string_view::npos) return 0;
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

}  // namespace support
