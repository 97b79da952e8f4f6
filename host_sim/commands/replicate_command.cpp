#include "host_sim/commands/replicate_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/option_checks.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/replicate/replicate_report.hpp"
#include "host_sim/replicate/replication.hpp"

namespace host_sim {
namespace {

namespace fs = std::filesystem;
using replicate::Replication;

std::string read_text(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw firmware::InputError(file.string(), 0, "cannot be read", "a file of rigtwin replicate");
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::string numbered(const char* what, std::size_t number, const char* ending = ".csv") {
  return what + std::to_string(number) + ending;
}

/// The folder of a new replication: absent, empty, or one of an earlier replication, which is replaced.
void prepare_replication(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw firmware::OutputError(folder.string(), "is not a folder", "a folder, or the name of a new one");
  }
  fs::create_directories(folder, error);
  if (error) {
    throw firmware::OutputError(folder.string(), "cannot be created: " + error.message(),
                                "a folder that may be written");
  }
  if (fs::is_empty(folder, error)) return;
  if (!fs::exists(folder / "replicate.json", error)) {
    throw firmware::OutputError(folder.string(), "holds files that rigtwin replicate did not write",
                                "another folder for the results");
  }
  fs::remove(folder / numbered("rig_", 0, ".toml"), error);
  for (const char* what : {"drive_", "run_", "rig_"}) {
    for (std::size_t i = 1;
         fs::remove(folder / numbered(what, i, what[0] == 'r' && what[1] == 'i' ? ".toml" : ".csv"), error); ++i) {
    }
  }
}

/// A recording as it is read again: columns of the contract alone.
firmware::Recording read_run_file(const fs::path& file, const firmware::RigDescription& description) {
  auto parts = read_parts(file, description.channels, description.sample_rate, description.rig.kind);
  if (parts.size() > 1) {
    throw firmware::InputError(file.string(), 0, "the recording has gaps", "a run without a gap of more than 20 ms");
  }
  return std::move(parts.front());
}

Replication read_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder / "replicate.json", error)) {
    throw firmware::InputError(folder.string(), 0, "holds no replication",
                               "a folder that rigtwin replicate --rig RIG.toml --target TARGET.csv --out made");
  }
  nlohmann::json state;
  try {
    state = nlohmann::json::parse(read_text(folder / "replicate.json"));
    const nlohmann::json& settings = state.at("settings");
    replicate::TargetRequest request;
    for (const nlohmann::json& one : settings.at("channels")) {
      const auto channel = model::find_channel(one.at("channel").get<std::string>());
      if (!channel) throw std::runtime_error("a channel that is none");
      request.channels.emplace_back(*channel, one.at("weight").get<double>());
      request.bands.emplace_back(*channel, replicate::FrequencyBand{one.at("band_hz").at(0).get<double>(),
                                                                    one.at("band_hz").at(1).get<double>()});
    }
    firmware::RigDescription description = firmware::read_rig(folder / "rig.toml");
    std::vector<firmware::Recording> events;
    for (std::size_t e = 1; e <= settings.at("events").get<std::size_t>(); ++e) {
      events.push_back(read_recording(folder / numbered("target_", e), description.channels));
    }
    Replication replication(description, request, std::move(events), settings.at("goal").get<double>());
    std::vector<replicate::Drive> drives;
    std::vector<replicate::RunResult> results;
    std::vector<firmware::Recording> runs;
    std::optional<firmware::RigDescription> refined;
    if (fs::exists(folder / numbered("rig_", 0, ".toml"), error))
      refined = firmware::read_rig(folder / numbered("rig_", 0, ".toml"));
    const model::Channel channel = replicate::drive_channel(replication.description().rig.kind);
    for (const nlohmann::json& run : state.at("runs")) {
      const std::string file = run.at("drive").get<std::string>();
      if (fs::path(file).filename() != file) throw std::runtime_error("a drive outside of the folder");
      const std::string hash = firmware::sha256(read_text(folder / file));
      if (hash != run.at("sha256").get<std::string>()) {
        throw firmware::InputError((folder / file).string(), 0, "was changed since it was made",
                                   "the drive with sha256 " + run.at("sha256").get<std::string>());
      }
      drives.push_back({read_recording(folder / file)[channel], file, hash});
      replicate::RunResult result;
      for (const auto& value : run.at("predicted_error"))
        result.predicted.push_back(value.is_number() ? value.get<double>() : 0.0);
      for (const auto& remark : run.at("remarks")) result.remarks.push_back(remark.get<std::string>());
      const nlohmann::json& used = run.at("limits_used");
      result.used = {used.at("stroke").get<double>(), used.at("speed").get<double>(),
                     used.at("acceleration").get<double>(), used.at("force").get<double>()};
      if (run.contains("predicted_error_without_limits")) {
        for (const auto& value : run.at("predicted_error_without_limits"))
          result.unlimited.push_back(value.is_number() ? value.get<double>() : 0.0);
      }
      results.push_back(std::move(result));
      if (!run.at("measured").get<bool>()) continue;
      const std::size_t number = runs.size() + 1;
      runs.push_back(read_run_file(folder / numbered("run_", number), replication.description()));
      const fs::path rig = folder / numbered("rig_", number, ".toml");
      if (fs::exists(rig, error)) refined = firmware::read_rig(rig);
    }
    if (drives.empty()) throw std::runtime_error("no drive");
    // Remarks on a lost channel or a short run are made again.
    replication.restore(std::move(drives), std::move(results), std::move(runs), std::move(refined));
    return replication;
  } catch (const nlohmann::json::exception&) {
    throw firmware::InputError((folder / "replicate.json").string(), 0, "is no result of rigtwin replicate",
                               "the file as it was written");
  } catch (const firmware::InputError&) {
    throw;
  } catch (const std::runtime_error& wrong) {
    throw firmware::InputError((folder / "replicate.json").string(), 0,
                               std::string("is no result of rigtwin replicate: ") + wrong.what(),
                               "the file as it was written");
  }
}

