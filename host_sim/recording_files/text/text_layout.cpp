#include "host_sim/recording_files/text/text_layout.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <utility>

#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/text/text_fields.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

using firmware::trimmed;

// Lines at the begin of a file that decide its separators: beyond preambles of a few hundred lines, and quick.
constexpr std::size_t lines_to_judge = 2000;
// A number with thousands separators counts less than one without: "1,500" between semicolons is one and a half.
constexpr double weak_weight = 0.9;

struct Score {
  double numbers = 0.0;
  std::size_t columns = 0;
};

// Whether fields look like a row: two or more, numbers or clocks among them, text only a minority.
bool looks_like_row(const std::vector<std::string>& fields, char decimal, double& numbers) {
  std::size_t text = 0;
  std::size_t values = 0;
  numbers = 0.0;
  for (const std::string& field : fields) {
    switch (kind_of_field(field, decimal)) {
      case FieldKind::number:
      case FieldKind::clock:
        numbers += 1.0;
        ++values;
        break;
      case FieldKind::weak_number:
        numbers += weak_weight;
        ++values;
        break;
      case FieldKind::text:
        ++text;
        break;
      case FieldKind::missing:
        break;
    }
  }
  return values >= 1 && values + (fields.size() - text - values) > text && 2 * text <= fields.size();
}

Score score_of(const std::vector<std::string_view>& lines, TextSeparators separators) {
  std::map<std::size_t, double> by_columns;
  for (std::size_t i = 0; i < std::min(lines.size(), lines_to_judge); ++i) {
    const std::vector<std::string> fields = split_fields(lines[i], separators.column);
    double numbers = 0.0;
    if (fields.size() >= 2 && looks_like_row(fields, separators.decimal, numbers)) by_columns[fields.size()] += numbers;
  }
  Score best;
  for (const auto& [columns, numbers] : by_columns) {
    if (numbers > best.numbers) best = {numbers, columns};
  }
  return best;
}

// The row with one empty field too many or too few counts as well: separators behind the last value.
bool fits(std::size_t fields, std::size_t columns) {
  return fields == columns || fields == columns + 1 || fields + 1 == columns;
}

// Whether the lines are single numbers, most of those behind the first one.
bool is_one_column(const std::vector<std::string_view>& lines) {
  std::size_t numbers = 0;
  std::size_t others = 0;
  for (std::size_t i = 0; i < std::min(lines.size(), lines_to_judge); ++i) {
    const std::string_view text = trimmed(lines[i]);
    if (text.empty() || is_comment(text)) continue;
    const bool number = read_text_number(text, '.') || read_text_number(text, ',');
    if (number) ++numbers;
    if (!number && numbers > 0 && !is_missing_value(text)) ++others;
  }
  return numbers >= 2 && others * 10 < numbers;
}

// Whether the lines are single numbers with a decimal comma: behind it stand digits alone, equally many in most lines,
// and in some of them a zero first, with which no whole number begins.
bool is_one_column_with_commas(const std::vector<std::string_view>& lines) {
  std::map<std::size_t, std::size_t> by_decimals;
  std::size_t rows = 0;
  bool zero_first = false;
  for (std::size_t i = 0; i < std::min(lines.size(), lines_to_judge); ++i) {
    const std::string_view text = trimmed(lines[i]);
    const std::size_t comma = text.find(',');
    if (text.empty() || is_comment(text) || text.find_first_not_of("0123456789,-+") != std::string_view::npos) continue;
    if (comma == std::string_view::npos || text.find_first_of(",-+", comma + 1) != std::string_view::npos) continue;
    const std::string_view behind = text.substr(comma + 1);
    ++rows;
    ++by_decimals[behind.size()];
    zero_first = zero_first || (behind.size() > 1 && behind.front() == '0');
  }
  return zero_first && rows >= 3 && std::any_of(by_decimals.begin(), by_decimals.end(), [&](const auto& one) {
           return one.first >= 2 && 10 * one.second >= 8 * rows;
         });
}

