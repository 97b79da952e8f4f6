#include "host_sim/commands/import_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/version.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/sample_checks.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/commands/common/verbosity.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/mapped_memory.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace host_sim {
namespace {

std::string text_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void print_left_out(std::FILE* to, const std::vector<LeftOut>& list) {
  for (const LeftOut& one : list) {
    std::fprintf(to, "  left out: %s: %s\n", firmware::one_line(firmware::in_quotes(one.name)).c_str(),
                 firmware::one_line(one.reason).c_str());
  }
}

void print_account(std::FILE* to, const Import& import, const ImportOptions& options) {
  const firmware::Recording& recording = import.recording;
  const double step = firmware::median_step(recording.time);
  std::fprintf(to, "%s: %s, %zu samples at %.6g Hz, %.6g s\n", options.file.c_str(), import.format.c_str(),
               recording.size(), 1.0 / step, recording.time.back() - recording.time.front());
  for (const ImportedColumn& column : import.columns) {
    std::string from = column.column.empty() ? "" : firmware::in_quotes(column.column);
    if (!column.unit.empty()) from += " [" + column.unit + "]";
    std::string how;
    if (column.scale != 1.0) how += "  × " + firmware::shortest(column.scale);
    if (column.offset != 0.0) how += "  + " + firmware::shortest(column.offset);
    std::fprintf(to, "  %-6s %s%s\n", column.quantity.empty() ? "kept" : column.quantity.c_str(), from.c_str(),
                 how.c_str());
  }
  print_left_out(to, import.left_out);
  for (const std::string& note : import.notes) std::fprintf(to, "  note: %s\n", firmware::one_line(note).c_str());
}

nlohmann::ordered_json left_out_json(const std::vector<LeftOut>& list) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const LeftOut& one : list) json.push_back({{"name", one.name}, {"reason", one.reason}});
  return json;
}

nlohmann::ordered_json account_json(const Import& import, const ImportOptions& options) {
  nlohmann::ordered_json json;
  json["file"] = options.file.string();
  json["format"] = import.format;
  json["samples"] = import.recording.size();
  json["sample_rate"] = 1.0 / firmware::median_step(import.recording.time);
  json["columns"] = nlohmann::ordered_json::array();
  for (const ImportedColumn& column : import.columns) {
    json["columns"].push_back({{"channel", column.quantity},
                               {"column", column.column},
                               {"unit", column.unit},
                               {"scale", column.scale},
                               {"offset", column.offset},
                               {"reason", column.reason}});
  }
  json["left_out"] = left_out_json(import.left_out);
  json["notes"] = import.notes;
  return json;
}

std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

void print_listing(const FileListing& listing, const ImportOptions& options) {
  std::printf("%s: %s\n", options.file.c_str(), listing.format.c_str());
  for (const ListedColumn& column : listing.columns) {
    std::string line = "  " + firmware::in_quotes(column.name);
    if (!column.unit.empty()) line += " in " + column.unit;
    line += ": " + std::to_string(column.count) + " values";
    if (column.rate) line += " at " + number_text(*column.rate) + " Hz";
    if (column.count > 0) {
      line += ", " + number_text(column.low) + " … " + number_text(column.high) + ", rms " + number_text(column.rms) +
              ", first";
      for (const double value : column.first) line += " " + number_text(value);
    }
    line += column.quantity.empty() ? "; no channel" : "; " + column.quantity;
    if (!column.reason.empty()) line += " (" + column.reason + ")";
    std::printf("%s\n", firmware::one_line(line).c_str());
  }
  print_left_out(stdout, listing.left_out);
  const auto unread = std::find_if(listing.columns.begin(), listing.columns.end(),
                                   [](const ListedColumn& column) { return column.quantity.empty(); });
  if (unread != listing.columns.end()) {
    const std::string line = "  a column that is no channel becomes one by --map 'F=" + unread->name +
                             "', or by a line under [channels] of the rig description: F = { column = \"" +
                             unread->name + "\" }; rigtwin channels lists the channels";
    std::printf("%s\n", firmware::one_line(line).c_str());
  }
  for (const std::string& note : listing.notes) std::printf("  note: %s\n", firmware::one_line(note).c_str());
}

nlohmann::ordered_json listing_json(const FileListing& listing, const ImportOptions& options) {
  nlohmann::ordered_json json{{"schema", "rigtwin/import_listing/1"}};
  json["file"] = options.file.string();
  json["format"] = listing.format;
  json["columns"] = nlohmann::ordered_json::array();
  for (const ListedColumn& column : listing.columns) {
    nlohmann::ordered_json one{{"column", column.name}, {"unit", column.unit}, {"count", column.count}};
    one["rate"] = column.rate ? nlohmann::ordered_json(*column.rate) : nlohmann::ordered_json();
    if (column.count > 0) {
      one["low"] = column.low;
      one["high"] = column.high;
      one["rms"] = column.rms;
    }
    one["first"] = column.first;
    one["channel"] = column.quantity;
    one["reason"] = column.reason;
    json["columns"].push_back(std::move(one));
  }
  json["left_out"] = left_out_json(listing.left_out);
  json["notes"] = listing.notes;
  return json;
}

}  // namespace

