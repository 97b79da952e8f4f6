#include "host_sim/recording_files/binary/rpc_file.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

constexpr std::size_t rpc_block = 512, rpc_record = 128, rpc_key = 32;
constexpr std::size_t most_rpc_channels = 10000;
constexpr std::size_t most_rpc_points = std::size_t{1} << 40U;

// A padded text of the header in UTF-8.
std::string padded_text(std::string_view bytes) {
  const std::string_view text = firmware::trimmed(bytes.substr(0, bytes.find('\0')));
  return to_utf8(std::string(text));
}

class RpcReader {
 public:
  RpcReader(std::string_view bytes, std::string_view source) : bytes_(bytes), source_(source) {}

  RawTable run() {
    read_header();
    const std::string type = text("FILE_TYPE", "TIME_HISTORY");
    if (type != "TIME_HISTORY") fail("the RPC III file holds no time history but " + type, "FILE_TYPE TIME_HISTORY");
    if (text("FORMAT", "BINARY") != "BINARY") fail("the RPC III file holds its data as text", "FORMAT BINARY");
    const std::size_t channels = count("CHANNELS");
    const std::size_t per_frame = count("PTS_PER_FRAME");
    const std::size_t frames = count("FRAMES");
    const std::size_t per_group = parameters_.contains("PTS_PER_GROUP") ? count("PTS_PER_GROUP") : per_frame;
    const double step = number("DELTA_T").value_or(0.0);
    if (!(step > 0.0) || !std::isfinite(1.0 / step))
      fail("DELTA_T is " + text("DELTA_T", "missing"), "seconds above 0");
    if (channels > most_rpc_channels) fail("CHANNELS is " + std::to_string(channels), "a number up to 10000");
    const std::size_t data = count("NUM_HEADER_BLOCKS") * rpc_block;
    if (data > bytes_.size()) fail("the file ends within its header", "a whole RPC III file");

    std::size_t points = frames * per_frame;
    if (points > most_rpc_points) fail("FRAMES is " + std::to_string(frames), "a number that a file can hold");
    const std::uint64_t groups = (std::uint64_t{points} + per_group - 1) / per_group;
    const std::uint64_t values = groups * per_group * channels;
    const std::size_t size = size_of_value(values, bytes_.size() - data);
    RawTable table;
    table.source = source_;
    table.format = size == 2 ? "RPC III, 16-bit counts" : "RPC III, 32-bit floats";
    const std::uint64_t there = (bytes_.size() - data) / size;
    if (there < values) {
      const std::size_t whole = static_cast<std::size_t>(there / (std::uint64_t{per_group} * channels)) * per_group;
      if (whole < 2) fail("the file is cut off in its first group", "a whole RPC III file");
      if (whole < points) {
        table.left_out.push_back(
            {"the end of all channels",
             std::to_string(points - whole) + " of " + std::to_string(points) + " points: the file is cut off"});
        points = whole;
      }
    }
    add_time(table, points, step);
    for (std::size_t n = 0; n < channels; ++n) add_channel(table, n, points, channels, per_group, data, size);
    table.notes.insert(table.notes.end(), notes_.begin(), notes_.end());
    return table;
  }

 private:
  [[noreturn]] void fail(const std::string& wrong, const std::string& expected) const {
    throw firmware::InputError(source_, 0, wrong, expected);
  }

