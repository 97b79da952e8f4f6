#include "host_sim/recording_files/recording_files.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_file.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "host_sim/recording_files/export/mcap_file.hpp"
#include "host_sim/recording_files/export/mdf_writer.hpp"
#include "host_sim/recording_files/export/rpc_writer.hpp"
#include "host_sim/recording_files/export/spreadsheet.hpp"
#include "host_sim/recording_files/export/universal_history.hpp"
#include "host_sim/recording_files/mapped_memory.hpp"
#include "host_sim/recording_files/measurement_file.hpp"
#include "host_sim/recording_files/recording_mat.hpp"
#include "host_sim/recording_files/tables/table_recording.hpp"
#include "host_sim/recording_files/tables/time_entry.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_table.hpp"

namespace host_sim {
namespace {

bool is_called(const std::filesystem::path& file, std::string_view ending) {
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.size() > ending.size() && name.ends_with(ending);
}

bool is_called_mat(const std::filesystem::path& file) { return is_called(file, ".mat"); }

// What a caller hands to be written must be whole: columns of one length, as a reader will expect them.
void check_columns(const std::filesystem::path& file, const firmware::Recording& recording) {
  const auto check = [&](std::string_view column, std::size_t size) {
    if (size == recording.size()) return;
    throw std::logic_error(file.string() + ": column " + std::string(column) + " has " + std::to_string(size) +
                           " samples, t has " + std::to_string(recording.size()));
  };
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) {
    if (!values(recording, q).empty()) check(firmware::quantity_name(q), values(recording, q).size());
  }
  for (const firmware::ExtraColumn& extra : recording.extra) check(extra.name, extra.values.size());
}

// Text that is no recording of the contract, as a table.
firmware::Recording read_foreign_text(std::string_view text, const std::string& source, const RigContext& rig,
                                      firmware::Missing missing, std::size_t skip) {
  RawTable table;
  try {
    table = read_text_table(text, source, skip);
  } catch (const firmware::InputError&) {
    if (!looks_like_text(text)) throw;
    // No table: the strict reader says better why.
    static_cast<void>(firmware::parse_recording_csv(text, source, rig.channels, rig.rate, missing));
    throw;
  }
  return read_table_recording(std::move(table), rig, missing);
}

// A contract file with lines between its rows or words for missing values: once more with the other reader, which
// leaves them out and says so. Short rows and other words stay errors; own files are whole or damaged.
firmware::Recording read_contract_text(std::string_view text, const std::string& source, const RigContext& rig,
                                       firmware::Missing missing) {
  try {
    return firmware::parse_recording_csv(text, source, rig.channels, rig.rate, missing);
  } catch (const firmware::InputError&) {
    if (missing == firmware::Missing::refuse || text.find(firmware::recording_mark) < 4096) throw;
    RawTable table;
    try {
      table = read_text_table(text, source);
      const bool damaged = std::any_of(table.faults.begin(), table.faults.end(),
                                       [](const RawFault& fault) { return !fault.says_missing; });
      if (damaged || (table.faults.empty() && table.notes.empty())) throw;
      return read_table_recording(std::move(table), rig, missing);
    } catch (const firmware::InputError&) {
    }
    throw;
  }
}

firmware::Recording read(const std::filesystem::path& file, const RigContext& described, firmware::Missing missing) {
  const std::string source = file.string();
  firmware::ChannelMap channels = described.channels;
  const TimeEntry time = take_time_entry(channels);
  const RigContext rig{channels, described.rate, described.kind, time.rate};
  const firmware::RecordingFile opened(file);
  const FileKind kind = kind_of_file(file, opened.head(), opened.is_matlab());
  if (kind == FileKind::matlab) {
    std::vector<Leaf> leaves = read_mat_leaves(file);
    if (is_contract_mat(file, leaves, rig.channels)) {
      return read_recording_mat(file, std::move(leaves), rig.channels, rig.rate, missing);
    }
    return read_table_recording(table_of_mat(file, leaves), rig, missing);
  }
  if (kind == FileKind::text && !opened.head().empty() && !looks_like_text(opened.head()) && !is_called_mat(file)) {
    const firmware::InputError known = unknown_kind(file, opened.head());
    if (std::string_view(known.what()).find("this is ") != std::string_view::npos) throw known;
  }
  if (is_called_mat(file) && kind == FileKind::text && !opened.head().empty()) {
    throw firmware::InputError(source, 0, "is not a MATLAB 5 or 7.3 file", "one saved with -v6, -v7 or -v7.3");
  }
  if (kind != FileKind::text) {
    std::optional<FileContents> contents;
    if (is_read_whole(kind)) contents.emplace(opened.descriptor(), opened.head(), source);
    return read_table_recording(
        read_measurement(file, kind, contents ? contents->bytes() : std::string_view(), time.skip), rig, missing);
  }
  // What is no text is refused at its first line, however long it is: a device may be endless.
  if (!looks_like_text(opened.head())) {
    return firmware::read_recording_csv(opened.descriptor(), opened.head(), source, rig.channels, rig.rate, missing);
  }
  if (opened.head().find(firmware::recording_mark) != std::string::npos &&
      is_contract_csv(opened.head(), rig.channels)) {
    return firmware::read_recording_csv(opened.descriptor(), opened.head(), source, rig.channels, rig.rate, missing);
  }
  const FileContents contents(opened.descriptor(), opened.head(), source);
  const std::string_view text = contents.bytes();
  if (is_contract_csv(text, rig.channels)) return read_contract_text(text, source, rig, missing);
  return read_foreign_text(text, source, rig, missing, time.skip);
}

}  // namespace

