#include "host_sim/recording_files/measurement_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/binary/hdf5_leaves.hpp"
#include "host_sim/recording_files/binary/leaf_table.hpp"
#include "host_sim/recording_files/binary/matlab_leaves.hpp"
#include "host_sim/recording_files/binary/mcap_reader.hpp"
#include "host_sim/recording_files/binary/mdf_file.hpp"
#include "host_sim/recording_files/binary/rpc_file.hpp"
#include "host_sim/recording_files/binary/tdms_table.hpp"
#include "host_sim/recording_files/binary/workbook_file.hpp"
#include "host_sim/recording_files/recording_mat.hpp"
#include "host_sim/recording_files/text/text_table.hpp"
#include "host_sim/recording_files/text/text_values.hpp"
#include "host_sim/recording_files/text/universal_file.hpp"

namespace host_sim {
namespace {

constexpr std::string_view hdf5_signature = "\x89HDF\r\n\x1a\n";

bool has_hdf5_signature(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  for (std::streamoff at = 512; at <= 8192; at *= 2) {
    std::string bytes(hdf5_signature.size(), '\0');
    if (!stream.seekg(at) || !stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) return false;
    if (bytes == hdf5_signature) return true;
  }
  return false;
}

bool is_workbook(const std::filesystem::path& file, std::string_view head) {
  if (!head.starts_with("PK\x03\x04") || head.find("opendocument") != std::string_view::npos) return false;
  return head.find("xl/") != std::string_view::npos || head.find("[Content_Types].xml") != std::string_view::npos ||
         file.extension() == ".xlsx" || file.extension() == ".xlsm";
}

// The map's entry for a column; nullptr: none.
const firmware::ColumnSource* entry_for(const firmware::Heading& heading, const firmware::ChannelMap& map,
                                        std::string_view& quantity) {
  for (const auto& [wanted, entry] : map) {
    if (entry.column != heading.text && entry.column != heading.name) continue;
    quantity = wanted;
    return &entry;
  }
  return nullptr;
}

// Whether a column's unit is one that only the readers of this room convert.
bool needs_conversion(const firmware::Heading& heading, std::string_view quantity,
                      const firmware::ColumnSource* entry) {
  if (!heading.unit) return false;
  const std::optional<firmware::Quantity> of = firmware::find_quantity(quantity);
  const std::optional<firmware::Unit> unit = firmware::find_unit(*heading.unit);
  if (!of || !unit || unit->dimension != firmware::dimension_of(*of) || unit->scale == 1.0) return false;
  return entry == nullptr || !entry->scale;
}

std::vector<std::string_view> between_commas(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(firmware::trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

bool has_contract_header(std::string_view line, const firmware::ChannelMap& map) {
  if (line.ends_with(',')) return false;
  bool time = false;
  bool channel = false;
  for (const std::string_view field : between_commas(line)) {
    const firmware::Heading heading = firmware::read_heading(field);
    std::string_view quantity = heading.name;
    const firmware::ColumnSource* entry = entry_for(heading, map, quantity);
    if (!firmware::find_quantity(quantity)) continue;
    if (needs_conversion(heading, quantity, entry)) return false;
    (quantity == "t" ? time : channel) = true;
  }
  return time && channel;
}

}  // namespace

FileKind kind_of_file(const std::filesystem::path& file, std::string_view head, bool is_matlab) {
  if (is_matlab) return FileKind::matlab;
  if (head.starts_with("TDSm")) return FileKind::tdms;
  if (is_mdf(head)) return FileKind::mdf;
  if (is_rpc(head)) return FileKind::rpc;
  if (is_matlab_4(head)) return FileKind::matlab_4;
  if (head.starts_with(hdf5_signature)) return FileKind::hdf5;
  if (is_universal_file(head)) return FileKind::universal;
  if (is_mcap(head)) return FileKind::mcap;
  if (is_workbook(file, head)) return FileKind::workbook;
  return has_hdf5_signature(file) ? FileKind::hdf5 : FileKind::text;
}

bool is_contract_csv(std::string_view text, const firmware::ChannelMap& map) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  std::optional<std::size_t> columns;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    const std::string_view trimmed = firmware::trimmed(line);
    if (trimmed.empty()) continue;
    if (!columns) {
      if (trimmed.front() == '#') {
        if (firmware::trimmed(trimmed.substr(1)) == firmware::recording_mark) return true;
        continue;
      }
      if (!has_contract_header(trimmed, map)) return false;
      columns = between_commas(trimmed).size();
      continue;
    }
    // The first row decides: units, clocks, decimal commas, quotes and separators at the end are for the other reader.
    const std::vector<std::string_view> fields = between_commas(trimmed);
    if (trimmed.find('"') != std::string_view::npos || trimmed.ends_with(',')) return false;
    const bool first_is_number = read_text_number(fields.front(), '.').has_value() || is_missing_value(fields.front());
    return fields.size() == *columns ? first_is_number
                                     : fields.size() != 2 * *columns && fields.size() + 1 != 2 * *columns;
  }
  return columns.has_value();
}

RawTable read_measurement(const std::filesystem::path& file, FileKind kind, std::string_view bytes, std::size_t skip,
                          const ReadingProgress& progress) {
  const std::string source = file.string();
  if (file == "-" && !is_read_whole(kind)) {
    throw firmware::InputError("standard input", 0, "MATLAB, HDF5 and Excel files are read by their names", "a file");
  }
  switch (kind) {
    case FileKind::matlab:
      return table_of_mat(file, read_mat_leaves(file));
    case FileKind::hdf5: {
      std::optional<RawTable> table = table_of_leaves(read_hdf5_leaves(file), '/', source, "HDF5");
      if (!table) {
        throw firmware::InputError(source, 0, "no signals with a time are found",
                                   "data sets beside one called time, or an attribute such as sample_rate");
      }
      return std::move(*table);
    }
    case FileKind::matlab_4:
      return table_of_mat(file, read_matlab_4_leaves(bytes, source));
    case FileKind::rpc:
      return table_of_rpc(bytes, source);
    case FileKind::mdf:
      return table_of_mdf(bytes, source);
    case FileKind::tdms:
      return table_of_tdms(bytes, source);
    case FileKind::universal:
      return table_of_universal_file(bytes, source);
    case FileKind::mcap:
      return table_of_mcap(bytes, source);
    case FileKind::workbook:
      return table_of_workbook(file);
    case FileKind::text:
      break;
  }
  return read_text_table(bytes, source, skip, progress);
}

firmware::InputError unknown_kind(const std::filesystem::path& file, std::string_view head) {
  struct Known {
    std::string_view begin, what, advice;
  };
  using std::string_view_literals::operator""sv;
  constexpr std::array known{
      Known{"TDSh"sv, "the index of an NI TDMS file", "the .tdms file beside it"},
      Known{"\x1f\x8b"sv, "a gzip archive", "its contents: gunzip it first"},
      Known{"BZh"sv, "a bzip2 archive", "its contents: bunzip2 it first"},
      Known{"\xfd"
            "7zXZ"sv,
            "an xz archive", "its contents: unxz it first"},
      Known{"\x28\xb5\x2f\xfd"sv, "a Zstandard archive", "its contents: unzstd it first"},
      Known{"7z\xbc\xaf"sv, "a 7z archive", "its contents: unpack it first"},
      Known{"\xd0\xcf\x11\xe0"sv, "an Excel workbook of before 2007 (.xls)", "its sheet exported as CSV"},
      Known{"PAR1"sv, "a Parquet file", "its columns exported as CSV"},
      Known{"SQLite format 3"sv, "an SQLite database", "its table exported as CSV"},
      Known{"RIFF"sv, "a RIFF file (sound or video)", "its samples exported as CSV"},
      Known{"#ROSBAG"sv, "a ROS bag", "its topic exported as CSV"},
      Known{"%PDF"sv, "a PDF document", "the measurement itself"},
      Known{"\x89PNG"sv, "a picture", "the measurement itself"},
      Known{"\x0e\x03\x13\x01"sv, "an HDF4 file", "HDF5: h4toh5 converts it"},
  };
  const std::string source = file.string();
  const auto error = [&](std::string_view what, std::string_view advice) {
    return firmware::InputError(source, 0, "this is " + std::string(what), std::string(advice));
  };
  if (head.starts_with("PK\x03\x04")) {
    if (head.find("opendocument.spreadsheet") != std::string_view::npos)
      return error("an OpenDocument spreadsheet (.ods)", "its sheet exported as CSV");
    return error("a zip archive", "its contents: unzip it first");
  }
  for (const Known& one : known) {
    if (head.starts_with(one.begin)) return error(one.what, one.advice);
  }
  return {source, 0, "the file is no text", "text, MATLAB, NI TDMS, RPC III, MDF 4, HDF5 or a universal file"};
}

}  // namespace host_sim
