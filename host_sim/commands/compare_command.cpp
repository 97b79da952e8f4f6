#include "host_sim/commands/compare_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/output_file.hpp"
#include "host_sim/commands/common/how_made.hpp"
#include "host_sim/commands/common/json_output.hpp"
#include "host_sim/commands/common/progress.hpp"
#include "host_sim/commands/common/recorded_as.hpp"
#include "host_sim/comparison/refit.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/show/comparison_page.hpp"

namespace host_sim {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

ordered_json channels_json(const std::vector<ChannelComparison>& channels) {
  ordered_json object = ordered_json::object();
  for (const ChannelComparison& c : channels) {
    ordered_json bands = ordered_json::array();
    for (const BandError& b : c.bands) {
      bands.push_back(
          {{"band_hz", {b.band.lower, b.band.upper}}, {"error_rms", b.error_rms}, {"data_rms", b.data_rms}});
    }
    object[std::string(model::name(c.channel))] = {{"nrmse", number(c.nrmse)},
                                                   {"error_rms", c.error_rms},
                                                   {"data_rms", c.data_rms},
                                                   {"clipped_samples", c.clipped},
                                                   {"bands", std::move(bands)}};
  }
  return object;
}

const BandError* find_band(const ChannelComparison& channel, int number) {
  const auto at = std::find_if(channel.bands.begin(), channel.bands.end(),
                               [number](const BandError& b) { return b.band.number == number; });
  return at == channel.bands.end() ? nullptr : &*at;
}

/// All recordings as one: mean powers, weighted with the recordings' lengths, in the bands that all recordings resolve.
std::vector<ChannelComparison> pooled(const std::vector<RecordingComparison>& recordings) {
  if (recordings.size() == 1) return recordings.front().channels;
  std::map<model::Channel, std::vector<const ChannelComparison*>> by_channel;
  std::map<const ChannelComparison*, double> durations;
  for (const RecordingComparison& recording : recordings) {
    for (const ChannelComparison& c : recording.channels) {
      by_channel[c.channel].push_back(&c);
      durations[&c] = recording.duration;
    }
  }
  std::vector<ChannelComparison> result;
  for (const auto& [channel, parts] : by_channel) {
    // √(Σ duration · of² / Σ duration) over the recordings that hold the channel
    const auto joined = [&durations, &list = parts](const auto& of) {
      double squares = 0.0, duration = 0.0;
      for (const ChannelComparison* part : list) {
        squares += durations[part] * of(*part) * of(*part);
        duration += durations[part];
      }
      return std::sqrt(squares / duration);
    };
    ChannelComparison all{channel, 0.0, 0.0, 0.0, 0, {}};
    all.error_rms = joined([](const ChannelComparison& c) { return c.error_rms; });
    all.data_rms = joined([](const ChannelComparison& c) { return c.data_rms; });
    all.nrmse = all.error_rms / all.data_rms;
    for (const ChannelComparison* part : parts) all.clipped += part->clipped;
    for (const BandError& shown : parts.front()->bands) {
      const int number = shown.band.number;
      if (!std::all_of(parts.begin(), parts.end(), [number](auto* c) { return find_band(*c, number) != nullptr; })) {
        continue;
      }
      all.bands.push_back({shown.band,
                           joined([number](const ChannelComparison& c) { return find_band(c, number)->error_rms; }),
                           joined([number](const ChannelComparison& c) { return find_band(c, number)->data_rms; })});
    }
    result.push_back(std::move(all));
  }
  return result;
}

/// The band with the largest error of a channel.
const BandError* worst_band(const ChannelComparison& channel) {
  const auto worst = std::max_element(channel.bands.begin(), channel.bands.end(),
                                      [](const auto& a, const auto& b) { return a.error_rms < b.error_rms; });
  return worst == channel.bands.end() ? nullptr : &*worst;
}

void print(const RecordingComparison& recording) {
  std::printf("%s: %.4g s, driven by %s, started %s\n", recording.source.c_str(), recording.duration,
              std::string(model::name(recording.input)).c_str(),
              recording.started_at_rest ? "at rest" : "in mid-motion (state estimated)");
  if (!recording.remark.empty()) std::printf("  %s\n", recording.remark.c_str());
  for (const StaticValue& value : recording.tared) std::printf("  %s\n", words(value).c_str());
  std::printf("  %-7s %9s %13s %13s %9s   %s\n", "channel", "nrmse", "rms error", "rms data", "clipped",
              "most of the error");
  for (const ChannelComparison& c : recording.channels) {
    std::printf("  %-7s %9.4f %13.5g %13.5g %9zu", std::string(model::name(c.channel)).c_str(), c.nrmse, c.error_rms,
                c.data_rms, c.clipped);
    if (const BandError* worst = worst_band(c); worst != nullptr && c.error_rms > 0.0) {
      std::printf("   %s Hz band (%.0f %%)", nominal_name(worst->band).c_str(),
                  100.0 * worst->error_rms * worst->error_rms / (c.error_rms * c.error_rms));
    }
    std::printf("\n");
  }
  std::printf("  rms error in per cent of each channel's rms, by third-octave band [Hz]\n  %8s", "");
  for (const ChannelComparison& c : recording.channels) {
    std::printf(" %9s", std::string(model::name(c.channel)).c_str());
  }
  std::printf("\n");
  const std::size_t bands = recording.channels.front().bands.size();
  for (std::size_t b = 0; b < bands; ++b) {
    const bool matters = std::any_of(recording.channels.begin(), recording.channels.end(), [b](const auto& c) {
      return c.bands[b].error_rms > 1e-3 * c.data_rms || c.bands[b].data_rms > 1e-3 * c.data_rms;
    });
    if (!matters) continue;
    std::printf("  %8s", nominal_name(recording.channels.front().bands[b].band).c_str());
    for (const ChannelComparison& c : recording.channels) {
      std::printf(" %9.2f", c.data_rms > 0.0 ? 100.0 * c.bands[b].error_rms / c.data_rms : 0.0);
    }
    std::printf("\n");
  }
}

StartChoice start_choice(const std::string& word) {
  if (word == "automatic") return StartChoice::automatic;
  if (word == "rest") return StartChoice::rest;
  if (word == "estimated") return StartChoice::estimated;
  throw firmware::UsageError("--start: is " + firmware::in_quotes(word) + ", expected automatic, rest or estimated");
}

}  // namespace

