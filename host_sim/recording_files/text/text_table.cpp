#include "host_sim/recording_files/text/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_layout.hpp"
#include "host_sim/recording_files/text/text_preamble.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

using firmware::in_quotes;
using firmware::InputError;

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t longest_text_line = std::size_t{1} << 20U;
constexpr double seconds_per_day = 86400.0;

std::vector<std::string_view> lines_of(std::string_view text, std::string_view source) {
  std::vector<std::string_view> lines;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find_first_of("\r\n", i), text.size());
    if (end - i > longest_text_line) {
      throw InputError(source, lines.size() + 1, "the line is longer than 1 MiB", "a text file, one row a sample");
    }
    lines.push_back(text.substr(i, end - i));
    i = end + 1;
    if (end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n') ++i;
  }
  return lines;
}

class TableReader {
 public:
  TableReader(std::vector<std::string_view> lines, std::string_view source) : lines_(std::move(lines)) {
    table_.source = source;
  }

  RawTable run() {
    layout_ = find_layout(lines_);
    if (layout_.columns == 0 || layout_.first_row >= lines_.size()) {
      throw InputError(table_.source, 0, "no table of numbers is found in the text",
                       "rows of numbers between semicolons, tabs, commas or blanks");
    }
    table_.format = format_text();
    table_.header_line = layout_.header_line;
    const std::vector<std::string_view> preamble(lines_.begin(),
                                                 lines_.begin() + static_cast<std::ptrdiff_t>(layout_.preamble_end));
    if (auto rate = find_rate(preamble)) {
      table_.rate = rate->rate;
      table_.rate_text = rate->text;
    }
    make_columns();
    for (std::size_t i = layout_.first_row; i < lines_.size(); ++i) read_line(i);
    finish_clocks();
    note_skipped();
    table_.rows = table_.lines.size();
    return std::move(table_);
  }

 private:
  [[nodiscard]] std::string format_text() const {
    const char column = layout_.separators.column;
    const std::string shown = column == '\t' ? "tabs" : column == ' ' ? "blanks" : std::string("'") + column + "'";
    return "text, columns separated by " + shown + ", decimal '" + layout_.separators.decimal + "'";
  }

  void make_columns() {
    for (std::size_t c = 0; c < layout_.columns; ++c) {
      const NameAndUnit heading = split_heading(layout_.names[c]);
      RawColumn column{heading.name};
      column.text = layout_.names[c];
      column.unit = heading.unit;
      const std::string below = layout_.units.empty() ? "" : layout_.units[c];
      const bool says_nothing = below.empty() || (firmware::find_unit(below) &&
                                                  firmware::find_unit(below)->dimension == firmware::Dimension::none);
      if (!below.empty() && (heading.unit.empty() || !says_nothing)) {
        column.unit = below;
        if (heading.unit.empty()) column.name = layout_.names[c];
      }
      column.is_clock = layout_.is_clock[c];
      column.decimals = 0;
      column.significant_digits = 0;
      table_.columns.push_back(std::move(column));
    }
  }

  void read_line(std::size_t i) {
    const std::string_view line = lines_[i];
    if (firmware::trimmed(line).empty() || firmware::trimmed(line) == "\x1a") {
      ++empty_;
      return;
    }
    std::vector<std::string> fields = split_fields(line, layout_.separators.column);
    // A separator behind the last value.
    while (fields.size() > layout_.columns && fields.back().empty()) fields.pop_back();
    std::size_t values = 0;
    std::size_t numbers = 0;
    std::size_t texts = 0;
    for (std::size_t c = 0; c < layout_.columns; ++c) {
      if (!layout_.is_value[c]) continue;
      ++values;
      if (c >= fields.size()) continue;
      const FieldKind kind = kind_of_field(fields[c], layout_.separators.decimal);
      numbers += kind == FieldKind::number || kind == FieldKind::weak_number || kind == FieldKind::clock ? 1 : 0;
      texts += kind == FieldKind::text ? 1 : 0;
    }
    const bool header = i + 1 != layout_.header_line && texts > 0 && numbers == 0;
    if (header || (texts > numbers) || (is_comment(line) && numbers < values)) {
      ++other_lines_;
      if (first_other_line_ == 0) first_other_line_ = i + 1;
      return;
    }
    if (numbers == 0) return;  // separators only: the last line of spreadsheets
    take_row(fields, i + 1);
  }

