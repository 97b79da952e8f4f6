#include "host_sim/commands/diagnose_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/spelling.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/commands/common/emphasis.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/commands/diagnose_campaign.hpp"
#include "host_sim/commands/diagnose_live.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/identification/report/confidence_text.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/law_figure.hpp"
#include "host_sim/identification/report/shape_words.hpp"
#include "host_sim/identification/report/verdict_json.hpp"
#include "host_sim/recording_files/recording_files.hpp"

namespace host_sim {
namespace {

namespace fs = std::filesystem;

/// Creates the folder if necessary. OutputError if it holds a rig.toml that rigtwin diagnose did not write: that may be
/// the user's own description.
void prepare_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) {
    throw firmware::OutputError(folder.string(), "is not a folder", "a folder, or the name of a new one");
  }
  fs::create_directories(folder, error);
  if (error)
    throw firmware::OutputError(folder.string(), "cannot be created: " + error.message(),
                                "a folder that may be written");
  const fs::path rig = folder / "rig.toml";
  if (!fs::exists(rig, error)) return;
  std::ifstream file(rig);
  std::string first;
  std::getline(file, first);
  if (!first.starts_with(identification::result_rig_mark)) {
    throw firmware::OutputError(rig.string(), "is there already and was not written by rigtwin diagnose",
                                "another folder for the results");
  }
}

/// The two nearest.
void print_rivals(const std::vector<identification::Alternative>& alternatives) {
  for (std::size_t a = 0; a < std::min<std::size_t>(2, alternatives.size()); ++a) {
    const identification::Alternative& other = alternatives[a];
    std::printf("    rather than %s: odds %s%s%s\n", identification::words(other).c_str(),
                identification::odds_text(other.odds_against).c_str(),
                other.separate_by.empty() ? "" : "; to be separated by ", other.separate_by.c_str());
  }
}

