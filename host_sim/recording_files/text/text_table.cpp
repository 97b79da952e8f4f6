#include "host_sim/recording_files/text/text_table.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/tables/channel_guess.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/lvm_file.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_fields.hpp"
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
  // Lines end with "\n", "\r\n" or, of old programs, "\r".
  const auto end_of_line = [text](std::size_t from) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    const std::size_t before = text.substr(from, end - from).find('\r');
    return before == std::string_view::npos ? end : from + before;
  };
  if (!text.empty()) {
    const std::string_view begin = text.substr(0, std::size_t{1} << 20U);
    const auto ends = static_cast<std::size_t>(std::count(begin.begin(), begin.end(), '\n'));
    lines.reserve((ends + 1) * (text.size() / begin.size() + 1));
  }
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = end_of_line(i);
    if (end - i > longest_text_line) {
      throw InputError(source, lines.size() + 1, "the line is longer than 1 MiB", "a text file, one row a sample");
    }
    lines.push_back(text.substr(i, end - i));
    i = end + 1;
    if (end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n') ++i;
  }
  return lines;
}

// The names and units of a table's columns: from the headings and a row of units below them.
struct ColumnHead {
  std::string name, text, unit;
};
std::vector<ColumnHead> heads_of(const TextLayout& layout) {
  std::vector<ColumnHead> heads;
  for (std::size_t c = 0; c < layout.columns; ++c) {
    const NameAndUnit heading = split_heading(layout.names[c]);
    ColumnHead head{heading.name, layout.names[c], heading.unit};
    const std::string below = layout.units.empty() ? "" : layout.units[c];
    const bool says_nothing = below.empty() || (firmware::find_unit(below) &&
                                                firmware::find_unit(below)->dimension == firmware::Dimension::none);
    if (!below.empty() && (heading.unit.empty() || !says_nothing)) {
      head.unit = below;
      if (heading.unit.empty()) head.name = layout.names[c];
    }
    // RaceCapture: the whole heading is a list, its first part the name.
    if (head.text.find("|") != std::string::npos && !heading.unit.empty()) head.text = heading.name;
    heads.push_back(std::move(head));
  }
  return heads;
}

class TableReader {
 public:
  TableReader(std::vector<std::string_view> lines, std::string_view source, const ReadingProgress& progress)
      : lines_(std::move(lines)), progress_(progress) {
    table_.source = source;
  }

  RawTable run() {
    layout_ = find_layout(lines_);
    if (layout_.columns == 0 || layout_.first_row >= lines_.size()) {
      throw InputError(table_.source, 0, "no table of numbers is found in the text",
                       "rows of numbers between semicolons, tabs, commas or blanks");
    }
    table_.header_line = layout_.header_line;
    heads_ = heads_of(layout_);
    make_columns();
    read_rows();
    finish_clocks();
    judge_empty_cells();
    note_skipped();
    table_.rows = table_.lines.size();
    table_.format = format_text();
    find_stated_rate();
    return std::move(table_);
  }

 private:
  // How one field of the rows belongs to a column of the table.
  struct FieldUse {
    std::size_t column = no_column;
    double scale = 1.0;  // to the unit of the table's column
  };
  static constexpr std::size_t no_column = static_cast<std::size_t>(-1);

  [[nodiscard]] std::string format_text() const {
    const char column = layout_.separators.column;
    const std::string shown = column == '\t' ? "tabs" : column == ' ' ? "blanks" : std::string("'") + column + "'";
    const std::string decimal = std::string("decimal '") + usual_decimal() + "'";
    if (layout_.columns == 1) return "text, one column, " + decimal;
    return "text, columns separated by " + shown + ", " + decimal;
  }

  [[nodiscard]] char usual_decimal() const {
    for (const char decimal : decimals_) {
      if (decimal != '\0') return decimal;
    }
    return layout_.stated_decimal != '\0' ? layout_.stated_decimal : layout_.separators.decimal;
  }

  void make_columns() {
    for (std::size_t c = 0; c < layout_.columns; ++c) {
      RawColumn column{heads_[c].name};
      column.text = heads_[c].text;
      column.unit = heads_[c].unit;
      column.is_clock = layout_.is_clock[c];
      column.decimals = 0;
      column.significant_digits = 0;
      table_.columns.push_back(std::move(column));
    }
    for (std::size_t c = 0; c < layout_.columns; ++c) {
      if (layout_.is_value[c]) table_.columns[c].values.reserve(lines_.size() - layout_.first_row);
    }
    table_.lines.reserve(lines_.size() - layout_.first_row);
    decimals_.assign(layout_.columns, '\0');
    clocks_.resize(layout_.columns);
    uses_.resize(layout_.columns);
    for (std::size_t c = 0; c < layout_.columns; ++c) uses_[c].column = c;
    if (!layout_.header_trouble.empty())
      table_.notes.push_back(layout_.header_trouble + ": it is not taken as the names of the columns");
  }

