// The manual as one HTML page: chapters, the output of their commands, and a picture of each effect.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/manual/chapter.hpp"
#include "host_sim/manual/effect_pictures.hpp"
#include "host_sim/manual/workshop.hpp"

namespace host_sim::manual {

/// A block of commands that was run.
struct Executed {
  std::string file;
  std::size_t line = 0;
  std::string commands;
  Workshop::Ended ended{};
};

struct Manual {
  std::string html;
  std::vector<Executed> executed;
};

/// Runs the commands of all chapters in their order and writes the page. InputError, naming file and line of the
/// block, where a block does not end with status 0 or does not print its excerpt. `pictures` stand at <!-- catalogue
/// -->.
[[nodiscard]] Manual make_manual(const std::vector<Chapter>& chapters, Workshop& workshop,
                                 const std::vector<EffectPicture>& pictures);

/// The first line of an excerpt that the output does not hold behind the lines before it; empty: it holds all. Lines
/// are compared word by word, numbers within 2 %: libraries of other Debian releases round differently.
[[nodiscard]] std::string missing_line(const std::vector<std::string>& excerpt, const std::string& output);

/// Markdown with tables as HTML, its headings one level lower; HTML in it is shown, not obeyed.
[[nodiscard]] std::string markdown_html(const std::string& markdown);

/// What a page shows of a command's output: `lines` lines of it, then "…"; 0: all.
[[nodiscard]] std::string shown_output(const std::string& output, std::size_t lines);

}  // namespace host_sim::manual