  void fault(std::size_t line, const std::string& wrong, const std::string& expected, bool says_missing = false) {
    table_.faults.push_back({line, wrong, expected, says_missing});
  }

  void take_row(const std::vector<std::string>& fields, std::size_t line) {
    table_.lines.push_back(line);
    if (fields.size() > std::max(layout_.columns, layout_.header_fields)) {
      fault(line, "the row has " + std::to_string(fields.size()) + " values",
            std::to_string(layout_.columns) + " as in the other rows");
    }
    for (std::size_t c = 0; c < layout_.columns; ++c) {
      RawColumn& column = table_.columns[c];
      if (!layout_.is_value[c]) continue;
      if (c >= fields.size()) {
        if (column.values.size() + 1 == table_.lines.size()) {
          column.values.push_back(no_value);
          if (table_.faults.empty() || table_.faults.back().line != line) {
            fault(line, "the row has " + std::to_string(fields.size()) + (fields.size() == 1 ? " value" : " values"),
                  std::to_string(layout_.columns) + " as in the other rows");
          }
        }
        continue;
      }
      column.values.push_back(column.is_clock ? clock_value(c, fields[c], line) : number_value(c, fields[c], line));
    }
  }

  double number_value(std::size_t c, const std::string& field, std::size_t line) {
    RawColumn& column = table_.columns[c];
    if (const std::optional<TextNumber> number = read_text_number(field, layout_.separators.decimal)) {
      column.decimals = std::max(column.decimals, number->decimals);
      column.significant_digits = std::max(column.significant_digits, number->significant_digits);
      return number->value;
    }
    fault(line, in_quotes(column.name) + (firmware::trimmed(field).empty() ? " is missing" : " is " + in_quotes(field)),
          "a number", is_missing_value(field) && !firmware::trimmed(field).empty());
    return no_value;
  }

  double clock_value(std::size_t c, const std::string& field, std::size_t line) {
    RawColumn& column = table_.columns[c];
    const std::optional<ClockTime> clock = read_clock_time(field);
    if (!clock) {
      fault(line, in_quotes(column.name) + " is " + in_quotes(field), "a time of day");
      return no_value;
    }
    column.decimals = std::max(column.decimals, clock->decimals);
    column.significant_digits = 17;
    clocks_.resize(layout_.columns);
    ClockColumn& state = clocks_[c];
    if (!state.first_day) state.first_day = clock->day;
    // Without a date a clock that falls by more than half a day has passed midnight.
    if (!clock->has_date && clock->seconds < state.last - 0.5 * seconds_per_day) ++state.midnights;
    state.last = clock->seconds;
    state.dates_only = state.dates_only && !clock->has_time;
    return clock->seconds + seconds_per_day * static_cast<double>(clock->day - *state.first_day + state.midnights);
  }

  // A column of dates beside one of times is no time axis.
  void finish_clocks() {
    for (std::size_t c = 0; c < clocks_.size(); ++c) {
      RawColumn& column = table_.columns[c];
      if (!column.is_clock || !clocks_[c].first_day || !clocks_[c].dates_only) continue;
      column.is_clock = false;
      column.values.clear();
    }
    for (RawColumn& column : table_.columns) column.values.resize(table_.lines.size(), no_value);
  }

  void note_skipped() {
    if (other_lines_ > 0) {
      table_.notes.push_back(std::to_string(other_lines_) + (other_lines_ == 1 ? " line" : " lines") +
                             " of text between the samples passed over, the first is line " +
                             std::to_string(first_other_line_));
    }
  }

  struct ClockColumn {
    std::optional<long> first_day;
    long midnights = 0;
    double last = 0.0;
    bool dates_only = true;
  };

  std::vector<std::string_view> lines_;
  RawTable table_;
  TextLayout layout_;
  std::vector<ClockColumn> clocks_;
  std::size_t empty_ = 0;
  std::size_t other_lines_ = 0;
  std::size_t first_other_line_ = 0;
};

}  // namespace

RawTable read_text_table(std::string bytes, std::string_view source) {
  if (bytes.empty()) throw InputError(source, 0, "the file is empty", "a header line such as t,z_r,F_w");
  if (!looks_like_text(bytes)) {
    throw InputError(source, 0, "the file is no text", "CSV, MATLAB 5 or 7.3, NI TDMS or HDF5");
  }
  const std::string text = to_utf8(std::move(bytes));
  return TableReader(lines_of(text, source), source).run();
}

}  // namespace host_sim
