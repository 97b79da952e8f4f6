// Any bytes as a text file of a measurement program: an InputError of one line, or a table whose columns are of one
// length and that becomes a recording with rising time.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "host_sim/recording_files/tables/table_recording.hpp"
#include "host_sim/recording_files/text/text_table.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // The first byte chooses the rate.
  const std::optional<double> rate = (*data & 1U) == 0 ? std::nullopt : std::optional<double>(1000.0);
  const firmware::ChannelMap map;
  try {
    const host_sim::RawTable table =
        host_sim::read_text_table(std::string(reinterpret_cast<const char*>(data) + 1, size - 1), "REC.csv");
    for (const host_sim::RawColumn& column : table.columns)
      require(column.values.size() == (column.own_time.empty() ? table.rows : column.own_time.size()));
    require(table.lines.empty() || table.lines.size() == table.rows);
    const firmware::Recording recording = host_sim::read_table_recording(table, {map, rate}, firmware::Missing::mark);
    require(recording.size() >= 2 && recording.sample_period > 0.0);
    for (std::size_t k = 1; k < recording.size(); ++k) require(recording.time[k] > recording.time[k - 1]);
    for (const auto& channel : recording.channels) require(channel.empty() || channel.size() == recording.size());
  } catch (const firmware::InputError& error) {
    const std::string_view line = error.what();
    require(line.starts_with("REC.csv:") && line.find(", expected ") != std::string_view::npos);
    require(line.find('\n') == std::string_view::npos);
  }
  return 0;
}
