// Where the table stands in a text file, and how its fields are separated.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace host_sim {

/// Separators of a table. Blank separator: any run of blanks and tabs.
struct TextSeparators {
  char column = ',';   ///< ';', '\t', ',', '|' or ' '
  char decimal = '.';  ///< '.' or ','
};

/// The fields of one line, without quotes and blanks around them; quoted fields may hold separators.
[[nodiscard]] std::vector<std::string> split_fields(std::string_view line, char column);

/// What one field of a table is.
enum class FieldKind : unsigned char { number, weak_number, missing, clock, text };
[[nodiscard]] FieldKind kind_of_field(std::string_view field, char decimal);

/// A table found in text.
struct TextLayout {
  TextSeparators separators;
  char stated_decimal = '\0';    ///< what a number of the judged lines says for sure; '\0': nothing
  std::size_t columns = 0;       ///< fields of most rows
  std::size_t first_row = 0;     ///< index of its line
  std::vector<bool> is_value{};  ///< by column: numbers or clocks; others hold text
  std::vector<bool> is_clock{};
  std::vector<std::string> names{};  ///< headings; "column 1" … where there are none
  std::vector<std::string> units{};  ///< of a row of units; empty: none
  std::size_t header_fields =
      0;  ///< of the line with the names: more than `columns` where a last column is mostly absent
  std::size_t header_line = 0;   ///< index + 1 of the line with the names; 0: none
  std::size_t preamble_end = 0;  ///< index of the first line that belongs to the table or its header
  std::string header_trouble{};  ///< a line of names that does not fit the columns; empty: none
};

/// The layout of most of the lines. For each pair of separators a line counts as a row when it has at least two fields
/// and none but a minority is text; the pair with the most numbers in rows of one length wins, weak numbers (thousands
/// separators) for less, and in doubt the pair named first: ; with ',' – ; with '.' – tab – ',' – '|' – blank.
///
/// The header is the lines above the first row with its number of fields: names, then units ("mm", "[N]", "-"), perhaps
/// behind a comment sign; below the units may stand lines of other texts (rates, numbers of channels). A table of one
/// column is taken where no separator yields two. No table: columns is 0.
[[nodiscard]] TextLayout find_layout(const std::vector<std::string_view>& lines);

/// The header between the line `begin` and the row `layout.first_row`: fills names, units, header_line, header_fields,
/// preamble_end and header_trouble of the layout.
void find_header(const std::vector<std::string_view>& lines, std::size_t begin, TextLayout& layout);

/// Whether a line is a row of the layout's table: its fields are numbers, clocks or words for a missing value where the
/// table holds values, and its first value is no word (a key such as "Points:", a label such as "Max").
[[nodiscard]] bool is_table_row(std::string_view line, const TextLayout& layout);

/// Whether the line is a comment: it begins with #, %, // , ! or '.
[[nodiscard]] bool is_comment(std::string_view line);

}  // namespace host_sim
