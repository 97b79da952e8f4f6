#include "host_sim/recording_files/export/mdf_writer.hpp"

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/description/version.hpp"
#include "host_sim/recording_files/export/columns.hpp"

namespace host_sim {
namespace {

// Blocks one after the other; a link is the position of a block that was appended before.
class MdfBytes {
 public:
  [[nodiscard]] std::uint64_t position() const { return bytes_.size(); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  void raw(std::string_view bytes) { bytes_ += bytes; }

  static std::string little(std::uint64_t value, std::size_t size) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i) text += static_cast<char>(value >> (8 * i) & 0xffU);
    return text;
  }

  // `data_size`: what the block's length counts, where the data follow elsewhere.
  std::uint64_t block(std::string_view id, const std::vector<std::uint64_t>& links, const std::string& data,
                      std::uint64_t further = 0) {
    while (bytes_.size() % 8 != 0) bytes_ += '\0';
    const std::uint64_t at = bytes_.size();
    bytes_ += id;
    bytes_ += little(0, 4) + little(24 + 8 * links.size() + data.size() + further, 8) + little(links.size(), 8);
    for (const std::uint64_t link : links) bytes_ += little(link, 8);
    bytes_ += data;
    return at;
  }

  std::uint64_t text(std::string_view content, std::string_view id = "##TX") {
    if (content.empty()) return 0;
    std::string data(content);
    do data += '\0';
    while (data.size() % 8 != 0);
    return block(id, {}, data);
  }

  void set_link(std::uint64_t block, std::size_t link, std::uint64_t to) {
    bytes_.replace(static_cast<std::size_t>(block) + 24 + 8 * link, 8, little(to, 8));
  }

 private:
  std::string bytes_;
};

}  // namespace

void format_mdf(const firmware::Recording& recording, const std::function<void(std::string_view)>& take) {
  const std::vector<ExportColumn> columns = columns_to_export(recording);
  const std::size_t record = 8 * columns.size();
  MdfBytes file;
  std::string id = "MDF     4.10    rigtwin ";
  id += std::string(4, '\0') + MdfBytes::little(410, 2) + std::string(34, '\0');
  file.raw(id);
  // Header, at 64: first data group, first file history; then the start (0: not known).
  const std::uint64_t head = file.block("##HD", {0, 0, 0, 0, 0, 0}, std::string(32, '\0'));
  const std::uint64_t comment = file.text(
      "<FHcomment xmlns=\"http://www.asam.net/mdf/v4\"><TX>written</TX><tool_id>rigtwin</tool_id>"
      "<tool_vendor>rigtwin</tool_vendor><tool_version>" +
          std::string(firmware::version) + "</tool_version></FHcomment>",
      "##MD");
  const std::uint64_t history = file.block("##FH", {0, comment}, std::string(16, '\0'));
  file.set_link(head, 1, history);

  std::uint64_t next = 0;
  for (std::size_t c = columns.size(); c-- > 0;) {
    const bool master = columns[c].values == &recording.time;
    const std::uint64_t name = file.text(columns[c].name);
    const std::uint64_t unit = file.text(columns[c].unit);
    std::string data;
    data += static_cast<char>(master ? 2 : 0);  // master or fixed length
    data += static_cast<char>(master ? 1 : 0);  // synchronised by time
    data += static_cast<char>(4);               // floating point, little endian
    data += static_cast<char>(0);               // bit offset
    data += MdfBytes::little(8 * c, 4) + MdfBytes::little(64, 4);
    data += MdfBytes::little(0, 4) + MdfBytes::little(0, 4);  // flags, invalidation bit
    data += static_cast<char>(0);                             // precision
    data += static_cast<char>(0);
    data += MdfBytes::little(0, 2);  // attachments
    data += std::string(48, '\0');   // ranges and limits, not stated
    next = file.block("##CN", {next, 0, name, 0, 0, 0, unit, 0}, data);
  }
  const std::uint64_t group_name = file.text("rigtwin");
  const std::string cycles = MdfBytes::little(0, 8) + MdfBytes::little(recording.size(), 8) + MdfBytes::little(0, 8) +
                             MdfBytes::little(record, 4) + MdfBytes::little(0, 4);
  const std::uint64_t group = file.block("##CG", {0, next, group_name, 0, 0, 0}, cycles);
  const std::uint64_t data_group = file.block("##DG", {0, group, 0, 0}, std::string(8, '\0'));
  file.set_link(head, 0, data_group);
  const std::uint64_t data = file.block("##DT", {}, "", std::uint64_t{record} * recording.size());
  file.set_link(data_group, 2, data);
  take(file.bytes());

  constexpr std::size_t block = std::size_t{1} << 16U;
  std::string rows;
  for (std::size_t k = 0; k < recording.size(); ++k) {
    for (const ExportColumn& column : columns) {
      const auto raw = std::bit_cast<std::uint64_t>((*column.values)[k]);
      for (std::size_t i = 0; i < 8; ++i) rows += static_cast<char>(raw >> (8 * i) & 0xffU);
    }
    if (rows.size() < block && k + 1 < recording.size()) continue;
    take(rows);
    rows.clear();
  }
}

}  // namespace host_sim