void compare(const CompareOptions& options) {
  const firmware::RigDescription description = firmware::read_rig(options.rig);
  firmware::refuse_compensation(description, "compare");
  std::vector<ComparedRecording> recordings;
  for (const auto& file : options.data) {
    for (firmware::Recording& part :
         read_parts(file, description.channels, description.sample_rate, description.rig.kind)) {
      recordings.emplace_back(description, std::move(part), options.start, recorded_as(description));
    }
  }

  model::RigParameters<double> rig = description.rig;
  ordered_json parameters = ordered_json::object();
  std::string summary;
  if (options.refit) {
    Progress progress("refit");
    progress.show(0.0);
    const Refit fitted = refit(description, recordings, [&progress](double share, double pooled_error) {
      char detail[48];
      std::snprintf(detail, sizeof detail, "normalised error %.4f", pooled_error);
      progress.show(share, detail);
    });
    rig = fitted.rig;
    char line[160];
    std::snprintf(line, sizeof line, "refit: normalised error over all channels %.4f -> %.4f\n", fitted.pooled_before,
                  fitted.pooled_after);
    summary = line;
    for (const auto& [path, value] : fitted.parameters) {
      auto original = description.rig;
      parameters[path] = value;
      const bool bound = std::find(fitted.at_bound.begin(), fitted.at_bound.end(), path) != fitted.at_bound.end();
      std::snprintf(line, sizeof line, "  %-24s %12.6g -> %12.6g%s\n", path.c_str(),
                    *firmware::find_parameter(original, path), value, bound ? "   (at its bound)" : "");
      summary += line;
    }
  }

  std::vector<RecordingComparison> results;
  results.reserve(recordings.size());
  std::vector<show::Shown> shown;
  for (const ComparedRecording& recording : recordings) {
    Response simulated = recording.simulate(rig);
    results.push_back(recording.compare(simulated));
    if (!options.report) continue;
    const std::string name = std::filesystem::path(recording.recording().source).filename().string();
    shown.push_back({name, recording.recording(), {{options.rig.filename().string(), std::move(simulated)}}});
  }
  if (options.report) {
    const std::string page = show::comparison_page(shown, results, pooled(results), options.rig.filename().string());
    firmware::write_file(*options.report, with_how_made(page));
  }

  if (options.json) {
    for (const auto& [path, tolerance] : description.tolerance) {
      if (!parameters.contains(path)) parameters[path] = *firmware::find_parameter(rig, path);
    }
    ordered_json json;
    json["channels"] = channels_json(pooled(results));
    json["parameters"] = std::move(parameters);
    json["refit"] = options.refit;
    json["recordings"] = ordered_json::array();
    for (const RecordingComparison& r : results) {
      json["recordings"].push_back({{"file", r.source},
                                    {"duration", r.duration},
                                    {"input", model::name(r.input)},
                                    {"started_at_rest", r.started_at_rest},
                                    {"missing_samples", r.missing},
                                    {"channels", channels_json(r.channels)}});
    }
    if (write_json(options.json, json)) return;
  }
  std::fputs(summary.c_str(), stdout);
  for (const RecordingComparison& result : results) print(result);
}

void add_compare(CLI::App& app, CompareOptions& options) {
  CLI::App* command = app.add_subcommand("compare", "Compare recordings with the simulation of their own input");
  command->add_option("--rig", options.rig, "Rig description (TOML)")->required();
  command->add_option("--data", options.data, "Recording (CSV or .mat); may be given several times")->required();
  command->add_option("--json", options.json, "Write the result as JSON (- for standard output)");
  command->add_option("--report", options.report, "Write the comparison as a page (HTML)");
  command->add_flag("--refit", options.refit, "First fit the parameters under [tolerance] within their bounds");
  command->add_option_function<std::string>(
      "--start", [&options](const std::string& word) { options.start = start_choice(word); },
      "State at the start of a recording: rest, estimated, or automatic (rest where it begins quietly)");
  command->callback([&options] { compare(options); });
}

}  // namespace host_sim
