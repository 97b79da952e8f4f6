#include "host_sim/recording_files/export/rpc_writer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/recording_files/export/columns.hpp"
#include "host_sim/recording_files/export/row_grid.hpp"

namespace host_sim {
namespace {

std::string header_record(std::string_view key, std::string_view value) {
  std::string record(128, '\0');
  key.copy(record.data(), 31);
  value.copy(record.data() + 32, 95);
  return record;
}

std::string six_decimals(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6E", value);
  return text.data();
}

}  // namespace

void format_rpc(const firmware::Recording& recording, std::string_view file,
                const std::function<void(std::string_view)>& take) {
  const std::optional<RowGrid> grid = find_row_grid(recording.time);
  if (!grid || recording.size() < 2) {
    throw firmware::OutputError(std::string(file), "RPC III holds evenly spaced samples alone",
                                "a recording on an even grid, or another format");
  }
  std::vector<ExportColumn> columns = columns_to_export(recording);
  std::erase_if(columns, [&](const ExportColumn& column) { return column.values == &recording.time; });
  const std::size_t points = grid->rows.back() + 1;
  std::size_t per_frame = 1024;
  while (points % per_frame != 0) per_frame /= 2;
  const std::size_t per_group = std::max<std::size_t>(per_frame, 2048);

  std::vector<std::pair<std::string, std::string>> parameters{
      {"FORMAT", "BINARY"},
      {"NUM_HEADER_BLOCKS", ""},
      {"NUM_PARAMS", ""},
      {"FILE_TYPE", "TIME_HISTORY"},
      {"TIME_TYPE", "RESPONSE"},
      {"DATA_TYPE", "FLOATING_POINT"},
      {"INT_FULL_SCALE", "32768"},
      {"DELTA_T", six_decimals(grid->period)},
      {"CHANNELS", std::to_string(columns.size())},
      {"PTS_PER_FRAME", std::to_string(per_frame)},
      {"PTS_PER_GROUP", std::to_string(per_group)},
      {"FRAMES", std::to_string(points / per_frame)},
      {"HALF_FRAMES", "0"},
      {"REPEATS", "1"},
      {"PARTITIONS", "1"},
      {"PART.CHAN_1", "1"},
      {"PART.NCHAN_1", std::to_string(columns.size())},
      {"OPERATION", "rigtwin"},
  };
  for (std::size_t n = 0; n < columns.size(); ++n) {
    const std::string key = "CHAN_" + std::to_string(n + 1);
    double low = INFINITY;
    double high = -INFINITY;
    for (const double value : *columns[n].values) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (!(low <= high)) low = high = 0.0;
    const double largest = std::max(std::abs(low), std::abs(high));
    parameters.emplace_back("DESC." + key, latin_1(columns[n].name));
    parameters.emplace_back("UNITS." + key, latin_1(columns[n].unit));
    parameters.emplace_back("SCALE." + key, six_decimals(largest > 0.0 ? largest / 32768.0 : 1.0));
    parameters.emplace_back("LOWER_LIMIT." + key, six_decimals(low));
    parameters.emplace_back("UPPER_LIMIT." + key, six_decimals(high));
    parameters.emplace_back("MAP." + key, std::to_string(n + 1));
  }
  const std::size_t blocks = (parameters.size() + 3) / 4;
  parameters[1].second = std::to_string(blocks);
  parameters[2].second = std::to_string(parameters.size());
  std::string header;
  for (const auto& [key, value] : parameters) header += header_record(key, value);
  header.resize(blocks * 512, '\0');
  take(header);

  std::vector<float> group(per_group);
  std::size_t first_sample = 0;  // of the recording, in this group
  for (std::size_t begin = 0; begin < points; begin += per_group) {
    std::size_t next_sample = first_sample;
    for (const ExportColumn& column : columns) {
      std::size_t sample = first_sample;
      float last = std::numeric_limits<float>::quiet_NaN();
      for (std::size_t k = 0; k < per_group; ++k) {
        const std::size_t row = begin + k;
        if (row >= points) {
          group[k] = last;
          continue;
        }
        if (sample < grid->rows.size() && grid->rows[sample] == row) {
          last = static_cast<float>((*column.values)[sample++]);
          group[k] = last;
        } else {
          group[k] = std::numeric_limits<float>::quiet_NaN();
        }
      }
      next_sample = sample;
      std::string bytes(4 * per_group, '\0');
      for (std::size_t k = 0; k < per_group; ++k) {
        const auto raw = std::bit_cast<std::uint32_t>(group[k]);
        for (std::size_t i = 0; i < 4; ++i) bytes[4 * k + i] = static_cast<char>(raw >> (8 * i) & 0xffU);
      }
      take(bytes);
    }
    first_sample = next_sample;
  }
}

}  // namespace host_sim