void find_column_kinds(const std::vector<std::string_view>& lines, TextLayout& layout) {
  std::vector<std::size_t> numbers(layout.columns);
  std::vector<std::size_t> clocks(layout.columns);
  std::vector<std::size_t> texts(layout.columns);
  for (std::size_t i = 0; i < std::min(lines.size(), lines_to_judge); ++i) {
    const std::vector<std::string> fields = split_fields(lines[i], layout.separators.column);
    double value = 0.0;
    if (fields.size() != layout.columns || !looks_like_row(fields, layout.separators.decimal, value)) continue;
    for (std::size_t c = 0; c < layout.columns; ++c) {
      switch (kind_of_field(fields[c], layout.separators.decimal)) {
        case FieldKind::number:
        case FieldKind::weak_number:
          ++numbers[c];
          break;
        case FieldKind::clock:
          ++clocks[c];
          break;
        case FieldKind::text:
          ++texts[c];
          break;
        case FieldKind::missing:
          break;
      }
    }
  }
  layout.is_value.resize(layout.columns);
  layout.is_clock.resize(layout.columns);
  for (std::size_t c = 0; c < layout.columns; ++c) {
    layout.is_clock[c] = clocks[c] > numbers[c] && clocks[c] > texts[c];
    layout.is_value[c] = layout.is_clock[c] || numbers[c] > texts[c];
  }
}

bool is_first_row(std::string_view line, const TextLayout& layout) {
  const std::vector<std::string> fields = split_fields(line, layout.separators.column);
  double numbers = 0.0;
  if (!fits(fields.size(), layout.columns) || !looks_like_row(fields, layout.separators.decimal, numbers)) return false;
  for (std::size_t c = 0; c < std::min(fields.size(), layout.columns); ++c) {
    if (layout.is_value[c] && kind_of_field(fields[c], layout.separators.decimal) == FieldKind::text) return false;
  }
  return true;
}

// The sign that a number of the first lines shows beyond doubt, of most such numbers.
char find_stated_decimal(const std::vector<std::string_view>& lines, const TextLayout& layout) {
  std::size_t points = 0;
  std::size_t commas = 0;
  for (std::size_t i = layout.first_row; i < std::min(lines.size(), layout.first_row + lines_to_judge); ++i) {
    const std::vector<std::string> fields = split_fields(lines[i], layout.separators.column);
    if (fields.size() != layout.columns) continue;
    for (std::size_t c = 0; c < layout.columns; ++c) {
      if (!layout.is_value[c] || layout.is_clock[c]) continue;
      const DecimalEvidence evidence = decimal_evidence(fields[c]);
      points += evidence == DecimalEvidence::point ? 1 : 0;
      commas += evidence == DecimalEvidence::comma ? 1 : 0;
    }
  }
  if (points == commas) return '\0';
  return points > commas ? '.' : ',';
}

bool in_brackets(std::string_view field) {
  return field.size() >= 2 &&
         ((field.front() == '[' && field.back() == ']') || (field.front() == '(' && field.back() == ')'));
}

// "[mm]", "(kN)", "mm", "V", "-": a field of a row of units.
bool is_unit_field(std::string_view field) {
  field = trimmed(field);
  return in_brackets(field) || firmware::find_unit(field).has_value() || firmware::is_unit(field);
}

std::string without_brackets(std::string_view field) {
  field = trimmed(field);
  if (in_brackets(field)) field = trimmed(field.substr(1, field.size() - 2));
  return std::string(field);
}

