#include "firmware/description/laws/law_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"

namespace firmware {
namespace {

constexpr std::string_view expected_row = "two columns of numbers: velocity or deflection, then force";

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\"";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// The separator of a line: the first of these that it has.
char separator_of(std::string_view line) {
  for (const char c : {';', '\t', ','}) {
    if (line.find(c) != std::string_view::npos) return c;
  }
  return ' ';
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(separator, begin), line.size());
    const std::string_view cell = without_blanks(line.substr(begin, end - begin));
    if (!(separator == ' ' && cell.empty())) cells.push_back(cell);
    begin = end + 1;
  }
  if (cells.size() == 3 && cells[2].empty()) cells.pop_back();  // a separator at the end of the line
  return cells;
}

std::optional<double> number_of(std::string_view cell, char separator) {
  std::string text(cell);
  if (separator == ';' || separator == '\t') std::replace(text.begin(), text.end(), ',', '.');
  const char* const first = text.data() + (text.size() > 1 && text[0] == '+' ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// The text in brackets of a header cell; empty: it has none.
std::string_view unit_in(std::string_view cell) {
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t begin = cell.find(open), end = cell.rfind(close);
    if (begin != std::string_view::npos && end != std::string_view::npos && begin < end) {
      return without_blanks(cell.substr(begin + 1, end - begin - 1));
    }
  }
  return {};
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, model::LawPlace place, model::LawOver over)
      : source_(file.string()), place_(place), over_(over) {}

  void line(std::string_view text) {
    ++line_;
    if (line_ == 1 && text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
    text = without_blanks(text);
    if (text.empty() || text.front() == '#') return;
    const char separator = separator_of(text);
    const auto cells = cells_of(text, separator);
    if (cells.size() != 2) fail("a row of " + std::to_string(cells.size()) + " columns", expected_row);
    const auto at = number_of(cells[0], separator), value = number_of(cells[1], separator);
    if (!at && !value && rows_.at.empty() && !has_header_) return header(cells);
    if (!at || !value) fail(in_quotes(at ? cells[1] : cells[0]) + " is not a number", expected_row);
    if (rows_.at.size() == model::curve_points) {
      fail("more than 33 points", "2 to 33; thin the table where it is straight");
    }
    rows_.at.push_back(*at * at_scale_);
    rows_.value.push_back(*value * value_scale_);
    lines_.push_back(line_);
  }

  LawPoints take() {
    if (rows_.at.size() < 2) {
      throw InputError(source_, 0, std::to_string(rows_.at.size()) + " points", "2 to 33 rows of two numbers");
    }
    if (rows_.at[1] < rows_.at[0]) {
      std::reverse(rows_.at.begin(), rows_.at.end());
      std::reverse(rows_.value.begin(), rows_.value.end());
      std::reverse(lines_.begin(), lines_.end());
    }
    for (std::size_t i = 1; i < rows_.at.size(); ++i) {
      if (rows_.at[i] > rows_.at[i - 1]) continue;
      throw InputError(source_, std::max(lines_[i], lines_[i - 1]), "the first column turns back or repeats",
                       "one value a row, in ascending or descending order");
    }
    return std::move(rows_);
  }

 private:
  void header(const std::vector<std::string_view>& cells) {
    has_header_ = true;
    if (place_ == model::LawPlace::sensor) return;  // both columns in the unit of the channel
    const bool velocity = over_ == model::LawOver::velocity;
    at_scale_ = velocity ? scale(cells[0], Dimension::velocity, "m/s, mm/s or cm/s: the law is over the velocity")
                         : scale(cells[0], Dimension::length, "m, mm or cm: the law is over the deflection");
    value_scale_ = scale(cells[1], Dimension::force, "N, kN or daN");
  }

  double scale(std::string_view cell, Dimension dimension, std::string_view expected) const {
    const std::string_view text = unit_in(cell);
    if (text.empty()) return 1.0;
    const std::optional<Unit> unit = find_unit(text);
    if (unit && unit->dimension == dimension) return unit->scale;
    fail("the unit " + in_quotes(text), expected);
  }

  [[noreturn]] void fail(std::string_view wrong, std::string_view expected) const {
    throw InputError(source_, line_, wrong, expected);
  }

  std::string source_;
  model::LawPlace place_;
  model::LawOver over_;
  std::size_t line_ = 0;
  bool has_header_ = false;
  double at_scale_ = 1.0, value_scale_ = 1.0;
  LawPoints rows_;
  std::vector<std::size_t> lines_;
};

}  // namespace

LawPoints read_law_file(const std::filesystem::path& file, model::LawPlace place, model::LawOver over) {
  std::error_code status;
  std::ifstream stream(file, std::ios::binary);
  if (std::filesystem::is_directory(file, status) || !stream) {
    throw InputError(file.string(), 0, "cannot be opened", "a readable table of two columns");
  }
  constexpr std::size_t longest = 1U << 16U;  // 33 rows and some comments; a device may never end
  std::string text(longest + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > longest) throw InputError(file.string(), 0, "is larger than 64 KiB", "2 to 33 rows of two numbers");
  Reader reader(file, place, over);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    reader.line(std::string_view(text).substr(begin, end - begin));
    begin = end + 1;
  }
  return reader.take();
}

std::filesystem::path law_file_path(std::string_view description, std::string_view file) {
  return std::filesystem::path(description).parent_path() / file;
}

}  // namespace firmware
