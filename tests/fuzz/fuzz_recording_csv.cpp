// Any bytes as a CSV recording: an InputError of one line, or a recording that is what read_recording promises – and
// that comes back with the same bits when written and read again.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const firmware::Recording& recording) {
  require(recording.size() >= 2 && recording.sample_period > 0.0);
  for (std::size_t k = 1; k < recording.size(); ++k) require(recording.time[k] > recording.time[k - 1]);
  for (const auto& channel : recording.channels) {
    require(channel.empty() || channel.size() == recording.size());
    for (const double value : channel) require(std::isfinite(value));
  }
  for (const auto& duct : recording.ducts) {
    require(duct.empty() || duct.size() == recording.size());
    for (const double opening : duct) require(opening == 0.0 || opening == 1.0);
  }
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  // The first byte chooses the rate and the map.
  const firmware::ChannelMap map =
      (*data & 1U) == 0 ? firmware::ChannelMap{}
                        : firmware::ChannelMap{{"t", {"ms", 1e-3, 0.0}}, {"z_r", {"Road [mm]", 1e-3, 0.5}}};
  const std::optional<double> rate = (*data & 2U) == 0 ? std::nullopt : std::optional<double>(1000.0);
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);

  firmware::Recording recording;
  try {
    recording = firmware::parse_recording_csv(text, "REC.csv", map, rate);
  } catch (const firmware::InputError& error) {
    const std::string_view line = error.what();
    require(line.starts_with("REC.csv:") && line.find(", expected ") != std::string_view::npos);
    require(line.find('\n') == std::string_view::npos);
    return 0;
  }
  check(recording);
  // Its stamps may be refused now: what they were rounded to shows in their number of digits, which need not stay.
  firmware::Recording again;
  try {
    again = firmware::parse_recording_csv(format_recording_csv(recording), "again", {}, 1.0 / recording.sample_period);
  } catch (const firmware::InputError&) {
    return 0;
  }
  check(again);
  require(same_bits(recording.time, again.time));
  for (std::size_t i = 0; i < recording.channels.size(); ++i) {
    require(same_bits(recording.channels[i], again.channels[i]));
  }
  require(recording.ducts == again.ducts);
  return 0;
}