// Whether the fields are units: at least one is, and of the others not more are longer than unknown units are. Without
// names above them (`alone`) letters such as V and A may be names themselves.
bool is_row_of_units(const std::vector<std::string>& fields, bool alone) {
  constexpr std::size_t longest_unknown = 6;  // "mV/Vex"; names of one line are mostly longer
  std::size_t units = 0;
  std::size_t unknown = 0;
  std::size_t others = 0;
  for (const std::string& field : fields) {
    const std::string_view text = trimmed(field);
    if (text.empty()) continue;
    if (alone ? in_brackets(text) || firmware::find_unit(text).has_value() : is_unit_field(text)) {
      ++units;
    } else {
      (text.size() <= longest_unknown && !alone ? unknown : others) += 1;
    }
  }
  return units > 0 && 2 * others + unknown <= units;
}

// A header's comment sign is not part of its first name.
std::string_view without_comment_sign(std::string_view line) {
  line = trimmed(line);
  while (!line.empty() &&
         (line.front() == '#' || line.front() == '%' || line.front() == '!' || line.starts_with("//"))) {
    line.remove_prefix(line.front() == '/' ? 2 : 1);
  }
  return trimmed(line);
}

// Headings with commas between commas: a unit in brackets ends a heading ("Force, filtered [N],Position [mm]").
std::vector<std::string> joined_at_units(const std::vector<std::string>& fields, char column) {
  std::vector<std::string> joined;
  bool open = false;
  for (const std::string& field : fields) {
    if (open) {
      joined.back() += std::string(1, column) + " " + field;
    } else {
      joined.push_back(field);
    }
    open = !field.ends_with(']') && !field.ends_with(')');
  }
  return open ? std::vector<std::string>{} : joined;
}

// Fields of a line above the table; between blanks a line of names in quotes or with another separator is taken too.
std::vector<std::string> header_fields(std::string_view line, const TextLayout& layout) {
  std::vector<std::string> fields = split_fields(without_comment_sign(line), layout.separators.column);
  if (fields.size() == layout.columns) return fields;
  if (fields.size() > layout.columns) {
    std::vector<std::string> joined = joined_at_units(fields, layout.separators.column);
    if (joined.size() == layout.columns) return joined;
  }
  fields = split_fields(line, layout.separators.column);
  if (fits(fields.size(), layout.columns)) return fields;
  fields = split_fields(without_comment_sign(line), layout.separators.column);
  if (fits(fields.size(), layout.columns)) return fields;
  for (const char column : {'\t', ';', ','}) {
    std::vector<std::string> other = split_fields(without_comment_sign(line), column);
    if (other.size() == layout.columns) return other;
  }
  return {};
}

// A line of units in the preamble, behind its label: "Y_Unit_Label\tmm\tkN" of LabVIEW, "Einheit;s;mm;kN".
void find_labelled_units(const std::vector<std::string_view>& lines, std::size_t begin, TextLayout& layout) {
  constexpr std::array<std::string_view, 6> labels{"Y_Unit_Label", "Unit", "Units", "Einheit", "Einheiten", "EngUnits"};
  for (std::size_t i = begin; i < layout.preamble_end; ++i) {
    std::vector<std::string> fields = split_fields(without_comment_sign(lines[i]), layout.separators.column);
    if (fields.size() < 2 || std::find(labels.begin(), labels.end(), fields.front()) == labels.end()) continue;
    while (!fields.empty() && fields.back().empty()) fields.pop_back();
    if (!is_row_of_units({fields.begin() + 1, fields.end()}, false)) continue;
    // The label stands above the time, or before the first column.
    if (fields.size() > layout.columns) {
      fields.erase(fields.begin());
    } else {
      fields.front().clear();
    }
    for (const std::string& field : fields) layout.units.push_back(without_brackets(field));
    return;
  }
}

// "SR=1000 Hz", "ID 0": fields that say something of each column, and are no names of columns.
bool says_rates(const std::vector<std::string>& fields) {
  return std::all_of(fields.begin(), fields.end(), [](const std::string& field) {
    const std::string_view text = trimmed(field);
    return text.empty() || text.find('=') != std::string_view::npos;
  });
}

