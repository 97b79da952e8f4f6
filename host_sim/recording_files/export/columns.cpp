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

}  // namespace host_sim