void import_recording(const ImportOptions& options) {
  if (options.write_channels && !options.rig)
    throw firmware::UsageError("--write-channels needs --rig, the description to write to");
  if (options.out) refuse_unknown_ending(*options.out);
  if (options.out && *options.out == "-" && options.json == "-")
    throw firmware::UsageError("--out and --json are both standard output, expected one of them");
  keep_large_blocks_in_files();
  std::optional<firmware::RigDescription> rig;
  if (options.rig) rig = firmware::read_rig(*options.rig);
  const firmware::ChannelMap none;
  const RigContext context{rig ? rig->channels : none, rig ? std::optional(rig->sample_rate) : std::nullopt,
                           rig ? std::optional(rig->rig.kind) : std::nullopt};
  // Reading and writing take about as long as each other.
  Progress progress("import");
  ImportChoices choices = options.choices;
  choices.progress = [&progress](double share) { progress.show(0.5 * share); };
  if (!options.out) {
    if (options.write_channels) throw firmware::UsageError("--write-channels needs --out");
    const FileListing listing = list_file(options.file, context, choices);
    progress.end();
    if (!write_json(options.json, listing_json(listing, options))) print_listing(listing, options);
    return;
  }
  Import import = import_file(options.file, context, choices);
  std::string description;
  if (options.write_channels) {
    description = with_channels(text_of_file(*options.rig), import.channels,
                                "columns of " + options.file.filename().string() + ", by rigtwin import");
    // Nothing is written that the next command would refuse.
    static_cast<void>(firmware::parse_rig(description, options.rig->string() + " with the new [channels]"));
  }
  import.recording.comments.push_back("rigtwin " + std::string(firmware::version) +
                                      " import: " + options.file.filename().string() + ", " + import.format);
  for (const std::string& note : import.notes) import.recording.comments.push_back(note);
  for (const LeftOut& one : import.left_out)
    import.recording.comments.push_back("left out: " + firmware::in_quotes(one.name) + ": " + one.reason);
  write_recording(*options.out, import.recording, [&progress](double share) { progress.show(0.5 + 0.5 * share); });
  progress.end();
  const bool only_json = write_json(options.json, account_json(import, options));  // its inputs are still as read
  if (options.write_channels) firmware::write_file(*options.rig, description);
  if (only_json || verbosity() == Verbosity::quiet) return;
  std::FILE* const to = *options.out == "-" ? stderr : stdout;
  print_account(to, import, options);
  if (*options.out != "-") std::fprintf(to, "recording %s\n", options.out->c_str());
  if (options.write_channels) std::fprintf(to, "channels  %s, table [channels]\n", options.rig->c_str());
}

void add_import(CLI::App& app, ImportOptions& options) {
  CLI::App* command = app.add_subcommand("import", "Bring a measurement file of another program into a recording");
  command
      ->add_option(
          "file", options.file,
          "Text (any separator, decimal comma, preamble, units, clock times; MTS exports, LabVIEW), MATLAB (dSPACE "
          "ControlDesk, Simulink, timetables as structures), NI TDMS, HDF5, RPC III, MDF 4, universal file, "
          "MCAP (JSON) or Excel (.xlsx); - for standard input")
      ->required();
  command->add_option(
      "--out", options.out,
      "Recording to write; the ending decides: .csv, .mat, .mf4, .rsp, .mcap, .uff, .tsv and .de.csv (spreadsheets); "
      "- for CSV on standard output. Without it the file's columns are listed, with what they are taken for");
  command
      ->add_option("--map", options.choices.maps,
                   "CHANNEL=COLUMN for a column under another name, with unit, factor and offset where they are "
                   "wanted: 'F=Kraft [kN]', 'x_act=CHANNEL0 * 0.01 + 0.2' (SI); 'group/name' where names repeat")
      ->take_all()
      ->expected(1);
  command->add_option("--rate", options.choices.rate, "Sampling rate in Hz: the rows are samples at this rate")
      ->check(CLI::PositiveNumber);
  command->add_option("--time", options.choices.time,
                      "Column that is the time, with its unit if it states none: 'Zeit 2 [ms]'");
  command->add_option("--skip", options.choices.skip, "Lines of text at the begin that are not looked at");
  command->add_option("--from", options.choices.from, "Keep the recording from this time on, in s");
  command->add_option("--to", options.choices.to, "Keep the recording up to this time, in s");
  command->add_option("--rig", options.rig,
                      "Rig description: its [channels] name columns; its kind and rate help to guess");
  command->add_flag("--write-channels", options.write_channels,
                    "Write the mapping of names and units into the rig description's [channels]");
  command->add_option("--json", options.json, "Write the account of the columns as JSON (- for standard output)");
  command->callback([&options] { import_recording(options); });
}

}  // namespace host_sim
