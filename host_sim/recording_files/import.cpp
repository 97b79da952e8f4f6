#include "host_sim/recording_files/import.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "firmware/recording/recording_file.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "firmware/recording/sample_checks.hpp"
#include "host_sim/recording_files/mapped_memory.hpp"
#include "host_sim/recording_files/measurement_file.hpp"
#include "host_sim/recording_files/recording_mat.hpp"
#include "host_sim/recording_files/tables/headings.hpp"
#include "host_sim/recording_files/tables/table_recording.hpp"
#include "host_sim/recording_files/tables/time_entry.hpp"
#include "host_sim/recording_files/text/text_encoding.hpp"
#include "host_sim/recording_files/text/text_values.hpp"

namespace host_sim {
namespace {

using firmware::in_quotes;

RawTable read_any_table(const std::filesystem::path& file, std::size_t skip, const ReadingProgress& progress) {
  const firmware::RecordingFile opened(file);
  const FileKind kind = kind_of_file(file, opened.head(), opened.is_matlab());
  if (kind == FileKind::text && !looks_like_text(opened.head())) throw unknown_kind(file, opened.head());
  std::optional<FileContents> contents;
  if (is_read_whole(kind)) contents.emplace(opened.descriptor(), opened.head(), file.string());
  return read_measurement(file, kind, contents ? contents->bytes() : std::string_view(), skip, progress);
}

// What the description says of the time, unless the user says something else.
TimeEntry entry_for(const ImportChoices& choices, firmware::ChannelMap& described) {
  TimeEntry entry = take_time_entry(described);
  if (choices.time) entry.rate.reset();
  if (choices.rate) entry.rate = choices.rate;
  if (choices.skip > 0) entry.skip = choices.skip;
  return entry;
}

// "COLUMN * factor + offset", taken apart from its end; operators stand between blanks.
struct ColumnFormula {
  std::string column;
  std::optional<double> factor;
  double offset = 0.0;
};

// The number behind the last " + ", " * " … of the text, which are removed; nullopt: it does not end so.
std::optional<double> take_operand(std::string& text, std::string_view signs, char& sign) {
  const std::size_t at = text.find_last_of(signs);
  if (at == std::string::npos || at < 2 || text[at - 1] != ' ') return std::nullopt;
  const std::string_view operand = firmware::trimmed(std::string_view(text).substr(at + 1));
  const std::optional<TextNumber> number = read_text_number(operand, '.');
  if (!number || number->weak || !std::isfinite(number->value)) return std::nullopt;
  sign = text[at];
  text.resize(at);
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return number->value;
}

ColumnFormula read_formula(std::string text) {
  ColumnFormula formula;
  char sign = '+';
  // "1e-3": the minus of an exponent has no blank before it.
  if (const std::optional<double> offset = take_operand(text, "+-", sign))
    formula.offset = sign == '-' ? -*offset : *offset;
  if (const std::optional<double> factor = take_operand(text, "*/", sign))
    formula.factor = sign == '/' ? 1.0 / *factor : *factor;
  text = firmware::trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  formula.column = text;
  return formula;
}

// The entry of [channels] that a choice stands for.
firmware::ColumnSource entry_of(const RawTable& table, const std::string& text, firmware::Quantity quantity) {
  const auto entry = [&](std::size_t c, std::optional<double> scale, double offset) {
    return firmware::ColumnSource{unique_name(table, c), scale, offset};
  };
  if (const auto whole = find_column(table, text)) {
    // A heading that ends as a formula does is a heading.
    return entry(*whole, std::nullopt, 0.0);
  }
  const ColumnFormula formula = read_formula(text);
  std::optional<std::size_t> column = find_column(table, formula.column);
  std::optional<firmware::Unit> unit;
  NameAndUnit heading = split_heading(formula.column);
  if (column && formula.column.ends_with(']')) unit = firmware::find_unit(heading.unit);
  if (!column && formula.column.ends_with(']')) {
    column = find_column(table, heading.name);
    unit = firmware::find_unit(heading.unit);
    if (column && (!unit || unit->dimension != firmware::dimension_of(quantity))) {
      throw firmware::UsageError(in_quotes(heading.unit) + " is no unit of " +
                                 std::string(firmware::quantity_name(quantity)) + " [" +
                                 std::string(firmware::quantity_unit(quantity)) + "]");
    }
  }
  if (!column) {
    throw firmware::InputError(table.source, table.header_line, "no column is called " + in_quotes(formula.column),
                               "one of " + list_of_columns(table));
  }
  const double by_unit = unit ? unit->scale : 1.0;
  if (!unit && !formula.factor && formula.offset == 0.0) return entry(*column, std::nullopt, 0.0);
  if (!unit && !formula.factor) return entry(*column, std::nullopt, formula.offset);
  return entry(*column, formula.factor.value_or(1.0) * by_unit, formula.offset * by_unit);
}

// [channels] with the user's choices in front of it.
firmware::ChannelMap with_choices(const RawTable& table, const firmware::ChannelMap& channels,
                                  const ImportChoices& choices) {
  firmware::ChannelMap map = channels;
  std::vector<std::string> named;
  for (const std::string& text : choices.maps) {
    const std::size_t equals = text.find('=');
    const std::string wanted(firmware::trimmed(std::string_view(text).substr(0, equals)));
    const std::optional<firmware::Quantity> quantity = firmware::find_quantity(wanted);
    if (equals == std::string::npos || !quantity) {
      throw firmware::UsageError("--map " + in_quotes(text) + " names no channel" +
                                 (quantity ? "" : ": 'CHANNEL=COLUMN', as in 'F=Kraft [kN]'"));
    }
    map[wanted] = entry_of(table, std::string(firmware::trimmed(std::string_view(text).substr(equals + 1))), *quantity);
    named.push_back(map[wanted].column);
  }
  if (choices.time) {
    map["t"] = entry_of(table, *choices.time, firmware::time_quantity);
    named.push_back(map["t"].column);
  }
  // A column that the user names is no other channel of the description.
  std::erase_if(map, [&](const auto& entry) {
    const bool by_user = (choices.time && entry.first == "t") ||
                         std::any_of(choices.maps.begin(), choices.maps.end(), [&](const std::string& text) {
                           return firmware::trimmed(std::string_view(text).substr(0, text.find('='))) == entry.first;
                         });
    return !by_user && std::find(named.begin(), named.end(), entry.second.column) != named.end();
  });
  return map;
}

// The part of a recording between two instants.
void keep_part(firmware::Recording& recording, const ImportChoices& choices) {
  if (!choices.from && !choices.to) return;
  const double from = choices.from.value_or(-INFINITY);
  const double to = choices.to.value_or(INFINITY);
  const auto begin = std::lower_bound(recording.time.begin(), recording.time.end(), from) - recording.time.begin();
  const auto end = std::upper_bound(recording.time.begin(), recording.time.end(), to) - recording.time.begin();
  if (end - begin < 2) {
    throw firmware::InputError(recording.source, 0,
                               "no two samples lie between --from and --to: the recording is " +
                                   firmware::shortest(recording.time.front()) + " … " +
                                   firmware::shortest(recording.time.back()) + " s",
                               "a part of it");
  }
  const auto cut = [&](std::vector<double>& column) {
    if (column.empty()) return;
    column.erase(column.begin() + end, column.end());
    column.erase(column.begin(), column.begin() + begin);
  };
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) cut(values(recording, q));
  for (firmware::ExtraColumn& extra : recording.extra) cut(extra.values);
}

ListedColumn listed(const RawTable& table, std::size_t c) {
  const RawColumn& column = table.columns[c];
  ListedColumn one;
  one.name = unique_name(table, c);
  if (one.name == column.text && !column.unit.empty()) one.name = column.text;
  one.unit = column.unit;
  one.low = INFINITY;
  one.high = -INFINITY;
  double squares = 0.0;
  for (const double value : column.values) {
    if (std::isnan(value)) continue;
    ++one.count;
    one.low = std::min(one.low, value);
    one.high = std::max(one.high, value);
    squares += value * value;
    if (one.first.size() < 3) one.first.push_back(value);
  }
  one.rms = one.count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(one.count));
  return one;
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

Import import_file(const std::filesystem::path& file, const RigContext& rig, const ImportChoices& choices) {
  firmware::ChannelMap described = rig.channels;
  const TimeEntry time_entry = entry_for(choices, described);
  RawTable table = read_any_table(file, time_entry.skip, choices.progress);
  const firmware::ChannelMap map = with_choices(table, described, choices);
  const RigContext context{map, rig.rate, rig.kind, time_entry.rate};
  const Interpretation meaning = interpret(table, context);
  TableRecording built = to_recording(table, meaning, context, true);
  Import result;
  result.format = table.format;
  result.channels = channel_map_of(table, meaning);
  put_time_entry(time_entry, result.channels);
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
  for (const std::vector<LeftOut>* list : {&std::as_const(table.left_out), &std::as_const(built.left_out)})
    result.left_out.insert(result.left_out.end(), list->begin(), list->end());
  result.recording = std::move(built.recording);
  keep_part(result.recording, choices);
  return result;
}

FileListing list_file(const std::filesystem::path& file, const RigContext& rig, const ImportChoices& choices) {
  firmware::ChannelMap described = rig.channels;
  const TimeEntry time_entry = entry_for(choices, described);
  RawTable table = read_any_table(file, time_entry.skip, choices.progress);
  FileListing result;
  result.format = table.format;
  const firmware::ChannelMap map = with_choices(table, described, choices);
  const RigContext context{map, rig.rate, rig.kind, time_entry.rate, true};
  Interpretation meaning;
  try {
    meaning = interpret(table, context);
  } catch (const firmware::InputError& error) {
    result.notes.emplace_back(error.what());
  }
  std::optional<double> rate;
  if (meaning.time.column && !meaning.time.counts) {
    const std::vector<double>& stamps = table.columns[*meaning.time.column].values;
    if (stamps.size() > 1) {
      const double step = firmware::median_step(stamps) * std::abs(meaning.time.scale);
      if (step > 0.0) rate = 1.0 / step;
    }
  } else if (meaning.time.rate > 0.0) {
    rate = meaning.time.rate;
  }
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    ListedColumn one = listed(table, c);
    const RawColumn& column = table.columns[c];
    one.rate = rate;
    if (column.own_time.size() > 1) one.rate = 1.0 / firmware::median_step(column.own_time);
    if (column.is_slow && rate) one.rate = *rate * static_cast<double>(one.count) / static_cast<double>(table.rows);
    if (meaning.time.column == c) {
      one.quantity = "t";
      one.reason = meaning.time.reason;
    }
    for (const ColumnMeaning& channel : meaning.channels) {
      if (channel.column != c) continue;
      one.quantity = firmware::quantity_name(channel.quantity);
      one.reason = channel.reason;
    }
    result.columns.push_back(std::move(one));
  }
  result.left_out = table.left_out;
  for (const std::vector<std::string>* notes : {&std::as_const(meaning.notes), &std::as_const(table.notes)})
    result.notes.insert(result.notes.end(), notes->begin(), notes->end());
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