// "-----", "|---|---|", "=====": a line that is drawn below a header.
bool is_ruler(std::string_view line) {
  if (line.find_first_not_of("-=_+|:;, \t") != std::string_view::npos) return false;
  // "-;-;-" is a row of units.
  return line.find("--") != std::string_view::npos || line.find("==") != std::string_view::npos ||
         line.find("__") != std::string_view::npos;
}

bool is_row_of_names(const std::vector<std::string>& fields, const TextLayout& layout) {
  const auto filled =
      std::count_if(fields.begin(), fields.end(), [](const std::string& f) { return !trimmed(f).empty(); });
  return 2 * static_cast<std::size_t>(filled) >= layout.columns && !says_rates(fields);
}

}  // namespace

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//") || line.starts_with('!') ||
         line.starts_with('\'');
}

std::vector<std::string> split_fields(std::string_view line, char column) {
  FieldSplitter splitter;
  const std::vector<std::string_view>& fields = splitter.split(line, column);
  return {fields.begin(), fields.end()};
}

FieldKind kind_of_field(std::string_view field, char decimal) {
  if (const std::optional<TextNumber> number = read_text_number(field, decimal)) {
    if (is_compact_stamp(field)) return FieldKind::clock;
    return number->weak ? FieldKind::weak_number : FieldKind::number;
  }
  if (is_missing_value(field)) return FieldKind::missing;
  if (read_number_with_unit(field, decimal)) return FieldKind::number;
  return read_clock_time(field) ? FieldKind::clock : FieldKind::text;
}

namespace {

// Whether the first field of the rows counts them, in quotes or not: 1, 2, 3 …
bool first_column_counts(const std::vector<std::string_view>& lines, const TextLayout& layout) {
  std::optional<double> before;
  std::size_t rows = 0;
  for (std::size_t i = layout.first_row; i < lines.size() && rows < 20; ++i) {
    const std::vector<std::string> fields = split_fields(lines[i], layout.separators.column);
    if (fields.size() != layout.columns) continue;
    const std::optional<TextNumber> number = read_text_number(fields.front(), layout.separators.decimal);
    if (!number || (before && number->value != *before + 1.0)) return false;
    before = number->value;
    ++rows;
  }
  return rows >= 3;
}

}  // namespace

void find_header(const std::vector<std::string_view>& lines, std::size_t begin, TextLayout& layout) {
  constexpr std::size_t most_lines = 8;  // of a header
  layout.preamble_end = layout.first_row;
  layout.names.clear();
  layout.units.clear();
  layout.header_line = 0;
  // The lines above the row that have its number of fields, the nearest first.
  std::vector<std::pair<std::size_t, std::vector<std::string>>> above;
  for (std::size_t i = layout.first_row; i-- > begin && i + most_lines > layout.first_row;) {
    if (trimmed(lines[i]).empty()) continue;
    if (is_ruler(lines[i])) continue;
    std::vector<std::string> fields = header_fields(lines[i], layout);
    if (fields.empty()) {
      if (above.empty() && !is_comment(lines[i])) {
        const std::size_t count = split_fields(lines[i], layout.separators.column).size();
        if (count > 1)
          layout.header_trouble = "line " + std::to_string(i + 1) + " has " + std::to_string(count) +
                                  " fields, the rows " + std::to_string(layout.columns);
      }
      break;
    }
    fields.front() = std::string(without_comment_sign(fields.front()));
    above.emplace_back(i, std::move(fields));
  }
  // Names stand above units; without units right above the rows.
  auto units = above.end();
  for (auto line = above.begin(); line != above.end() && units == above.end(); ++line) {
    const auto next = std::next(line);
    const bool names_above = next != above.end() && is_row_of_names(next->second, layout);
    if (is_row_of_units(line->second, !names_above) && (line == above.begin() || names_above)) units = line;
  }
  if (units != above.end()) {
    for (const std::string& field : units->second) layout.units.push_back(without_brackets(field));
    layout.preamble_end = units->first;
  }
  const auto names = std::find_if(units == above.end() ? above.begin() : std::next(units), above.end(),
                                  [&](const auto& line) { return is_row_of_names(line.second, layout); });
  if (names != above.end()) {
    layout.header_fields = names->second.size();
    layout.names = std::move(names->second);
    layout.header_line = names->first + 1;
    layout.preamble_end = names->first;
    layout.header_trouble.clear();
  }
  if (layout.units.empty()) find_labelled_units(lines, begin, layout);
  for (std::string& name : layout.names) name = std::string(trimmed(name));
  if (!layout.names.empty() && layout.header_fields + 1 == layout.columns && first_column_counts(lines, layout)) {
    // The rows are numbered, and the numbers have no name (R's row names).
    layout.names.insert(layout.names.begin(), "");
    if (!layout.units.empty()) layout.units.insert(layout.units.begin(), "");
  }
  layout.names.resize(layout.columns);
  layout.units.resize(layout.units.empty() ? 0 : layout.columns);
  for (std::size_t c = 0; c < layout.columns; ++c) {
    if (layout.names[c].empty()) layout.names[c] = "column " + std::to_string(c + 1);
  }
}

