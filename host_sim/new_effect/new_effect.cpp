#include "host_sim/new_effect/new_effect.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/report/embedded_files.hpp"

namespace host_sim::new_effect {
namespace {

namespace fs = std::filesystem;

void replace(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

void check_identifier(const std::string& name) {
  const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto part = [&](char c) { return lower(c) || (c >= '0' && c <= '9') || c == '_'; };
  const bool fits = name.size() >= 3 && name.size() <= 48 && lower(name.front()) && name.back() != '_' &&
                    std::all_of(name.begin(), name.end(), part) && name.find("__") == std::string::npos;
  if (fits) return;
  throw firmware::UsageError(
      "NAME is " + firmware::in_quotes(name) +
      ", expected 3 to 48 lower-case letters, digits and single underscores, as in helper_spring");
}

/// helper_spring → HelperSpring.
std::string type_name(const std::string& name) {
  std::string type;
  bool begins = true;
  for (const char c : name) {
    if (c != '_') type += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    begins = c == '_';
  }
  return type;
}

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw firmware::InputError(file.string(), 0, "cannot be read", "the source tree of rigtwin in --tree");
  }
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// Whether `text` declares a type of that name.
bool declares(const std::string& text, const std::string& type) {
  const auto word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (const std::string_view keyword : {"struct ", "class ", "using ", "concept "}) {
    const std::string declared = std::string(keyword) + type;
    for (std::size_t at = text.find(declared); at != std::string::npos; at = text.find(declared, at + 1)) {
      const std::size_t end = at + declared.size();
      if (end == text.size() || !word(text[end])) return true;
    }
  }
  return false;
}

/// OutputError if a header of model/ declares that type: the new one would not compile.
void check_type(const std::string& type, const fs::path& model) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(model)) {
    if (!entry.is_regular_file() || entry.path().extension() != ".hpp" || !declares(read(entry.path()), type)) continue;
    throw firmware::OutputError(entry.path().string(), "declares " + type + " already", "another NAME");
  }
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (begin < text.size()) lines.push_back(text.substr(begin));
  return lines;
}

constexpr std::string_view list_head = "using UsualEffects = Slots<";

/// The list of effects with one more entry.
class Catalogue {
 public:
  explicit Catalogue(const fs::path& file) : file_(file.string()), lines_(lines_of(read(file))) {}

  void include(const std::string& name) {
    const std::string added = "#include \"model/effects/" + name + ".hpp\"";
    std::size_t at = lines_.size();
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (!lines_[i].starts_with("#include \"model/effects/")) continue;
      if (lines_[i] < added) at = i + 1;
      if (lines_[i] > added && at == lines_.size()) at = i;
    }
    if (at == lines_.size()) trouble("includes no effect");
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(at), added);
  }

  /// Before the last entry, the comments behind the entries in one column.
  void list(const std::string& type) {
    const auto head =
        std::find_if(lines_.begin(), lines_.end(), [](const auto& l) { return l.starts_with(list_head); });
    if (head == lines_.end()) trouble("holds no list of effects");
    const auto last = std::find_if(head, lines_.end(), [](const auto& l) { return l.ends_with(">>;"); });
    std::vector<std::string> entries;
    for (auto line = head; line != lines_.end() && line <= last; ++line) {
      std::string entry = line->substr(list_head.size());
      const std::size_t end = entry.find("<S>");
      if (end == std::string::npos) trouble("has a line in its list that is no effect");
      entries.push_back(entry.substr(0, end));
    }
    if (last == lines_.end() || entries.empty()) trouble("holds a list of effects without an end");
    entries.insert(entries.end() - 1, type);
    const auto at = lines_.erase(head, last + 1);
    const std::vector<std::string> written = formatted(entries);
    lines_.insert(at, written.begin(), written.end());
  }

  [[nodiscard]] std::string text() const {
    std::string all;
    for (const std::string& line : lines_) all += line + "\n";
    return all;
  }

 private:
  static std::vector<std::string> formatted(const std::vector<std::string>& entries) {
    std::size_t longest = 0;
    for (std::size_t i = 0; i + 1 < entries.size(); ++i) longest = std::max(longest, entries[i].size());
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const bool last = i + 1 == entries.size();
      lines.push_back((i == 0 ? std::string(list_head) : std::string(list_head.size(), ' ')) + entries[i] +
                      (last ? "<S>>;" : "<S>," + std::string(longest - entries[i].size(), ' ') + "  //"));
    }
    return lines;
  }

  [[noreturn]] void trouble(const std::string& what) const {
    throw firmware::InputError(file_, 0, what, "the list of effects as rigtwin's source tree has it");
  }

  std::string file_;
  std::vector<std::string> lines_;
};

/// A text of this folder for an effect: @name@ helper_spring, @Type@ HelperSpring, @Words@ Helper spring.
std::string filled(std::string_view pattern, const std::string& name, const std::string& type) {
  std::string words = name;
  std::replace(words.begin(), words.end(), '_', ' ');
  std::string capital = words;
  capital.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(capital.front())));
  std::string text(embedded_file(pattern));
  replace(text, "@name@", name);
  replace(text, "@Type@", type);
  replace(text, "@Words@", capital);
  return text;
}

}  // namespace

NewEffect prepare(const std::string& name, const fs::path& tree) {
  check_identifier(name);
  const fs::path effects = tree / "model" / "effects", tests = tree / "tests" / "model" / "effects";
  std::error_code error;
  for (const fs::path& folder : {effects, tests}) {
    if (fs::is_directory(folder, error)) continue;
    throw firmware::InputError(tree.string(), 0, "is no source tree of rigtwin: it has no folder " + folder.string(),
                               "the folder of a clone in --tree");
  }
  NewEffect added;
  added.type = type_name(name);
  added.effect = {effects / (name + ".hpp"), filled("effect.hpp.in", name, added.type)};
  added.test = {tests / (name + "_test.cpp"), filled("effect_test.cpp.in", name, added.type)};
  Catalogue catalogue(effects / "catalogue.hpp");
  for (const SourceFile* file : {&added.effect, &added.test}) {
    if (fs::exists(file->path, error)) {
      throw firmware::OutputError(file->path.string(), "is there already", "the name of a new effect");
    }
  }
  check_type(added.type, tree / "model");
  catalogue.include(name);
  catalogue.list(added.type);
  added.catalogue = {effects / "catalogue.hpp", catalogue.text()};
  return added;
}

}  // namespace host_sim::new_effect