void print(const identification::Diagnosis& diagnosis, const fs::path& folder) {
  std::printf("%s\n", emphasised(identification::sentence(diagnosis), Emphasis::bold, stdout).c_str());
  for (const std::string& objection : diagnosis.certificates) std::printf("calibration: %s\n", objection.c_str());
  for (const identification::NamedEffect& named : diagnosis.effects) {
    std::printf("  %s", identification::words(named.effect).c_str());
    for (std::size_t p = 0; p < named.parameters.size(); ++p) {
      const auto& card = named.effect.entry->parameters[p];
      std::printf("   %s = %.5g %s (%.5g … %.5g)", std::string(card.name).c_str(), named.parameters[p].value,
                  identification::unit_of(named.effect, p).c_str(), named.parameters[p].lower,
                  named.parameters[p].upper);
    }
    std::printf("   confidence %s%s\n", identification::confidence_text(named.confidence).c_str(),
                named.is_by_chance() ? "; any cause could explain as much beside what is left" : "");
    const std::string shape = identification::shape_words(named.effect, diagnosis.rig.rig);
    if (!shape.empty()) std::printf("    %s\n", shape.c_str());
    for (std::size_t p = 0; p < named.budgets.size(); ++p) {
      const std::string largest = identification::largest_part(named.budgets[p]);
      if (largest.empty()) continue;
      std::printf("    uncertainty of %s: %s\n", std::string(named.effect.entry->parameters[p].name).c_str(),
                  largest.c_str());
    }
    print_rivals(named.alternatives);
  }
  for (const identification::DescribedLaw& law : diagnosis.laws) {
    std::printf("  law at the %s   confidence %s\n", identification::words(law).c_str(),
                identification::confidence_text(law.confidence).c_str());
    for (const identification::LawNumber& number : law.numbers) {
      if (!std::isfinite(number.value) || !std::isfinite(number.lower) || !std::isfinite(number.upper)) continue;
      const std::string unit = identification::unit_of(law, number);
      std::printf("    %s = %.5g%s%s (%.5g … %.5g)\n", number.name.c_str(), number.value, unit == "1" ? "" : " ",
                  unit == "1" ? "" : unit.c_str(), number.lower, number.upper);
    }
  }
  for (const identification::ParameterOff& off : diagnosis.parameters_off) {
    std::printf("  %s is %.6g (%.6g … %.6g), described as %.6g", off.path.c_str(), off.value.value, off.value.lower,
                off.value.upper, off.described);
    if (off.tolerance > 0.0) std::printf(" ± %.3g %%", 100.0 * off.tolerance);
    std::printf("%s   confidence %s\n", off.tolerance > 0.0 ? "" : " without a tolerance",
                identification::confidence_text(off.confidence).c_str());
    print_rivals(off.alternatives);
  }
  for (const identification::RecordingFault& fault : diagnosis.recording_faults) {
    std::printf("  %s\n", identification::words(fault).c_str());
  }
  if (!diagnosis.parameters.empty()) std::printf("fitted parameters, 95 %% interval\n");
  for (const auto& [path, fitted] : diagnosis.parameters) {
    const auto budget = diagnosis.budgets.find(path);
    const std::string largest =
        budget == diagnosis.budgets.end() ? std::string() : identification::largest_part(budget->second);
    std::printf("  %-28s %12.6g (%.6g … %.6g), ±%.2g %%%s%s\n", path.c_str(), fitted.value, fitted.lower, fitted.upper,
                50.0 * (fitted.upper - fitted.lower) / std::abs(fitted.value), largest.empty() ? "" : ", ",
                largest.c_str());
  }
  for (const identification::Undetermined& open : diagnosis.undetermined) {
    std::printf("not determined: %s; %s\n", open.combination.c_str(), open.why.c_str());
  }
  if (!diagnosis.locations.empty()) std::printf("location of the disagreement\n");
  for (const identification::RecordingLocation& place : diagnosis.locations) {
    std::printf("  %-6s %5.3g … %-5.3g Hz  %5.1f %%  %s\n", std::string(model::name(place.channel)).c_str(),
                place.lowest, place.highest, 100.0 * place.share, place.subsystem.c_str());
  }
  if (!diagnosis.prediction_errors.empty()) {
    std::printf("error ÷ rms on held-out data\n  %-8s %10s %10s %10s %12s%s\n", "channel", "before", "refit", "after",
                "noise floor", diagnosis.prediction_errors.begin()->second.catalogue ? "  catalogue alone" : "");
  }
  for (const auto& [channel, gap] : diagnosis.prediction_errors) {
    std::printf("  %-8s %10.5f %10.5f %10.5f %12.5f", std::string(model::name(channel)).c_str(), gap.before, gap.refit,
                gap.after, gap.noise_floor);
    if (gap.catalogue) std::printf(" %16.5f", *gap.catalogue);
    std::printf("\n");
  }
  for (const std::string& remark : diagnosis.remarks) std::printf("%s\n", remark.c_str());
  std::printf("%s: verdict.json, report.html, rig.toml\n", folder.string().c_str());
}

void add_records(std::vector<firmware::Recording>& parts, identification::Use use,
                 std::vector<identification::Record>& records) {
  for (firmware::Recording& part : parts) records.push_back({std::move(part), use});
}

/// Of a long recording only what is used.
void read_records(const fs::path& file, identification::Use use, const firmware::RigDescription& description,
                  std::vector<identification::Record>& records) {
  const identification::UsedSeconds used = identification::used_of_long(use);
  constexpr double to_know_the_length = 10.0;  // [s] of its end
  auto ends = read_parts_of_ends(file, description.channels, description.sample_rate, used.first,
                                 std::max(used.last, to_know_the_length));
  if (!ends) {
    auto parts = read_parts(file, description.channels, description.sample_rate, description.rig.kind);
    return add_records(parts, use, records);
  }
  std::string& remark = ends->first.front().remark;
  remark += (remark.empty() ? firmware::one_line(file.string()) + ": " : "; ") +
            identification::shortened(ends->seconds, use) + ", and nothing else is read";
  add_records(ends->first, use == identification::Use::shared ? identification::Use::fitted : use, records);
  if (used.last > 0.0) add_records(ends->last, identification::Use::held_out, records);
}

