#include "host_sim/diagnose_command.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "host_sim/diagnose/diagnosis.hpp"
#include "host_sim/diagnose/result_rig.hpp"
#include "host_sim/diagnose/story.hpp"
#include "host_sim/diagnose/verdict_json.hpp"
#include "host_sim/input_error.hpp"
#include "host_sim/output_file.hpp"
#include "host_sim/progress.hpp"
#include "host_sim/recording.hpp"
#include "host_sim/recording_columns.hpp"
#include "host_sim/spelling.hpp"

namespace host_sim {
namespace {

namespace fs = std::filesystem;

/// The folder, made if need be. A rig.toml in it that is not ours – the description itself, perhaps – is not
/// overwritten.
void prepare_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw OutputError(folder.string(), "is no folder", "a folder, or a name for a new one");
  }
  fs::create_directories(folder, error);
  if (error)
    throw OutputError(folder.string(), "cannot be created: " + error.message(), "a folder that may be written");
  const fs::path rig = folder / "rig.toml";
  if (!fs::exists(rig, error)) return;
  std::ifstream file(rig);
  std::string first;
  std::getline(file, first);
  if (!first.starts_with(diagnose::result_rig_mark)) {
    throw OutputError(rig.string(), "is there already and was not written by rigtwin diagnose",
                      "a folder of its own for the results");
  }
}

void print(const diagnose::Diagnosis& diagnosis, const fs::path& folder) {
  std::printf("%s\n", diagnose::sentence(diagnosis).c_str());
  for (const diagnose::NamedEffect& named : diagnosis.effects) {
    std::printf("  %s", diagnose::words(named.effect).c_str());
    for (std::size_t p = 0; p < named.parameters.size(); ++p) {
      const auto& card = named.effect.entry->parameters[p];
      std::printf("   %s = %.5g %s (%.5g … %.5g)", std::string(card.name).c_str(), named.parameters[p].value,
                  diagnose::unit_of(named.effect, p).c_str(), named.parameters[p].lower, named.parameters[p].upper);
    }
    std::printf("   confidence %.3f\n", named.confidence);
    for (std::size_t a = 0; a < std::min<std::size_t>(2, named.alternatives.size()); ++a) {
      const auto& other = named.alternatives[a];
      std::printf("    rather than %s: odds %s%s%s\n", diagnose::words(other.effect).c_str(),
                  diagnose::odds_text(other.odds_against).c_str(), other.separate_by.empty() ? "" : "; told apart by ",
                  other.separate_by.c_str());
    }
  }
  if (!diagnosis.where.empty()) std::printf("where the disagreement lies\n");
  for (const diagnose::Place& place : diagnosis.where) {
    std::printf("  %-6s %5.3g … %-5.3g Hz  %5.1f %%  %s\n", std::string(model::name(place.channel)).c_str(),
                place.lowest, place.highest, 100.0 * place.share, place.subsystem.c_str());
  }
  if (!diagnosis.gap.empty()) {
    std::printf("error ÷ rms on data held out\n  %-8s %10s %10s %10s %12s\n", "channel", "before", "refit", "after",
                "noise floor");
  }
  for (const auto& [channel, gap] : diagnosis.gap) {
    std::printf("  %-8s %10.5f %10.5f %10.5f %12.5f\n", std::string(model::name(channel)).c_str(), gap.before,
                gap.refit, gap.after, gap.noise_floor);
  }
  for (const std::string& remark : diagnosis.remarks) std::printf("%s\n", remark.c_str());
  std::printf("%s: verdict.json, report.html, rig.toml\n", folder.string().c_str());
}

}  // namespace

void run_diagnosis(const DiagnoseOptions& options) {
  if (!options.explain.empty()) {
    const CatalogueEntry* const entry = find_effect(options.explain);
    if (entry == nullptr) {
      std::vector<std::string_view> names;
      for (const CatalogueEntry& e : catalogue()) names.push_back(e.name);
      throw UsageError("--explain: unknown effect " + in_quotes(options.explain) + " (did you mean " +
                       in_quotes(nearest(options.explain, names)) + "?)");
    }
    std::printf("%s", diagnose::explanation(*entry).c_str());
    return;
  }
  if (options.rig.empty() || options.data.empty() || options.out.empty()) {
    throw UsageError("diagnose: --rig, --data and --out are needed, or --explain EFFECT");
  }
  const RigDescription description = read_rig(options.rig);
  std::vector<diagnose::Record> records;
  const diagnose::Use use = options.holdout.empty() ? diagnose::Use::shared : diagnose::Use::fitted;
  for (const fs::path& file : options.data) {
    records.push_back({read_recording(file, description.channels, description.sample_rate), use});
  }
  for (const fs::path& file : options.holdout) {
    records.push_back({read_recording(file, description.channels, description.sample_rate), diagnose::Use::held_out});
  }
  prepare_folder(options.out);
  std::optional<Progress> progress(std::in_place, "diagnose");
  const diagnose::Diagnosis diagnosis = diagnose::diagnose(
      description, std::move(records),
      [&, begun = std::chrono::steady_clock::now()](double share, const std::string& what, std::size_t simulations,
                                                    std::size_t candidates) {
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
        const double rate = static_cast<double>(simulations) / std::max(taken.count(), 1e-3);
        char tried[96];
        std::snprintf(tried, sizeof tried, " (%zu candidates, %zu simulations, %.0f/s)", candidates, simulations, rate);
        progress->show(share, what + tried);
      });
  progress.reset();

  // All three or none: written beside their names first.
  OutputFile verdict(options.out / "verdict.json"), report(options.out / "report.html"), rig(options.out / "rig.toml");
  verdict.write(diagnose::to_json(diagnosis).dump(2) + "\n");
  report.write(diagnose::report_html(diagnosis, description));
  rig.write(diagnose::result_rig(diagnosis.rig, options.rig.filename().string()));
  verdict.commit();
  report.commit();
  rig.commit();
  print(diagnosis, options.out);
}

void add_diagnose(CLI::App& app, DiagnoseOptions& options) {
  CLI::App* command = app.add_subcommand("diagnose", "Where rig and model disagree, and which effect is missing");
  command->add_option("--rig", options.rig, "Rig description (TOML)");
  command->add_option("--data", options.data, "Recording (CSV or .mat); may be given several times");
  command->add_option("--holdout", options.holdout,
                      "Recording to judge by, not used for fitting (default: the last quarter of each --data)");
  command->add_option("--out", options.out, "Folder for verdict.json, report.html, rig.toml");
  command->add_option("--explain", options.explain, "Say what an effect of the catalogue is and how it shows");
  command->callback([&options] { run_diagnosis(options); });
}

}  // namespace host_sim
