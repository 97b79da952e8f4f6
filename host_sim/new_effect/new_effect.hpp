// A new effect of the catalogue, as texts for a source tree.
#pragma once

#include <filesystem>
#include <string>

namespace host_sim::new_effect {

/// A file that is to be written.
struct SourceFile {
  std::filesystem::path path;
  std::string text;
};

/// What a new effect adds to a source tree.
struct NewEffect {
  std::string type;      ///< name of its struct: HelperSpring
  SourceFile effect;     ///< equation, parameters, card and law
  SourceFile test;       ///< a point by hand, and rest
  SourceFile catalogue;  ///< the list, with #include and entry
};

/// The texts for effect `name` (helper_spring) in the source tree at `tree`. Nothing is written.
///
/// UsageError: `name` is no lower-case identifier of letters, digits and single underscores. InputError: `tree` is no
/// source tree of rigtwin, or its list cannot be read. OutputError: the tree has a file, an effect or a type of that
/// name.
[[nodiscard]] NewEffect prepare(const std::string& name, const std::filesystem::path& tree);

}  // namespace host_sim::new_effect
