#include "host_sim/recording_files/export/mcap_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/text/number_text.hpp"
#include "firmware/description/version.hpp"
#include "host_sim/recording_files/export/columns.hpp"

namespace host_sim {
namespace {

constexpr std::string_view mcap_magic = "\x89MCAP0\r\n";
constexpr std::uint16_t the_schema = 1;
constexpr std::uint16_t the_channel = 1;
constexpr std::size_t largest_chunk = std::size_t{1} << 20U;  // [byte] what a viewer reads at least
constexpr std::uint64_t longest_chunk = 1000000000;           // [ns]

enum class Opcode : unsigned char {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  data_end = 0x0f,
};

// Checksum of zlib and PNG (polynomial 0xedb88320), as MCAP asks.
std::uint32_t crc32(std::string_view bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> made{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t value = i;
      for (int bit = 0; bit < 8; ++bit) value = (value & 1U) != 0 ? 0xedb88320U ^ value >> 1U : value >> 1U;
      made[i] = value;
    }
    return made;
  }();
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) crc = table[(crc ^ static_cast<unsigned char>(c)) & 0xffU] ^ crc >> 8U;
  return ~crc;
}

// Little-endian fields of a record.
class RecordBytes {
 public:
  RecordBytes& number(std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes_ += static_cast<char>(value >> (8 * i) & 0xffU);
    return *this;
  }
  RecordBytes& text(std::string_view value) {
    number(value.size(), 4);
    bytes_ += value;
    return *this;
  }
  RecordBytes& raw(std::string_view value) {
    bytes_ += value;
    return *this;
  }
  [[nodiscard]] std::string as_record(Opcode opcode) const {
    std::string record(1, static_cast<char>(opcode));
    for (std::size_t i = 0; i < 8; ++i) record += static_cast<char>(std::uint64_t{bytes_.size()} >> (8 * i) & 0xffU);
    return record + bytes_;
  }

 private:
  std::string bytes_;
};

