#include "host_sim/recording_files/export/columns.hpp"

#include "firmware/description/text/quantity.hpp"

namespace host_sim {

std::vector<ExportColumn> columns_to_export(const firmware::Recording& recording) {
  std::vector<ExportColumn> columns;
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) {
    const std::vector<double>& column = values(recording, q);
    if (q != firmware::time_quantity && column.empty()) continue;
    columns.push_back({std::string(firmware::quantity_name(q)), std::string(firmware::quantity_unit(q)), &column});
  }
  for (const firmware::ExtraColumn& extra : recording.extra) columns.push_back({extra.name, extra.unit, &extra.values});
  return columns;
}

std::string latin_1(std::string_view utf_8) {
  std::string result;
  for (std::size_t i = 0; i < utf_8.size(); ++i) {
    const auto byte = static_cast<unsigned char>(utf_8[i]);
    if (byte < 0x80) {
      result += utf_8[i];
    } else if ((byte == 0xc2 || byte == 0xc3) && i + 1 < utf_8.size()) {
      result += static_cast<char>((byte & 3U) << 6U | (static_cast<unsigned char>(utf_8[++i]) & 0x3fU));
    } else if (byte >= 0xc0) {
      result += '?';
    }
  }
  return result;
}

}  // namespace host_sim