bool is_table_row(std::string_view line, const TextLayout& layout) {
  const std::vector<std::string> fields = split_fields(line, layout.separators.column);
  std::size_t numbers = 0;
  std::size_t texts = 0;
  bool first = true;
  for (std::size_t c = 0; c < std::min(fields.size(), layout.columns); ++c) {
    if (!layout.is_value[c]) continue;
    // Which decimal sign a column has may turn out later than here.
    FieldKind kind = kind_of_field(fields[c], layout.separators.decimal);
    if (kind == FieldKind::text) kind = kind_of_field(fields[c], layout.separators.decimal == '.' ? ',' : '.');
    if (first && kind == FieldKind::text) return false;
    first = false;
    numbers += kind == FieldKind::number || kind == FieldKind::weak_number || kind == FieldKind::clock ? 1 : 0;
    texts += kind == FieldKind::text ? 1 : 0;
  }
  return numbers > 0 && texts <= numbers;
}

TextLayout find_layout(const std::vector<std::string_view>& lines) {
  constexpr std::array<TextSeparators, 10> candidates{{{';', ','},
                                                       {';', '.'},
                                                       {'\t', '.'},
                                                       {'\t', ','},
                                                       {',', '.'},
                                                       {'|', '.'},
                                                       {'|', ','},
                                                       {' ', '.'},
                                                       {' ', ','},
                                                       {',', ','}}};
  TextLayout layout;
  double best = 0.0;
  for (const TextSeparators separators : candidates) {
    const Score score = score_of(lines, separators);
    if (score.columns < 2 || score.numbers <= best * 1.0001) continue;
    best = score.numbers;
    layout.separators = separators;
    layout.columns = score.columns;
  }
  const bool commas = layout.columns == 2 && layout.separators.column == ',' && is_one_column_with_commas(lines);
  if (commas) layout.columns = 0;
  if (layout.columns == 0 && !is_one_column(lines)) return layout;
  if (layout.columns == 0) {
    layout.columns = 1;
    layout.separators = {';', commas ? ',' : '.'};
  }
  find_column_kinds(lines, layout);
  layout.first_row = lines.size();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (is_comment(lines[i]) || !is_first_row(lines[i], layout)) continue;
    // Not a lone line of numbers in the preamble: the next line that is not empty is a row too.
    std::size_t next = i + 1;
    while (next < lines.size() && trimmed(lines[next]).empty()) ++next;
    if (next < lines.size() && !is_first_row(lines[next], layout) && next + 1 < lines.size()) continue;
    layout.first_row = i;
    break;
  }
  layout.stated_decimal = find_stated_decimal(lines, layout);
  if (layout.columns == 1 && layout.stated_decimal != '\0') layout.separators.decimal = layout.stated_decimal;
  find_header(lines, 0, layout);
  return layout;
}

}  // namespace host_sim
