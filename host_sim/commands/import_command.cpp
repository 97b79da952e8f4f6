#include "host_sim/commands/import_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/version.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/sample_checks.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace host_sim {
namespace {

std::string text_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void print_account(const Import& import, const ImportOptions& options) {
  const firmware::Recording& recording = import.recording;
  const double step = firmware::median_step(recording.time);
  std::printf("%s: %s, %zu samples at %.6g Hz, %.6g s\n", options.file.c_str(), import.format.c_str(), recording.size(),
              1.0 / step, recording.time.back() - recording.time.front());
  for (const ImportedColumn& column : import.columns) {
    std::string from = column.column.empty() ? "" : firmware::in_quotes(column.column);
    if (!column.unit.empty()) from += " [" + column.unit + "]";
    std::string how;
    if (column.scale != 1.0) how += "  × " + firmware::shortest(column.scale);
    if (column.offset != 0.0) how += "  + " + firmware::shortest(column.offset);
    std::printf("  %-6s %s%s\n", column.quantity.empty() ? "kept" : column.quantity.c_str(), from.c_str(), how.c_str());
  }
  for (const std::string& note : import.notes) std::printf("  note: %s\n", firmware::one_line(note).c_str());
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
  json["notes"] = import.notes;
  return json;
}

}  // namespace

void import_recording(const ImportOptions& options) {
  if (options.write_channels && !options.rig)
    throw firmware::UsageError("--write-channels needs --rig, the description to write to");
  std::optional<firmware::RigDescription> rig;
  if (options.rig) rig = firmware::read_rig(*options.rig);
  const firmware::ChannelMap none;
  const RigContext context{rig ? rig->channels : none, rig ? std::optional(rig->sample_rate) : std::nullopt,
                           rig ? std::optional(rig->rig.kind) : std::nullopt};
  Import import = import_file(options.file, context);
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
  write_recording(options.out, import.recording);
  if (options.write_channels) firmware::write_file(*options.rig, description);
  if (options.json) {
    const std::string text =
        account_json(import, options).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (*options.json == "-") {
      std::fputs(text.c_str(), stdout);
      return;
    }
    firmware::write_file(*options.json, text);
  }
  print_account(import, options);
  std::printf("recording %s\n", options.out.c_str());
  if (options.write_channels) std::printf("channels  %s, table [channels]\n", options.rig->c_str());
}

void add_import(CLI::App& app, ImportOptions& options) {
  CLI::App* command = app.add_subcommand("import", "Bring a measurement file of another program into a recording");
  command
      ->add_option("file", options.file,
                   "Text (any separator, decimal comma, preamble, units, clock times; MTS exports), MATLAB (dSPACE "
                   "ControlDesk, Simulink, timetables as structures), NI TDMS or HDF5")
      ->required();
  command
      ->add_option("--out", options.out,
                   "Recording to write; the ending decides: .csv, .mat, .mcap, .uff, .tsv and .de.csv (spreadsheets)")
      ->required();
  command->add_option("--rig", options.rig,
                      "Rig description: its [channels] name columns; its kind and rate help to guess");
  command->add_flag("--write-channels", options.write_channels,
                    "Write the mapping of names and units into the rig description's [channels]");
  command->add_option("--json", options.json, "Write the account of the columns as JSON (- for standard output)");
  command->callback([&options] { import_recording(options); });
}

}  // namespace host_sim