std::string json_string(std::string_view text) {
  constexpr std::string_view hex = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') quoted += '\\';
    if (byte < 0x20) {
      quoted += std::string("\\u00") + hex[byte >> 4U] + hex[byte & 0xfU];
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string json_number(double value) { return std::isfinite(value) ? firmware::shortest(value) : "null"; }

std::string schema_of(const std::vector<ExportColumn>& columns) {
  std::string schema = "{\"type\":\"object\",\"properties\":{";
  for (const ExportColumn& column : columns) {
    if (&column != columns.data()) schema += ',';
    schema += json_string(column.name) + ":{\"type\":[\"number\",\"null\"],\"description\":" +
              json_string(column.unit.empty() ? "no unit" : column.unit) + "}";
  }
  return schema + "}}";
}

struct ChunkEntry {
  std::uint64_t first_time, last_time, offset, length, index_offset, index_length, size;
};

class McapWriter {
 public:
  explicit McapWriter(const std::function<void(std::string_view)>& take) : take_(take) {}

  void begin(const std::vector<ExportColumn>& columns) {
    put(mcap_magic);
    put(RecordBytes().text("").text("rigtwin " + std::string(firmware::version)).as_record(Opcode::header));
    schema_ = RecordBytes()
                  .number(the_schema, 2)
                  .text("rigtwin")
                  .text("jsonschema")
                  .text(schema_of(columns))
                  .as_record(Opcode::schema);
    channel_ = RecordBytes()
                   .number(the_channel, 2)
                   .number(the_schema, 2)
                   .text("/rigtwin")
                   .text("json")
                   .number(0, 4)
                   .as_record(Opcode::channel);
    chunk_ = schema_ + channel_;
  }

  void message(std::uint64_t time, std::string_view json) {
    if (!index_.empty() && (chunk_.size() > largest_chunk || time - index_.front().first >= longest_chunk)) end_chunk();
    index_.emplace_back(time, chunk_.size());
    chunk_ += RecordBytes()
                  .number(the_channel, 2)
                  .number(messages_++, 4)
                  .number(time, 8)
                  .number(time, 8)
                  .raw(json)
                  .as_record(Opcode::message);
  }

  void finish() {
    if (!index_.empty()) end_chunk();
    put(RecordBytes().number(0, 4).as_record(Opcode::data_end));
    const std::uint64_t summary = at_;
    std::string section = schema_ + channel_;
    for (const ChunkEntry& entry : chunks_) {
      section += RecordBytes()
                     .number(entry.first_time, 8)
                     .number(entry.last_time, 8)
                     .number(entry.offset, 8)
                     .number(entry.length, 8)
                     .number(10, 4)  // bytes of the map: one channel
                     .number(the_channel, 2)
                     .number(entry.index_offset, 8)
                     .number(entry.index_length, 8)
                     .text("")
                     .number(entry.size, 8)
                     .number(entry.size, 8)
                     .as_record(Opcode::chunk_index);
    }
    section += RecordBytes()
                   .number(messages_, 8)
                   .number(1, 2)
                   .number(1, 4)
                   .number(0, 4)
                   .number(0, 4)
                   .number(chunks_.size(), 4)
                   .number(chunks_.empty() ? 0 : chunks_.front().first_time, 8)
                   .number(chunks_.empty() ? 0 : chunks_.back().last_time, 8)
                   .number(10, 4)
                   .number(the_channel, 2)
                   .number(messages_, 8)
                   .as_record(Opcode::statistics);
    // The summary's checksum covers the footer up to itself.
    std::string footer = RecordBytes().number(summary, 8).number(0, 8).number(0, 4).as_record(Opcode::footer);
    footer.resize(footer.size() - 4);
    const std::uint32_t crc = crc32(section + footer);
    put(section);
    put(footer);
    put(std::string{static_cast<char>(crc & 0xffU), static_cast<char>(crc >> 8U & 0xffU),
                    static_cast<char>(crc >> 16U & 0xffU), static_cast<char>(crc >> 24U)});
    put(mcap_magic);
  }

 private:
  void put(std::string_view bytes) {
    take_(bytes);
    at_ += bytes.size();
  }

  void end_chunk() {
    ChunkEntry entry{index_.front().first, index_.back().first, at_, 0, 0, 0, chunk_.size()};
    const std::string record = RecordBytes()
                                   .number(entry.first_time, 8)
                                   .number(entry.last_time, 8)
                                   .number(chunk_.size(), 8)
                                   .number(crc32(chunk_), 4)
                                   .text("")
                                   .number(chunk_.size(), 8)
                                   .raw(chunk_)
                                   .as_record(Opcode::chunk);
    entry.length = record.size();
    put(record);
    RecordBytes index;
    index.number(the_channel, 2).number(index_.size() * 16, 4);
    for (const auto& [time, offset] : index_) index.number(time, 8).number(offset, 8);
    const std::string index_record = index.as_record(Opcode::message_index);
    entry.index_offset = at_;
    entry.index_length = index_record.size();
    put(index_record);
    chunks_.push_back(entry);
    chunk_.clear();
    index_.clear();
  }

  const std::function<void(std::string_view)>& take_;
  std::uint64_t at_ = 0;  // bytes written
  std::string schema_, channel_, chunk_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> index_;  // time and place of each message of the chunk
  std::vector<ChunkEntry> chunks_;
  std::uint64_t messages_ = 0;
};

}  // namespace

void format_mcap(const firmware::Recording& recording, const std::function<void(std::string_view)>& take) {
  const std::vector<ExportColumn> columns = columns_to_export(recording);
  McapWriter writer(take);
  writer.begin(columns);
  const double shift = recording.time.empty() ? 0.0 : std::max(0.0, -recording.time.front());
  for (std::size_t k = 0; k < recording.size(); ++k) {
    std::string json = "{";
    for (const ExportColumn& column : columns) {
      if (json.size() > 1) json += ',';
      json += json_string(column.name) + ":" + json_number((*column.values)[k]);
    }
    writer.message(static_cast<std::uint64_t>(std::llround(1e9 * (recording.time[k] + shift))), json + "}");
  }
  writer.finish();
}

}  // namespace host_sim