/// The newest drive as a file, and its hash. Written before replicate.json, which names it.
void write_drive(Replication& replication, const fs::path& folder) {
  const std::size_t newest = replication.drives().size() - 1;
  const fs::path file = folder / replication.drives()[newest].file;
  write_recording(file, replicate::drive_recording(replication, newest));
  replication.sign_newest(firmware::sha256(read_text(file)));
}

void write_results(const Replication& replication, const fs::path& folder, const nlohmann::ordered_json& result) {
  firmware::OutputFile report(folder / "report.html"), state(folder / "replicate.json");
  report.write(with_how_made(replicate::report_page(replication)));
  state.write(json_text(result));
  report.commit();
  state.commit();
}

void solve(Replication& replication) {
  Progress progress("replicate");
  replication.solve([&](double share, const std::string& what) { progress.show(share, what); });
}

/// What a diagnosis of the newest run adds to the model.
void diagnose_run(Replication& replication) {
  std::vector<identification::Record> records;
  records.push_back({replication.run_recordings().back(), identification::Use::shared});
  Progress progress("diagnose");
  const identification::Diagnosis diagnosis = identification::diagnose(
      replication.refined(), std::move(records),
      [&](double share, const std::string& what, std::size_t, std::size_t) { progress.show(share, what); });
  std::string found = "diagnose: ";
  for (const identification::NamedEffect& named : diagnosis.effects) {
    found += identification::words(named.effect);
    for (std::size_t p = 0; p < named.parameters.size(); ++p) {
      char text[96];
      std::snprintf(text, sizeof text, " %.4g %s", named.parameters[p].value,
                    identification::unit_of(named.effect, p).c_str());
      found += text;
    }
    found += ", ";
  }
  for (const identification::ParameterOff& off : diagnosis.parameters_off) found += off.path + " is off, ";
  if (!diagnosis.laws.empty()) found += std::to_string(diagnosis.laws.size()) + " learned law, ";
  found = diagnosis.effects.empty() && diagnosis.parameters_off.empty() && diagnosis.laws.empty()
              ? "diagnose named nothing that is missing; tolerated parameters are fitted"
              : found.substr(0, found.size() - 2);
  replication.refine(diagnosis.rig, found);
}

