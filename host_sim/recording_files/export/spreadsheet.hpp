// Recordings as text for spreadsheet programs.
#pragma once

#include <functional>
#include <string_view>

#include "firmware/recording/recording.hpp"

namespace host_sim {

/// How a spreadsheet program of a country reads numbers.
enum class SpreadsheetStyle : unsigned char {
  decimal_point,  ///< tabs between columns: .tsv
  decimal_comma,  ///< semicolons between columns: .de.csv
};

/// Passes the text to `take`: UTF-8 with byte order mark (without it Excel shows m/s² wrongly), one header line with
/// names and units, no comments, lines end with CR LF, missing values are empty.
void format_spreadsheet(const firmware::Recording& recording, SpreadsheetStyle style,
                        const std::function<void(std::string_view)>& take);

}  // namespace host_sim
