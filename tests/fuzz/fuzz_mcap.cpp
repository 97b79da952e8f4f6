// Any bytes as an MCAP log: an InputError of one line, or a table.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "host_sim/recording_files/binary/mcap_reader.hpp"
#include "host_sim/recording_files/tables/table_recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const firmware::ChannelMap map;
  try {
    const host_sim::RawTable table = host_sim::table_of_mcap({reinterpret_cast<const char*>(data), size}, "REC.mcap");
    static_cast<void>(host_sim::read_table_recording(table, {map}, firmware::Missing::mark));
  } catch (const firmware::InputError& error) {
    const std::string_view line = error.what();
    if (!line.starts_with("REC.mcap") || line.find('\n') != std::string_view::npos) std::abort();
  }
  return 0;
}