/// Explains the newest run, as far as it is asked for, and makes the next drive, unless no more is to be gained.
bool correct(Replication& replication, bool diagnose, const fs::path& folder) {
  if (replication.stop() == replicate::Stop::goal) return false;
  if (diagnose) {
    diagnose_run(replication);
  } else {
    replication.refine();
  }
  firmware::RigDescription refined = replication.refined();
  firmware::write_file(folder / numbered("rig_", replication.runs().size(), ".toml"), firmware::format_rig(refined));
  solve(replication);
  write_drive(replication, folder);
  return true;
}

void begin(const ReplicateOptions& options) {
  if (options.rig.empty() || options.target.empty() || options.channels.empty() || options.out.empty()) {
    throw firmware::UsageError(
        "replicate: --rig, --target, --channels and --out begin one; DIR with --measured or --simulated goes on");
  }
  if (!options.measured.empty() || !options.simulated.empty()) {
    throw firmware::UsageError(
        "replicate: --measured and --simulated go on with a replication, expected its folder before them");
  }
  const firmware::RigDescription description = firmware::read_rig(options.rig);
  if (description.rig.kind == model::RigKind::driven_mass) {
    throw firmware::InputError(description.source, description.line_of("driven_by"),
                               "no machine moves a mass that a force drives", "a rig with a machine to drive");
  }
  const replicate::TargetRequest request = replicate::parse_request(options.channels, options.bands);
  std::vector<firmware::Recording> events;
  for (const fs::path& file : options.target) events.push_back(read_recording(file, description.channels));
  Replication replication(description, request, events, options.goal);
  std::optional<firmware::Recording> before;
  if (!options.data.empty()) before = read_run_file(options.data, replication.description());
  prepare_replication(options.out);
  if (before) replication.refine_on(std::move(*before));
  solve(replication);
  firmware::write_file(options.out / "rig.toml", firmware::format_rig(description));
  if (!options.data.empty())
    firmware::write_file(options.out / numbered("rig_", 0, ".toml"), firmware::format_rig(replication.refined()));
  for (std::size_t e = 0; e < events.size(); ++e) {
    firmware::Recording kept;
    kept.sample_period = events[e].sample_period;
    kept.time = events[e].time;
    kept.comments.push_back("target of rigtwin replicate, from " + firmware::one_line(events[e].source));
    for (const auto& [channel, weight] : request.channels) kept[channel] = events[e][channel];
    write_recording(options.out / numbered("target_", e + 1), kept);
  }
  write_drive(replication, options.out);
  const auto result = replicate::to_json(replication);
  write_results(replication, options.out, result);
  for (const fs::path& file : options.more) write_recording(file, replicate::drive_recording(replication, 0));
  if (write_json(options.json, result)) return;
  std::printf("%s%s: drive_1.csv, report.html, replicate.json\n", replicate::summary(replication).c_str(),
              options.out.c_str());
}

firmware::Recording simulate_run(const Replication& replication, const firmware::RigDescription& truth,
                                 std::uint64_t seed) {
  const auto& drive = replication.drives().back().values;
  const firmware::FootPointMotion motion = firmware::through_samples(drive, truth.sample_rate);
  RunOptions options;
  options.seed = seed;
  Run run = run_closed_loop(truth, motion, options);
  if (run.recording.size() < 2) {
    throw firmware::InputError(
        truth.source, 0,
        "the simulated rig stopped the run before its first sample: " + std::string(firmware::name(run.trip.reason)),
        "a rig that can run the drive");
  }
  run.recording.comments.push_back("run of " + replication.drives().back().file + ", simulated");
  run.recording.source = truth.source;
  return std::move(run.recording);
}

