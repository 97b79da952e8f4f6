#include "host_sim/recording_files/text/text_layout.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

using firmware::trimmed;

// Lines at the begin of a file that decide its separators: beyond preambles of a few hundred lines, and quick.
constexpr std::size_t lines_to_judge = 2000;
// A number with thousands separators counts less than one without: "1,500" between semicolons is one and a half.
constexpr double weak_weight = 0.9;

std::vector<std::string> fields_without_last_separator(std::string_view line, char column) {
  std::vector<std::string> fields = split_fields(line, column);
  return fields;
}

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
  return fields.size() >= 2 && values >= 1 && values + (fields.size() - text - values) > text &&
         2 * text <= fields.size();
}

Score score_of(const std::vector<std::string_view>& lines, TextSeparators separators) {
  std::map<std::size_t, double> by_columns;
  for (std::size_t i = 0; i < std::min(lines.size(), lines_to_judge); ++i) {
    const std::vector<std::string> fields = fields_without_last_separator(lines[i], separators.column);
    double numbers = 0.0;
    if (looks_like_row(fields, separators.decimal, numbers)) by_columns[fields.size()] += numbers;
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

// "[mm]", "(kN)", "mm", "-", "": a field of a row of units.
bool is_unit_field(std::string_view field) {
  field = trimmed(field);
  if (field.size() >= 2 &&
      ((field.front() == '[' && field.back() == ']') || (field.front() == '(' && field.back() == ')'))) {
    return true;
  }
  return firmware::find_unit(field).has_value();
}

std::string without_brackets(std::string_view field) {
  field = trimmed(field);
  if (field.size() >= 2 && (field.front() == '[' || field.front() == '('))
    field = trimmed(field.substr(1, field.size() - 2));
  return std::string(field);
}

bool is_row_of_units(const std::vector<std::string>& fields) {
  std::size_t units = 0;
  std::size_t others = 0;
  for (const std::string& field : fields) {
    if (trimmed(field).empty()) continue;
    (is_unit_field(field) ? units : others) += 1;
  }
  return units > 0 && others * 2 <= units;  // one may be a label or a unit that is not known
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

// Fields of a line above the table; between blanks a line of names in quotes or with another separator is taken too.
std::vector<std::string> header_fields(std::string_view line, const TextLayout& layout) {
  std::vector<std::string> fields = split_fields(without_comment_sign(line), layout.separators.column);
  if (fields.size() == layout.columns) return fields;
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
void find_labelled_units(const std::vector<std::string_view>& lines, TextLayout& layout) {
  constexpr std::array<std::string_view, 6> labels{"Y_Unit_Label", "Unit", "Units", "Einheit", "Einheiten", "EngUnits"};
  for (std::size_t i = 0; i < layout.preamble_end; ++i) {
    std::vector<std::string> fields = split_fields(without_comment_sign(lines[i]), layout.separators.column);
    if (fields.size() < 2 || std::find(labels.begin(), labels.end(), fields.front()) == labels.end()) continue;
    while (!fields.empty() && fields.back().empty()) fields.pop_back();
    if (!is_row_of_units({fields.begin() + 1, fields.end()})) continue;
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

void find_header(const std::vector<std::string_view>& lines, TextLayout& layout) {
  layout.preamble_end = layout.first_row;
  std::vector<std::string> above;
  for (std::size_t i = layout.first_row; i-- > 0 && i + 8 > layout.first_row;) {
    if (trimmed(lines[i]).empty()) continue;
    std::vector<std::string> fields = header_fields(lines[i], layout);
    if (fields.empty()) break;
    fields.front() = std::string(without_comment_sign(fields.front()));
    if (layout.units.empty() && is_row_of_units(fields)) {
      for (const std::string& field : fields) layout.units.push_back(without_brackets(field));
      layout.preamble_end = i;
      continue;
    }
    // A line between names and rows that is neither (types, comments per column) is passed over when a unit row or
    // names stand above it.
    const auto filled =
        std::count_if(fields.begin(), fields.end(), [](const std::string& f) { return !trimmed(f).empty(); });
    if (2 * static_cast<std::size_t>(filled) < layout.columns) break;
    layout.header_fields = fields.size();
    layout.names = std::move(fields);
    layout.header_line = i + 1;
    layout.preamble_end = i;
    break;
  }
  if (layout.units.empty()) find_labelled_units(lines, layout);
  for (std::string& name : layout.names) name = std::string(trimmed(name));
  layout.names.resize(layout.columns);
  layout.units.resize(layout.units.empty() ? 0 : layout.columns);
  for (std::size_t c = 0; c < layout.columns; ++c) {
    if (layout.names[c].empty()) layout.names[c] = "column " + std::to_string(c + 1);
  }
}

}  // namespace

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return line.starts_with('#') || line.starts_with('%') || line.starts_with("//") || line.starts_with('!') ||
         line.starts_with('\'');
}

std::vector<std::string> split_fields(std::string_view line, char column) {
  std::vector<std::string> fields;
  const auto is_end = [&](char c) { return column == ' ' ? c == ' ' || c == '\t' : c == column; };
  if (column == ' ') line = trimmed(line);
  std::size_t i = 0;
  for (;;) {
    std::string field;
    while (i < line.size() && (line[i] == ' ' || (line[i] == '\t' && column != '\t'))) ++i;
    if (i < line.size() && line[i] == '"') {
      for (++i; i < line.size(); ++i) {
        if (line[i] == '"') {
          if (i + 1 >= line.size() || line[i + 1] != '"') break;
          ++i;
        }
        field += line[i];
      }
      while (i < line.size() && !is_end(line[i])) ++i;
    } else {
      const std::size_t begin = i;
      while (i < line.size() && !is_end(line[i])) ++i;
      field = std::string(trimmed(line.substr(begin, i - begin)));
    }
    fields.push_back(std::move(field));
    if (i >= line.size()) break;
    ++i;
  }
  return fields;
}

FieldKind kind_of_field(std::string_view field, char decimal) {
  if (const std::optional<TextNumber> number = read_text_number(field, decimal)) {
    return number->weak ? FieldKind::weak_number : FieldKind::number;
  }
  if (is_missing_value(field)) return FieldKind::missing;
  return read_clock_time(field) ? FieldKind::clock : FieldKind::text;
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
  if (layout.columns == 0) return layout;
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
  find_header(lines, layout);
  return layout;
}

}  // namespace host_sim
