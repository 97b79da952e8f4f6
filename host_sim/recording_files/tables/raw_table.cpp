#include "host_sim/recording_files/tables/raw_table.hpp"

#include <algorithm>

namespace host_sim {

std::string unique_name(const RawTable& table, std::size_t column) {
  const RawColumn& one = table.columns[column];
  if (one.group.empty()) return one.text;
  const auto same = std::count_if(table.columns.begin(), table.columns.end(),
                                  [&](const RawColumn& other) { return other.text == one.text; });
  return same > 1 ? one.group + "/" + one.text : one.text;
}

}  // namespace host_sim