void go_on(const ReplicateOptions& options) {
  if (options.measured.empty() == options.simulated.empty()) {
    throw firmware::UsageError("replicate DIR: expected --measured RUN.csv or --simulated TRUTH.toml");
  }
  if (!options.rig.empty() || !options.target.empty() || !options.channels.empty() || !options.bands.empty() ||
      !options.data.empty() || !options.out.empty()) {
    throw firmware::UsageError(
        "replicate DIR: rig, target, channels and bands are those of the folder, expected none of them again");
  }
  Replication replication = read_folder(options.folder);
  const fs::path& folder = options.folder;
  if (replication.runs().size() == replication.drives().size()) {
    throw firmware::UsageError("replicate " + folder.string() + ": every drive was run, " +
                               replicate::stop_sentence(replication));
  }
  if (!options.measured.empty()) {
    const firmware::Recording run = read_run_file(options.measured, replication.description());
    replication.take(run);
    firmware::Recording kept = run;
    kept.extra.clear();
    write_recording(folder / numbered("run_", replication.runs().size()), kept);
    (void)correct(replication, options.diagnose, folder);
  } else {
    const firmware::RigDescription truth = replicate::driven_part(firmware::read_rig(options.simulated));
    if (truth.rig.kind != replication.description().rig.kind ||
        truth.sample_rate != replication.description().sample_rate) {
      throw firmware::InputError(options.simulated.string(), 0, "is a rig of another kind or rate",
                                 "one like that of the folder");
    }
    for (int i = 0; i < options.runs; ++i) {
      firmware::Recording run = simulate_run(replication, truth, options.seed + replication.runs().size());
      replication.take(run);
      write_recording(folder / numbered("run_", replication.runs().size()), run);
      const bool last = i + 1 == options.runs;
      if (last || !correct(replication, options.diagnose, folder)) break;
    }
  }
  const auto result = replicate::to_json(replication);
  write_results(replication, folder, result);
  for (const fs::path& file : options.more)
    write_recording(file, replicate::drive_recording(replication, replication.drives().size() - 1));
  if (write_json(options.json, result)) return;
  std::printf("%s%s: %s, report.html, replicate.json\n", replicate::summary(replication).c_str(), folder.c_str(),
              replication.drives().back().file.c_str());
}

void run(const ReplicateOptions& options) {
  for (const fs::path& file : options.more) refuse_unknown_ending(file);
  if (options.folder.empty()) {
    begin(options);
  } else {
    go_on(options);
  }
}

}  // namespace

void add_replicate(CLI::App& app, ReplicateOptions& options) {
  CLI::App* command = app.add_subcommand("replicate", "The drive that makes the rig do what a recording shows");
  command->add_option("folder", options.folder, "Folder of a replication, to go on with it");
  command->add_option("--rig", options.rig, "Rig description (TOML) with the effects of its machine");
  command->add_option("--target", options.target,
                      "Recording that the rig shall repeat; several follow each other with a blend");
  command->add_option("--channels", options.channels,
                      "Channels of the target: zdd_w,dz_b:0.5 with weights after a colon (1)");
  command->add_option("--band", options.bands,
                      "Band [Hz], 0.7:40, or of one channel, dz_b=1:20 (default: where the target is above its noise)");
  command->add_option("--data", options.data,
                      "An earlier run of the rig with its commanded column: the tolerated parameters are fitted to it "
                      "before the first drive");
  command->add_option("--out", options.out, "Folder for drive_1.csv, report.html, replicate.json");
  command->add_option("--goal", options.goal, "Error that is small enough, ÷ rms of the target")
      ->check(number_within(1e-6, 1.0))
      ->capture_default_str();
  command->add_option("--measured", options.measured,
                      "What the rig answered to the newest drive, with the commanded column");
  command->add_flag("--diagnose", options.diagnose, "Diagnose the run and refine the model before the next drive");
  command->add_option("--simulated", options.simulated, "Rig description to simulate in place of the rig");
  command->add_option("--runs", options.runs, "With --simulated: how many runs at most")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--seed", options.seed, "With --simulated: of the sensors' noise")
      ->check(whole_64_bit_number())
      ->capture_default_str();
  command->add_option("--drive", options.more,
                      "Write the newest drive to this file too; the ending decides, as of --out of simulate");
  add_json_option(*command, options.json, "the result");
  command->callback([&options] { run(options); });
}

}  // namespace host_sim
