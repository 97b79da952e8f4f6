#include "host_sim/recording_files/export/spreadsheet.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "firmware/description/text/number_text.hpp"
#include "host_sim/recording_files/export/columns.hpp"

namespace host_sim {

void format_spreadsheet(const firmware::Recording& recording, SpreadsheetStyle style,
                        const std::function<void(std::string_view)>& take) {
  const bool comma = style == SpreadsheetStyle::decimal_comma;
  const char separator = comma ? ';' : '\t';
  const std::vector<ExportColumn> columns = columns_to_export(recording);
  std::string text = "\xef\xbb\xbf";
  for (const ExportColumn& column : columns) {
    if (&column != columns.data()) text += separator;
    std::string heading = column.name + (column.unit.empty() ? "" : " [" + column.unit + "]");
    std::replace(heading.begin(), heading.end(), separator, ' ');
    text += heading;
  }
  text += "\r\n";
  constexpr std::size_t block = std::size_t{1} << 17U;
  for (std::size_t k = 0; k < recording.size(); ++k) {
    for (const ExportColumn& column : columns) {
      if (&column != columns.data()) text += separator;
      const double value = (*column.values)[k];
      if (std::isnan(value)) continue;
      std::string number = firmware::shortest(value);
      if (comma) std::replace(number.begin(), number.end(), '.', ',');
      text += number;
    }
    text += "\r\n";
    if (text.size() < block) continue;
    take(text);
    text.clear();
  }
  take(text);
}

}  // namespace host_sim