/// UsageError unless a law of that name can be written beside those of the description.
void check_name(const std::string& name, const firmware::RigDescription& description) {
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!plain) {
    throw firmware::UsageError("--keep-law: " + firmware::in_quotes(name) +
                               " is no name of a table (letters, digits, _ and - are)");
  }
  for (const firmware::LawDescription& law : description.laws) {
    if (law.name != name) continue;
    throw firmware::UsageError("--keep-law: the rig description has a law " + firmware::in_quotes(name) + " already");
  }
}

/// The learned laws under a name of the user's: NAME, NAME_2 …
void keep_laws(const std::string& name, identification::Diagnosis& diagnosis) {
  if (name.empty()) return;
  for (std::size_t i = 0; i < diagnosis.laws.size(); ++i) {
    firmware::LawDescription law;
    law.name = i == 0 ? name : name + "_" + std::to_string(i + 1);
    const identification::PlacedLaw& learned = diagnosis.laws[i].law;
    if (identification::has_memory(learned.family)) {
      law.first_branch = learned.slot;
      law.branches = diagnosis.rig.rig.laws.branch_count - learned.slot;
    } else if (identification::is_surface(learned.family)) {
      law.surface = learned.slot;
    } else {
      law.curve = learned.slot;
    }
    law.feeds_energy = !identification::has_memory(
        diagnosis.laws[i].law.family);  // it stands beside damping of the rig, of which it may take away
    diagnosis.rig.laws.push_back(std::move(law));
  }
  if (diagnosis.laws.empty()) diagnosis.remarks.push_back("no law was learned: nothing is kept as " + name);
}

/// The card of an effect.
nlohmann::ordered_json card_json(const firmware::CatalogueEntry& entry) {
  nlohmann::ordered_json json{{"schema", "rigtwin/effect_card/1"},
                              {"name", entry.name},
                              {"subsystem", model::name(entry.subsystem)},
                              {"equation", entry.equation},
                              {"shows", entry.shows},
                              {"parameters", nlohmann::ordered_json::array()},
                              {"rigs", nlohmann::ordered_json::array()},
                              {"needs_fdva", entry.needs_fdva},
                              {"needs_air_spring", entry.needs_air_spring}};
  for (const model::EffectParameter& p : entry.parameters) {
    json["parameters"].push_back({{"name", p.name}, {"unit", p.unit}, {"lower", p.lower}, {"upper", p.upper}});
  }
  for (std::size_t kind = 0; kind < model::rig_kind_names.size(); ++kind) {
    if (entry.rigs.contains(static_cast<model::RigKind>(kind))) json["rigs"].push_back(model::rig_kind_names[kind]);
  }
  return json;
}

}  // namespace

firmware::CalendarDate day_recorded(const DiagnoseOptions& options) {
  if (options.recorded.empty()) return firmware::today();
  const std::optional<firmware::CalendarDate> day = firmware::find_date(options.recorded);
  if (day) return *day;
  throw firmware::UsageError("--recorded: " + firmware::in_quotes(options.recorded) + " is no day such as 2026-03-01");
}