  // The lines above the first row but the names: rates stand among units and below them as well.
  void find_stated_rate() {
    std::vector<std::string_view> preamble;
    for (std::size_t i = 0; i < layout_.first_row; ++i) {
      if (i + 1 != layout_.header_line) preamble.push_back(lines_[i]);
    }
    const auto rate = find_rate(preamble, {usual_decimal(), table_.rows});
    if (!rate) return;
    table_.rate = rate->rate;
    table_.rate_text = rate->text;
    if (!rate->conflict.empty()) table_.rate_conflict = in_quotes(rate->text) + " and " + in_quotes(rate->conflict);
  }

  void read_rows() {
    std::size_t i = layout_.first_row;
    constexpr std::size_t rows_between_reports = 65536;
    while (i < lines_.size()) {
      if (progress_ && i % rows_between_reports == 0)
        progress_(static_cast<double>(i) / static_cast<double>(lines_.size()));
      if (take_plain_row(i) || take_row_or_blank(i)) {
        ++i;
        continue;
      }
      // Lines that are no rows: text, perhaps with the header of what follows.
      const std::size_t begin = i;
      while (i < lines_.size() && !begins_rows(i)) ++i;
      i = pass_text(begin, i);
    }
  }

  // The usual row, fast: as many plain numbers as there are columns.
  bool take_plain_row(std::size_t i) {
    const char* p = lines_[i].data();
    const char* const end = p + lines_[i].size();
    if (p == end) return false;
    const char separator = layout_.separators.column;
    const auto is_gap = [separator](char c) { return c == ' ' || (c == '\t' && separator != '\t'); };
    row_.resize(layout_.columns);
    for (std::size_t f = 0; f < layout_.columns; ++f) {
      while (p != end && is_gap(*p)) ++p;
      if (!layout_.is_value[f]) {
        if (p != end && *p == '"') return false;
        while (p != end && (separator == ' ' ? !is_gap(*p) : *p != separator)) ++p;
      } else {
        const std::size_t c = uses_[f].column;
        if (layout_.is_clock[f] || c == no_column) return false;
        const char decimal = decimals_[c];
        p = read_plain_number(p, end, decimal == '\0' ? '.' : decimal, row_[f]);
        if (p == nullptr || (decimal == '\0' && row_[f].has_sign)) return false;
      }
      const char* const behind = p;
      while (p != end && is_gap(*p)) ++p;
      if (f + 1 == layout_.columns) {
        if (p != end) return false;
      } else if (separator == ' ') {
        if (p == behind) return false;
      } else if (p == end || *p++ != separator) {
        return false;
      }
    }
    table_.lines.push_back(i + 1);
    for (std::size_t f = 0; f < layout_.columns; ++f) {
      if (!layout_.is_value[f]) continue;
      RawColumn& column = table_.columns[uses_[f].column];
      const PlainNumber& number = row_[f];
      column.decimals = std::max(column.decimals, number.decimals);
      column.significant_digits = std::max(column.significant_digits, number.significant_digits);
      column.values.push_back(uses_[f].scale == 1.0 ? number.value : uses_[f].scale * number.value);
    }
    return true;
  }

  void push(std::size_t c, double value) { table_.columns[c].values.push_back(value); }

  [[nodiscard]] bool is_row(std::size_t i) const {
    const std::string_view line = lines_[i];
    if (!is_table_row(line, layout_)) return false;
    if (!is_comment(line)) return true;
    std::size_t values = 0;
    std::size_t numbers = 0;
    const std::vector<std::string> fields = split_fields(line, layout_.separators.column);
    for (std::size_t c = 0; c < layout_.columns; ++c) {
      if (!layout_.is_value[c]) continue;
      ++values;
      if (c < fields.size() && kind_of_field(fields[c], layout_.separators.decimal) != FieldKind::text) ++numbers;
    }
    return numbers >= values;
  }

