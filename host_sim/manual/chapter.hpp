// A chapter of the manual: Markdown with commands that are run.
#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace host_sim::manual {

/// A part of a chapter.
struct Part {
  enum class Kind : unsigned char {
    text,       ///< Markdown
    commands,   ///< a block of shell commands, to be run in the order of the manual
    catalogue,  ///< the place of the pictures of all effects
  };
  Kind kind = Kind::text;
  std::string text{};
  std::size_t line = 0;                 ///< of its beginning in the file, from 1
  std::size_t shown = 0;                ///< lines of the output that are shown; 0: all
  bool excerpt = false;                 ///< the lines of the next block ```text are shown in the place of the output
  std::vector<std::string> expected{};  ///< these lines: the output must hold them in this order
};

struct Chapter {
  std::string file;  ///< for messages
  std::string title;
  std::vector<Part> parts;
};

/// Reads a chapter. Its first line is "# Title". A fenced block "```sh" holds commands; "```sh lines=8" shows 8 lines
/// of their output, and "```sh excerpt" the next block "```text", whose lines (but for "…") the output must hold. Other
/// fenced blocks are text. Lines of their own:
///
///   <!-- if NAME -->, <!-- if not NAME -->, <!-- end -->   what is between stands only where NAME is (not) in `known`
///   <!-- catalogue -->                                     the pictures
///
/// InputError with file and line for anything else that begins with "<!--", for a block without end, for a
/// missing title and for an excerpt without a block of text.
[[nodiscard]] Chapter parse_chapter(std::string_view text, const std::string& file, const std::set<std::string>& known);

/// The same of a file.
[[nodiscard]] Chapter read_chapter(const std::filesystem::path& file, const std::set<std::string>& known);

/// The commands of a chapter as a script for sh -e, each block behind its text's last heading.
[[nodiscard]] std::string as_script(const Chapter& chapter);

}  // namespace host_sim::manual