void run_diagnosis(const DiagnoseOptions& options) {
  if (!options.explain.empty()) {
    const firmware::CatalogueEntry* const entry = firmware::find_effect(options.explain);
    if (entry == nullptr) {
      std::vector<std::string_view> names;
      for (const firmware::CatalogueEntry& e : firmware::catalogue()) names.push_back(e.name);
      throw firmware::UsageError("--explain: unknown effect " + firmware::in_quotes(options.explain) +
                                 " (did you mean " + firmware::in_quotes(firmware::nearest(options.explain, names)) +
                                 "?)");
    }
    if (!write_json(options.json, options.json.empty() ? nlohmann::ordered_json() : card_json(*entry))) {
      std::printf("%s", identification::explanation(*entry).c_str());
    }
    return;
  }
  if (!options.live.empty()) return diagnose_live(options);
  if (!options.socket.empty()) throw firmware::UsageError("diagnose: --socket belongs to --live");
  if (!options.campaign.empty()) return run_campaign(options);
  if (!options.shard.empty() || !options.against.empty()) {
    throw firmware::UsageError("diagnose: --shard and --against belong to --campaign");
  }
  if (options.rig.empty() || options.data.empty() || options.out.empty()) {
    throw firmware::UsageError(
        "diagnose: --rig, --data and --out are needed, or --campaign, or --rig and --live, or --explain EFFECT");
  }
  const firmware::CalendarDate recorded = day_recorded(options);
  const firmware::RigDescription description = firmware::read_rig(options.rig);
  firmware::refuse_compensation(description, "diagnose");
  check_name(options.keep_law, description);
  std::vector<identification::Record> records;
  const identification::Use use = options.holdout.empty() ? identification::Use::shared : identification::Use::fitted;
  for (const fs::path& file : options.data) read_records(file, use, description, records);
  for (const fs::path& file : options.holdout) {
    read_records(file, identification::Use::held_out, description, records);
  }
  prepare_folder(options.out);
  HowMade how_made;
  std::optional<Progress> progress(std::in_place, "diagnose");
  identification::Diagnosis diagnosis = identification::diagnose(
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
  diagnosis.certificates = firmware::certificate_objections(description.calibration, recorded);
  keep_laws(options.keep_law, diagnosis);

  // All three files or none: each is written under a temporary name first.
  firmware::OutputFile verdict(options.out / "verdict.json"), report(options.out / "report.html"),
      rig(options.out / "rig.toml");
  verdict.write(how_made.json(identification::to_json(diagnosis)));
  report.write(how_made.in(identification::report_html(diagnosis, description)));
  rig.write(identification::result_rig(diagnosis.rig, description, options.rig.filename().string()));
  verdict.commit();
  report.commit();
  rig.commit();
  if (write_json(options.json, identification::to_json(diagnosis))) return;
  print(diagnosis, options.out);
}

void add_diagnose(CLI::App& app, DiagnoseOptions& options) {
  CLI::App* command =
      app.add_subcommand("diagnose", "Locate the disagreement of rig and model and name the missing effect");
  command->add_option("--rig", options.rig, "Rig description (TOML)");
  command->add_option("--data", options.data, "Recording (CSV or .mat); may be given several times");
  command->add_option("--holdout", options.holdout,
                      "Recording for validation, not used for fitting (default: the last quarter of each --data)");
  command->add_option("--out", options.out, "Folder for verdict.json, report.html, rig.toml");
  add_json_option(*command, options.json, "the verdict, what --live has named, or the card of --explain,");
  command->add_option("--keep-law", options.keep_law, "Name of a learned law in rig.toml, as [laws.NAME]");
  command->add_option("--recorded", options.recorded,
                      "Day on which the recordings were made, YYYY-MM-DD (default: today): calibration certificates "
                      "are held against it");
  command->add_option("--campaign", options.campaign,
                      "Many recordings, each alone: a folder, or a list of [[record]] (TOML) with data and rig. --out "
                      "then gets a folder for "
                      "each, campaign.csv, campaign.json and report.html; what is there already is not done again");
  command->add_option("--shard", options.shard, "Of a campaign: i/n, the share of this process");
  command->add_option("--against", options.against, "Of a campaign: the results of an earlier one, to stand beside");
  command
      ->add_option("--live", options.live,
                   "Name what begins to be wrong while the rig runs: HOST:PORT where the datagrams of rig_controller "
                   "--publish come in, or a recording, played from its beginning (localhost:9870)")
      ->expected(0, 1)
      ->default_str("localhost:9870");
  command->add_option(
      "--socket", options.socket,
      "Of the controller, for the stop that [controller] model_watch asks for (/run/rigtwin/control.sock)");
  command->add_option("--explain", options.explain, "Explain an effect of the catalogue");
  command->callback([&options] { run_diagnosis(options); });
}

}  // namespace host_sim
