#include "host_sim/recording_files/import.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/recording/recording_file.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "host_sim/recording_files/measurement_file.hpp"
#include "host_sim/recording_files/recording_mat.hpp"
#include "host_sim/recording_files/tables/table_recording.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"

namespace host_sim {
namespace {

using firmware::in_quotes;

RawTable read_any_table(const std::filesystem::path& file) {
  const firmware::RecordingFile opened(file);
  const FileKind kind = kind_of_file(file, opened.head(), opened.is_matlab());
  std::string bytes;
  if (kind == FileKind::text && !looks_like_text(opened.head())) {
    throw firmware::InputError(file.string(), 0, "the file is no text",
                               "text, MATLAB 5 or 7.3, NI TDMS, HDF5 or a universal file");
  }
  if (is_read_whole(kind)) bytes = read_whole(opened.descriptor(), opened.head(), file.string());
  return read_measurement(file, kind, std::move(bytes));
}

// A column's text as a TOML basic string.
std::string toml_string(const std::string& text) {
  constexpr std::string_view hex = "0123456789abcdef";
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += std::string("\\u00") + hex[byte >> 4U] + hex[byte & 0xfU];
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

std::string toml_number(double value) {
  std::string text = firmware::shortest(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string entry_line(const std::string& quantity, const firmware::ColumnSource& source) {
  std::string line = quantity + " = { column = " + toml_string(source.column);
  if (source.scale) line += ", scale = " + toml_number(*source.scale);
  if (source.offset != 0.0) line += ", offset = " + toml_number(source.offset);
  return line + " }";
}

// The key at the begin of a TOML line, quotes removed; empty: none.
std::string key_of(std::string_view line) {
  line = firmware::trimmed(line);
  const std::size_t end = line.find_first_of("=.#[");
  if (end == std::string_view::npos || (line[end] != '=' && line[end] != '.')) return "";
  std::string key(firmware::trimmed(line.substr(0, end)));
  std::erase(key, '"');
  std::erase(key, '\'');
  return key;
}

bool is_channels_header(std::string_view line) {
  line = firmware::trimmed(line.substr(0, line.find('#')));
  if (!line.starts_with('[') || !line.ends_with(']') || line.size() < 2) return false;
  return firmware::trimmed(line.substr(1, line.size() - 2)) == "channels";
}

}  // namespace

Import import_file(const std::filesystem::path& file, const RigContext& rig) {
  const RawTable table = read_any_table(file);
  const Interpretation meaning = interpret(table, rig);
  TableRecording built = to_recording(table, meaning, rig, true);
  Import result;
  result.format = table.format;
  result.channels = channel_map_of(table, meaning);
  const TimeMeaning& time = meaning.time;
  if (time.column) {
    const RawColumn& column = table.columns[*time.column];
    result.columns.push_back({"t", column.text, column.unit, time.scale, time.offset, time.reason});
  } else {
    result.columns.push_back({"t", "", "", 1.0, 0.0, time.reason.empty() ? "time axes of the file" : time.reason});
  }
  for (const ColumnMeaning& channel : meaning.channels) {
    result.columns.push_back({std::string(firmware::quantity_name(channel.quantity)),
                              table.columns[channel.column].text, channel.unit, channel.scale, channel.offset,
                              channel.reason});
  }
  std::sort(result.columns.begin() + 1, result.columns.end(), [](const ImportedColumn& a, const ImportedColumn& b) {
    return firmware::find_quantity(a.quantity) < firmware::find_quantity(b.quantity);
  });
  for (const firmware::ExtraColumn& extra : built.recording.extra)
    result.columns.push_back({"", extra.name, extra.unit, 1.0, 0.0, ""});
  for (const std::vector<std::string>* notes :
       {&std::as_const(meaning.notes), &std::as_const(built.notes), &std::as_const(table.notes)}) {
    result.notes.insert(result.notes.end(), notes->begin(), notes->end());
  }
  constexpr std::size_t most_faults = 5;
  for (std::size_t i = 0; i < std::min(table.faults.size(), most_faults); ++i) {
    const RawFault& fault = table.faults[i];
    result.notes.push_back("line " + std::to_string(fault.line) + ": " + fault.wrong + ", expected " + fault.expected);
  }
  if (table.faults.size() > most_faults) {
    result.notes.push_back("… and " + std::to_string(table.faults.size() - most_faults) + " more such lines");
  }
  result.recording = std::move(built.recording);
  return result;
}

std::string with_channels(const std::string& description, const firmware::ChannelMap& channels,
                          const std::string& comment) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < description.size();) {
    const std::size_t end = std::min(description.find('\n', i), description.size());
    lines.push_back(description.substr(i, end - i));
    i = end + 1;
  }
  if (std::none_of(lines.begin(), lines.end(), is_channels_header)) {
    if (!lines.empty() && !lines.back().empty()) lines.emplace_back();
    lines.emplace_back("[channels]");
  }
  std::vector<std::string> result;
  std::size_t after_table = 0;  // index in `result` behind the table's last line that is not empty
  bool inside = false;
  for (const std::string& line : lines) {
    const std::string_view trimmed = firmware::trimmed(line);
    if (trimmed.starts_with('[')) inside = is_channels_header(line);
    if (inside && channels.contains(key_of(line))) continue;
    result.push_back(line);
    if (inside && !trimmed.empty()) after_table = result.size();
  }
  std::vector<std::string> added;
  if (!comment.empty()) added.push_back("# " + firmware::one_line(comment));
  for (const auto& [quantity, source] : channels) added.push_back(entry_line(quantity, source));
  result.insert(result.begin() + static_cast<std::ptrdiff_t>(after_table), added.begin(), added.end());
  std::string text;
  for (const std::string& line : result) text += line + "\n";
  return text;
}

}  // namespace host_sim