firmware::Recording read_recording(const std::filesystem::path& file, const firmware::ChannelMap& map,
                                   std::optional<double> expected_rate) {
  return read(file, {map, expected_rate, std::nullopt}, firmware::Missing::refuse);
}

std::vector<firmware::Recording> read_parts(const std::filesystem::path& file, const firmware::ChannelMap& map,
                                            std::optional<double> usual_rate, std::optional<model::RigKind> kind) {
  return firmware::pieces_of(read(file, {map, usual_rate, kind}, firmware::Missing::mark));
}

std::optional<PartsOfEnds> read_parts_of_ends(const std::filesystem::path& file, const firmware::ChannelMap& map,
                                              std::optional<double> usual_rate, double first, double last,
                                              std::size_t least_size) {
  if (file == "-") return std::nullopt;  // a stream has one end
  const firmware::RecordingFile opened(file);
  const bool text = kind_of_file(file, opened.head(), opened.is_matlab()) == FileKind::text && !is_called_mat(file);
  if (!text || !is_contract_csv(opened.head(), map)) return std::nullopt;
  auto ends =
      firmware::read_recording_ends(opened.descriptor(), file.string(), map, usual_rate, first, last, least_size);
  if (!ends) return std::nullopt;
  return PartsOfEnds{firmware::pieces_of(std::move(ends->first)), firmware::pieces_of(std::move(ends->last)),
                     ends->seconds};
}

void refuse_unknown_ending(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  // ".1" and ".2024" are parts of a name.
  const bool has_letters =
      std::any_of(ending.begin(), ending.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  if (!has_letters || file.string().starts_with("/dev/")) return;
  constexpr std::array<std::string_view, 11> written{".csv", ".txt", ".tsv", ".mat", ".mf4", ".rsp",
                                                     ".drv", ".tim", ".uff", ".unv", ".mcap"};
  if (std::any_of(written.begin(), written.end(), [&](std::string_view known) { return is_called(file, known); }))
    return;
  std::string list;
  for (const std::string_view known : written) list += (list.empty() ? "" : ", ") + std::string(known);
  throw firmware::OutputError(file.string(), "recordings are not written as " + firmware::in_quotes(ending),
                              "one of " + list + ", .de.csv");
}

void write_recording(const std::filesystem::path& file, const firmware::Recording& recording,
                     const ReadingProgress& progress) {
  refuse_unknown_ending(file);
  check_columns(file, recording);
  if (is_called_mat(file)) return write_recording_mat(file, recording);
  firmware::OutputFile output(file);
  const std::function<void(std::string_view)> take = [&](std::string_view bytes) { output.write(bytes); };
  if (is_called(file, ".rsp") || is_called(file, ".drv") || is_called(file, ".tim")) {
    format_rpc(recording, file.string(), take);
  } else if (is_called(file, ".mf4")) {
    format_mdf(recording, take);
  } else if (is_called(file, ".mcap")) {
    format_mcap(recording, take);
  } else if (is_called(file, ".uff") || is_called(file, ".unv")) {
    format_universal(recording, file.string(), take);
  } else if (is_called(file, ".tsv")) {
    format_spreadsheet(recording, SpreadsheetStyle::decimal_point, take);
  } else if (is_called(file, ".de.csv")) {
    format_spreadsheet(recording, SpreadsheetStyle::decimal_comma, take);
  } else {
    firmware::format_recording_csv(recording, take, progress);
  }
  output.commit();
}

}  // namespace host_sim
