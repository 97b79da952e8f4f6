// Excel workbooks (.xlsx, .xlsm) as tables.
#pragma once

#include <filesystem>
#include <string>

#include "host_sim/recording_files/tables/raw_table.hpp"

namespace host_sim {

/// The first sheet that holds a table of numbers, read as text with tabs between its cells (text/text_table.hpp): its
/// rows are the lines of messages. Cells with a format of dates or times are dates and times, to the microsecond of
/// their days; formulas have the values that Excel left. The other sheets are listed as left out. InputError: no such
/// archive, no sheet with a table.
///
/// Source: ECMA-376, Office Open XML, part 1, 18.2 (workbook), 18.3 (sheets), 18.4 (strings), 18.8 (styles).
[[nodiscard]] RawTable table_of_workbook(const std::filesystem::path& file);

/// The text of one sheet, rows as lines and cells between tabs. `strings`: the workbook's shared strings;
/// `styles`: its xl/styles.xml; `day_zero`: days from 1970-01-01 to the workbook's day 0.
[[nodiscard]] std::string text_of_sheet(const std::string& sheet, const std::string& strings, const std::string& styles,
                                        long day_zero = -25569);

}  // namespace host_sim