  void read_header() {
    std::size_t records = 3;  // FORMAT, NUM_HEADER_BLOCKS, NUM_PARAMS come first
    for (std::size_t i = 0; i < records; ++i) {
      if ((i + 1) * rpc_record > bytes_.size()) fail("the file ends within its header", "a whole RPC III file");
      const std::string_view record = bytes_.substr(i * rpc_record, rpc_record);
      parameters_.emplace(padded_text(record.substr(0, rpc_key)), padded_text(record.substr(rpc_key)));
      if (i == 2) records = std::max(records, count("NUM_PARAMS"));
    }
  }

  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise) const {
    const auto found = parameters_.find(key);
    return found == parameters_.end() || found->second.empty() ? otherwise : found->second;
  }
  [[nodiscard]] std::optional<double> number(const std::string& key) const {
    const std::optional<TextNumber> value = read_text_number(text(key, ""), '.');
    return value ? std::optional(value->value) : std::nullopt;
  }
  [[nodiscard]] std::size_t count(const std::string& key) const {
    const std::optional<double> value = number(key);
    if (!value || !(*value >= 1.0) || *value > 4294967295.0 || std::floor(*value) != *value)
      fail(key + " is " + text(key, "missing"), "a whole number above 0");
    return static_cast<std::size_t>(*value);
  }

  // Bytes of a value: as DATA_TYPE says, unless the file has the size of the other type.
  std::size_t size_of_value(std::uint64_t values, std::uint64_t room) {
    const bool floats = text("DATA_TYPE", "SHORT_INTEGER") == "FLOATING_POINT";
    const std::uint64_t stated = floats ? 4 : 2;
    const std::uint64_t other = floats ? 2 : 4;
    if (values * stated == room || values * other != room) return static_cast<std::size_t>(stated);
    notes_.emplace_back("the size of the file is that of " + std::string(floats ? "16-bit counts" : "32-bit floats") +
                        ", not of " + (floats ? "32-bit floats" : "16-bit counts"));
    return static_cast<std::size_t>(other);
  }

  static void add_time(RawTable& table, std::size_t points, double step) {
    RawColumn time{"t"};
    time.text = "t";
    time.unit = "s";
    time.values.resize(points);
    // DELTA_T has six or seven digits: 9.765625E-04 is 1/1024.
    const double rate = 1.0 / step;
    const double whole = std::abs(rate - std::round(rate)) < 1e-6 * rate ? std::round(rate) : rate;
    for (std::size_t k = 0; k < points; ++k) time.values[k] = static_cast<double>(k) / whole;
    table.rows = points;
    table.columns.push_back(std::move(time));
  }

  void add_channel(RawTable& table, std::size_t n, std::size_t points, std::size_t channels, std::size_t per_group,
                   std::size_t data, std::size_t size) const {
    const std::string key = "CHAN_" + std::to_string(n + 1);
    const double scale = number("SCALE." + key).value_or(1.0);
    const std::string name = text("DESC." + key, key);
    const NameAndUnit heading = split_heading(name);
    RawColumn column{name};
    column.text = name;
    column.group = key;
    column.unit = text("UNITS." + key, "");
    if (column.unit.empty()) {
      column.unit = heading.unit;
      column.name = heading.name;
    }
    column.values.resize(points);
    for (std::size_t k = 0; k < points; ++k) {
      const std::size_t at = data + ((k / per_group * channels + n) * per_group + k % per_group) * size;
      std::uint32_t raw = 0;
      for (std::size_t i = size; i-- > 0;) raw = raw << 8U | static_cast<unsigned char>(bytes_[at + i]);
      column.values[k] =
          size == 2 ? scale * static_cast<std::int16_t>(raw) : static_cast<double>(std::bit_cast<float>(raw));
    }
    table.columns.push_back(std::move(column));
  }

  std::string_view bytes_;
  std::string source_;
  std::map<std::string, std::string, std::less<>> parameters_;
  std::vector<std::string> notes_;
};

}  // namespace

bool is_rpc(std::string_view head) {
  if (head.size() < rpc_record || !head.starts_with("FORMAT")) return false;
  const std::string value = padded_text(head.substr(rpc_key, rpc_record - rpc_key));
  return padded_text(head.substr(0, rpc_key)) == "FORMAT" &&
         (value == "BINARY" || value == "ASCII" || value.starts_with("BINARY_"));
}

RawTable table_of_rpc(std::string_view bytes, std::string_view source) { return RpcReader(bytes, source).run(); }

}  // namespace host_sim
