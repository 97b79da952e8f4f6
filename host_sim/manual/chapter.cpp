#include "host_sim/manual/chapter.hpp"

#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::manual {
namespace {

constexpr std::string_view fence = "```";

class ChapterReader {
 public:
  ChapterReader(std::string_view text, const std::string& file, const std::set<std::string>& known)
      : rest_(text), known_(known) {
    chapter_.file = file;
  }

  [[nodiscard]] Chapter read() {
    std::string_view line;
    if (!next(line) || !line.starts_with("# ")) fail("does not begin with a title", "# Title");
    chapter_.title = line.substr(2);
    while (next(line)) take(line);
    if (block_begin_ > 0) fail_at(block_begin_, "begins a block that does not end", "``` on a line of its own");
    if (condition_) fail("ends inside of <!-- if", "<!-- end -->");
    if (excerpt_) fail_at(chapter_.parts[*excerpt_].line, "has no excerpt", "a block ```text behind it");
    return std::move(chapter_);
  }

 private:
  bool next(std::string_view& line) {
    if (rest_.empty()) return false;
    const std::size_t end = rest_.find('\n');
    line = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    ++number_;
    return true;
  }

  void take(std::string_view line) {
    if (block_begin_ == 0 && line.starts_with("<!--")) {
      directive(line);
    } else if (!condition_.value_or(true)) {
      return;
    } else if (line.starts_with(fence)) {
      toggle_block(line);
    } else if (in_commands_) {
      chapter_.parts.back().text += std::string(line) + "\n";
    } else {
      if (in_excerpt_ && line != "…") chapter_.parts[*excerpt_].expected.emplace_back(line);
      add_text(line);
    }
  }

  void directive(std::string_view line) {
    constexpr std::string_view open = "<!-- if ", open_not = "<!-- if not ", close = " -->";
    const auto name = [&](std::string_view begin) {
      if (!line.ends_with(close) || condition_) fail("is no condition", "<!-- if NAME --> outside of another");
      return std::string(line.substr(begin.size(), line.size() - begin.size() - close.size()));
    };
    if (line == "<!-- end -->" && condition_) {
      condition_.reset();
    } else if (line.starts_with(open_not)) {
      condition_ = !known_.contains(name(open_not));
    } else if (line.starts_with(open)) {
      condition_ = known_.contains(name(open));
    } else if (line == "<!-- catalogue -->") {
      if (condition_.value_or(true)) chapter_.parts.push_back({.kind = Part::Kind::catalogue, .line = number_});
    } else {
      fail("is unknown", "<!-- if NAME -->, <!-- end --> or <!-- catalogue -->");
    }
  }

  void toggle_block(std::string_view line) {
    if (block_begin_ > 0) {
      if (!in_commands_) add_text(line);
      if (in_excerpt_) excerpt_.reset();
      block_begin_ = 0;
      in_commands_ = in_excerpt_ = false;
      return;
    }
    block_begin_ = number_;
    const std::string_view info = line.substr(fence.size());
    in_commands_ = info == "sh" || info.starts_with("sh ");
    if (!in_commands_) {
      in_excerpt_ = excerpt_ && info == "text";
      add_text(line);
      return;
    }
    if (excerpt_) fail("begins before the excerpt of the block above", "a block ```text");
    Part part{.kind = Part::Kind::commands, .line = number_};
    part.excerpt = info == "sh excerpt";
    if (!part.excerpt) part.shown = lines_of(info.substr(2));
    if (part.excerpt) excerpt_ = chapter_.parts.size();
    chapter_.parts.push_back(std::move(part));
  }

  std::size_t lines_of(std::string_view option) {
    constexpr std::string_view name = " lines=";
    if (option.empty()) return 0;
    std::size_t lines = 0;
    if (option.starts_with(name)) {
      const char* const end = option.data() + option.size();
      const auto read = std::from_chars(option.data() + name.size(), end, lines);
      if (read.ec == std::errc() && read.ptr == end && lines > 0) return lines;
    }
    fail("has an unknown option of a block", "```sh, ```sh lines=8 or ```sh excerpt");
  }

  void add_text(std::string_view line) {
    if (chapter_.parts.empty() || chapter_.parts.back().kind != Part::Kind::text) {
      chapter_.parts.push_back({.kind = Part::Kind::text, .line = number_});
    }
    chapter_.parts.back().text += std::string(line) + "\n";
  }

  [[noreturn]] void fail(std::string_view wrong, std::string_view expected) const { fail_at(number_, wrong, expected); }
  [[noreturn]] void fail_at(std::size_t line, std::string_view wrong, std::string_view expected) const {
    throw firmware::InputError(chapter_.file, line, wrong, expected);
  }

  std::string_view rest_;
  const std::set<std::string>& known_;
  Chapter chapter_;
  std::size_t number_ = 0;
  std::size_t block_begin_ = 0;  ///< line of the open block; 0: none
  bool in_commands_ = false;
  bool in_excerpt_ = false;
  std::optional<std::size_t> excerpt_;  ///< the part whose excerpt is still to come
  std::optional<bool> condition_;       ///< of the open <!-- if; false: left out
};

/// The last heading of a text, without its marks.
std::string last_heading(const std::string& text) {
  std::string heading;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    if (line.starts_with("## ")) heading = line.substr(3);
    at = end + 1;
  }
  return heading;
}

}  // namespace

Chapter parse_chapter(std::string_view text, const std::string& file, const std::set<std::string>& known) {
  return ChapterReader(text, file, known).read();
}

Chapter read_chapter(const std::filesystem::path& file, const std::set<std::string>& known) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw firmware::InputError(file.string(), 0, "cannot be read", "a chapter of the manual");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return parse_chapter(text, file.filename().string(), known);
}

std::string as_script(const Chapter& chapter) {
  std::string script = "#!/bin/sh -e\n# " + chapter.title + "\n";
  for (const Part& part : chapter.parts) {
    if (part.kind == Part::Kind::text) {
      const std::string heading = last_heading(part.text);
      if (!heading.empty()) script += "\n# " + heading + "\n";
    } else if (part.kind == Part::Kind::commands) {
      script += part.text;
    }
  }
  return script;
}

}  // namespace host_sim::manual