  // A row whose first value is a word may stand between rows: an overload in the first channel.
  [[nodiscard]] bool is_row_with_a_word(std::size_t i) const {
    if (i == 0 || i + 1 >= lines_.size() || table_.lines.empty() || table_.lines.back() != i) return false;
    if (is_comment(lines_[i]) || !is_row(i + 1)) return false;
    const std::vector<std::string> fields = split_fields(lines_[i], layout_.separators.column);
    if (fields.size() != layout_.columns || fields.front().ends_with(':')) return false;
    std::size_t numbers = 0;
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const FieldKind kind = kind_of_field(fields[c], layout_.separators.decimal);
      numbers += layout_.is_value[c] && kind != FieldKind::text && kind != FieldKind::missing ? 1 : 0;
    }
    return numbers > 0 && 2 * numbers >= fields.size() - 1;
  }

  bool take_row_or_blank(std::size_t i) {
    const std::string_view line = firmware::trimmed(lines_[i]);
    if (line.empty() || line == "\x1a") return true;
    if (!is_row(i) && !is_row_with_a_word(i)) {
      // Separators only: the last line of spreadsheets.
      return line.find_first_not_of(" \t,;|\"") == std::string_view::npos;
    }
    std::vector<std::string> fields = split_fields(lines_[i], layout_.separators.column);
    while (fields.size() > layout_.columns && fields.back().empty()) fields.pop_back();
    take_row(fields, i);
    return true;
  }

  // Rows begin at a row that another follows, or that is the last line.
  [[nodiscard]] bool begins_rows(std::size_t i) const {
    if (firmware::trimmed(lines_[i]).empty() || !is_row(i)) return false;
    for (std::size_t next = i + 1; next < lines_.size(); ++next) {
      if (firmware::trimmed(lines_[next]).empty()) continue;
      return is_row(next);
    }
    return true;
  }

  // Lines begin … end − 1 between rows. Returns the line to go on with.
  std::size_t pass_text(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (firmware::trimmed(lines_[i]).empty()) continue;
      ++other_lines_;
      if (first_other_line_ == 0) first_other_line_ = i + 1;
    }
    if (end >= lines_.size()) return end;
    TextLayout next = layout_;
    next.first_row = end;
    next.header_line = 0;
    find_header(lines_, begin, next);
    if (next.header_line == 0) return end;
    return take_header(next, end);
  }

  static std::string key_of(std::string_view name) {
    std::string key;
    for (const char c : firmware::trimmed(name)) key += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return key;
  }

  // A second header: the rows below it are read by it, into the columns of the first.
  std::size_t take_header(const TextLayout& next, std::size_t first_row) {
    const std::vector<ColumnHead> heads = heads_of(next);
    std::vector<FieldUse> uses(layout_.columns);
    std::size_t found = 0;
    std::vector<std::string> unknown;
    for (std::size_t f = 0; f < heads.size(); ++f) {
      for (std::size_t c = 0; c < heads_.size(); ++c) {
        const bool same =
            key_of(heads[f].text) == key_of(heads_[c].text) || key_of(heads[f].name) == key_of(heads_[c].name);
        if (!same || std::any_of(uses.begin(), uses.end(), [&](const FieldUse& use) { return use.column == c; }))
          continue;
        uses[f].column = c;
        uses[f].scale = scale_between(heads[f], heads_[c], next.header_line);
        ++found;
        break;
      }
      if (uses[f].column == no_column) unknown.push_back(heads[f].text);
    }
    const std::string line = std::to_string(next.header_line);
    if (unknown.empty()) {
      uses_ = std::move(uses);
      return first_row;
    }
    if (found * 2 > heads.size()) {
      throw InputError(table_.source, next.header_line,
                       "a second header has the column " + in_quotes(unknown.front()) + ", which the first has not",
                       "the columns of the header in line " + std::to_string(table_.header_line));
    }
    // Another table: its rows are none of this one's.
    std::size_t end = first_row;
    std::size_t rows = 0;
    while (end < lines_.size() && (is_row(end) || firmware::trimmed(lines_[end]).empty())) {
      rows += firmware::trimmed(lines_[end]).empty() ? 0 : 1;
      ++end;
    }
    table_.left_out.push_back({"the table below line " + line,
                               std::to_string(rows) + " rows under other names: " + in_quotes(unknown.front()) +
                                   (unknown.size() > 1 ? ", …" : "")});
    return end;
  }

  double scale_between(const ColumnHead& from, const ColumnHead& to, std::size_t line) const {
    if (from.unit == to.unit || from.unit.empty()) return 1.0;
    const std::optional<firmware::Unit> a = firmware::find_unit(from.unit);
    const std::optional<firmware::Unit> b = firmware::find_unit(to.unit);
    if (a && b && a->dimension == b->dimension) return a->scale / b->scale;
    throw InputError(table_.source, line,
                     in_quotes(from.name) + " is in " + from.unit + " from here on, in " +
                         (to.unit.empty() ? "no stated unit" : to.unit) + " before",
                     "one unit for a column");
  }

  void fault(std::size_t line, const std::string& wrong, const std::string& expected, bool says_missing = false) {
    table_.faults.push_back({line, wrong, expected, says_missing});
  }

  void take_row(const std::vector<std::string>& fields, std::size_t i) {
    const std::size_t line = i + 1;
    table_.lines.push_back(line);
    if (fields.size() > std::max(layout_.columns, layout_.header_fields)) {
      fault(line, "the row has " + std::to_string(fields.size()) + " values",
            std::to_string(layout_.columns) + " as in the other rows");
    }
    for (std::size_t f = 0; f < layout_.columns; ++f) {
      const std::size_t c = uses_[f].column;
      if (!layout_.is_value[f] || c == no_column) continue;
      if (f >= fields.size()) {
        push(c, no_value);
        if (table_.faults.empty() || table_.faults.back().line != line) {
          fault(line, "the row has " + std::to_string(fields.size()) + (fields.size() == 1 ? " value" : " values"),
                std::to_string(layout_.columns) + " as in the other rows");
        }
        continue;
      }
      const double value =
          table_.columns[c].is_clock ? clock_value(c, fields[f], line) : number_value(c, f, fields[f], i);
      push(c, uses_[f].scale == 1.0 ? value : uses_[f].scale * value);
    }
  }

  double number_value(std::size_t c, std::size_t f, const std::string& field, std::size_t i) {
    RawColumn& column = table_.columns[c];
    if (decimals_[c] == '\0' && decimal_evidence(field) != DecimalEvidence::none) decide_decimal(c, f, i);
    const char decimal = decimals_[c] == '\0' ? layout_.separators.decimal : decimals_[c];
    std::optional<TextNumber> number = read_text_number(field, decimal);
    double scale = 1.0;
    if (!number) {
      if (const std::optional<NumberWithUnit> with_unit = read_number_with_unit(field, decimal)) {
        number = with_unit->number;
        scale = scale_of_cell(column, with_unit->unit);
      }
    }
    if (number && std::isfinite(number->value) && !is_number_for_missing(number->value)) {
      column.decimals = std::max(column.decimals, number->decimals);
      column.significant_digits = std::max(column.significant_digits, number->significant_digits);
      return scale * number->value;
    }
    if (firmware::trimmed(field).empty()) {
      empty_cells_.emplace_back(c, i + 1);
      return no_value;
    }
    fault(i + 1, in_quotes(column.name) + " is " + in_quotes(field), "a number",
          is_missing_value(field) || number.has_value());
    return no_value;
  }

  // "0.5 mm", "1.2 s": the unit of the first cell is the column's.
  static double scale_of_cell(RawColumn& column, std::string_view unit) {
    if (column.unit.empty()) column.unit = unit;
    const std::optional<firmware::Unit> a = firmware::find_unit(unit);
    const std::optional<firmware::Unit> b = firmware::find_unit(column.unit);
    if (a && b && a->dimension == b->dimension) return a->scale / b->scale;
    return unit == column.unit ? 1.0 : no_value;
  }

  // The decimal sign of a column, at its first number that has a sign. Evidence in this order: a number of the column
  // beyond doubt, anywhere in the file; one of another column; the reading in which the values change less.
  void decide_decimal(std::size_t c, std::size_t f, std::size_t from) {
    double before[2] = {no_value, no_value};
    double variation[2] = {0.0, 0.0};
    double low[2] = {INFINITY, INFINITY};
    double high[2] = {-INFINITY, -INFINITY};
    char shown_sign = '.';
    FieldSplitter splitter;
    // Where other columns show their sign, this one's is looked for in some minutes of a recording; else everywhere.
    constexpr std::size_t some_lines = 200000;
    const bool stated = layout_.stated_decimal != '\0';
    const std::size_t begin = stated ? from : layout_.first_row;
    const std::size_t end = stated ? std::min(lines_.size(), from + some_lines) : lines_.size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::vector<std::string_view>& fields = splitter.split(lines_[i], layout_.separators.column);
      if (f >= fields.size()) continue;
      const DecimalEvidence evidence = i < from ? DecimalEvidence::none : decimal_evidence(fields[f]);
      if (evidence == DecimalEvidence::point || evidence == DecimalEvidence::comma) {
        decimals_[c] = evidence == DecimalEvidence::point ? '.' : ',';
        return;
      }
      if (evidence == DecimalEvidence::ambiguous)
        shown_sign = fields[f].find('.') != std::string_view::npos ? '.' : ',';
      if (stated) continue;
      for (const int k : {0, 1}) {
        const std::optional<TextNumber> number = read_text_number(fields[f], k == 0 ? '.' : ',');
        if (!number) continue;
        if (std::isfinite(before[k])) variation[k] += std::abs(number->value - before[k]);
        before[k] = number->value;
        low[k] = std::min(low[k], number->value);
        high[k] = std::max(high[k], number->value);
      }
    }
    if (layout_.stated_decimal != '\0') {
      decimals_[c] = layout_.stated_decimal;
      return;
    }
    const double point = variation[0] * (high[1] - low[1]);
    const double comma = variation[1] * (high[0] - low[0]);
    const bool alike = std::abs(point - comma) <= 1e-9 * std::max(point, comma);
    decimals_[c] = alike ? shown_sign : point < comma ? '.' : ',';
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
    ClockColumn& state = clocks_[c];
    if (!state.first_day) state.first_day = clock->day;
    // Without a date a clock that falls by more than half its range has begun anew.
    if (!clock->has_date && clock->seconds < state.last - 0.5 * clock->wraps) state.wrapped += clock->wraps;
    state.last = clock->seconds;
    state.dates_only = state.dates_only && !clock->has_time;
    return clock->seconds + seconds_per_day * static_cast<double>(clock->day - *state.first_day) + state.wrapped;
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

  // A column with fewer filled cells than empty ones, all over the table, is a slow channel. Columns that end with a
  // time of their own are shorter ones. Other empty cells are missing values.
  void judge_empty_cells() {
    std::vector<std::size_t> empty(layout_.columns), filled_until(layout_.columns);
    for (const auto& [column, line] : empty_cells_) ++empty[column];
    const std::size_t rows = table_.lines.size();
    std::vector<std::size_t> ends;  // of times that end before the table
    for (std::size_t c = 0; c < layout_.columns; ++c) {
      RawColumn& column = table_.columns[c];
      if (empty[c] == 0 || !layout_.is_value[c] || layout_.is_clock[c]) continue;
      std::size_t end = rows;
      while (end > 0 && std::isnan(column.values[end - 1])) --end;
      filled_until[c] = end;
      const std::size_t filled = rows - std::min(empty[c], rows);
      const bool only_at_the_end = empty[c] == rows - end;
      column.is_slow = filled >= 2 && empty[c] >= filled && !only_at_the_end;
      const std::optional<firmware::Unit> unit = firmware::find_unit(column.unit);
      const bool time = is_time_name(column.name) || (unit && unit->dimension == firmware::Dimension::time);
      if (only_at_the_end && time && end > 0) ends.push_back(end);
    }
    for (const auto& [column, line] : empty_cells_) {
      if (table_.columns[column].is_slow) continue;
      if (std::find(ends.begin(), ends.end(), filled_until[column]) != ends.end() &&
          line > table_.lines[filled_until[column] - 1])
        continue;
      fault(line, in_quotes(table_.columns[column].name) + " is missing", "a number");
    }
    std::stable_sort(table_.faults.begin(), table_.faults.end(),
                     [](const RawFault& a, const RawFault& b) { return a.line < b.line; });
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
    double wrapped = 0.0;  // [s]
    double last = 0.0;
    bool dates_only = true;
  };

  std::vector<std::string_view> lines_;
  const ReadingProgress& progress_;
  RawTable table_;
  TextLayout layout_;
  std::vector<ColumnHead> heads_;
  std::vector<FieldUse> uses_;  // by field of the rows
  std::vector<char> decimals_;  // by column; '\0': not decided
  std::vector<ClockColumn> clocks_;
  std::vector<std::pair<std::size_t, std::size_t>> empty_cells_;  // column, line
  std::vector<PlainNumber> row_;                                  // by field
  std::size_t other_lines_ = 0;
  std::size_t first_other_line_ = 0;
};

}  // namespace

RawTable read_text_table(std::string_view bytes, std::string_view source, std::size_t skip,
                         const ReadingProgress& progress) {
  if (bytes.empty()) throw InputError(source, 0, "the file is empty", "a header line such as t,z_r,F_w");
  if (!looks_like_text(bytes)) {
    throw InputError(source, 0, "the file is no text", "CSV, MATLAB 5 or 7.3, NI TDMS or HDF5");
  }
  std::string converted;
  const std::string_view text = as_utf8(bytes, converted);
  std::vector<std::string_view> lines = lines_of(text, source);
  for (std::size_t i = 0; i < std::min(skip, lines.size()); ++i) lines[i] = {};
  if (is_lvm(lines)) return read_lvm(lines, source);
  return TableReader(std::move(lines), source, progress).run();
}

}  // namespace host_sim
