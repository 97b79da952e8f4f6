#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "host_sim/command_line.hpp"
#include "host_sim/comparison.hpp"
#include "host_sim/output_file.hpp"
#include "host_sim/progress.hpp"

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

/// All recordings as one: powers are averaged with the recordings' lengths as weights.
std::vector<ChannelComparison> pooled(const std::vector<RecordingComparison>& recordings) {
  if (recordings.size() == 1) return recordings.front().channels;
  std::vector<ChannelComparison> result;
  std::vector<double> lengths;
  for (const RecordingComparison& recording : recordings) {
    for (const ChannelComparison& c : recording.channels) {
      auto at = std::find_if(result.begin(), result.end(), [&](const auto& r) { return r.channel == c.channel; });
      if (at == result.end()) {
        result.push_back({c.channel, 0.0, 0.0, 0.0, 0, {}});
        lengths.push_back(0.0);
        at = result.end() - 1;
      }
      lengths[static_cast<std::size_t>(at - result.begin())] += recording.duration;
      at->error_rms += recording.duration * c.error_rms * c.error_rms;
      at->data_rms += recording.duration * c.data_rms * c.data_rms;
      at->clipped += c.clipped;
    }
  }
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].error_rms = std::sqrt(result[i].error_rms / lengths[i]);
    result[i].data_rms = std::sqrt(result[i].data_rms / lengths[i]);
    result[i].nrmse = result[i].error_rms / result[i].data_rms;
  }
  return result;
}

/// The band in which most of a channel's error lies.
const BandError* worst_band(const ChannelComparison& channel) {
  const auto worst = std::max_element(channel.bands.begin(), channel.bands.end(),
                                      [](const auto& a, const auto& b) { return a.error_rms < b.error_rms; });
  return worst == channel.bands.end() ? nullptr : &*worst;
}

void print(const RecordingComparison& recording) {
  std::printf("%s: %.4g s, driven by %s, started %s\n", recording.source.c_str(), recording.duration,
              std::string(model::name(recording.input)).c_str(),
              recording.started_at_rest ? "at rest" : "in mid-motion (state estimated)");
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

}  // namespace

void compare(const CompareOptions& options) {
  const RigDescription description = read_rig(options.rig);
  std::vector<ComparedRecording> recordings;
  for (const auto& file : options.data) {
    recordings.emplace_back(description, read_recording(file, description.channels, description.sample_rate),
                            options.start);
  }

  model::RigParameters<double> rig = description.rig;
  ordered_json parameters = ordered_json::object();
  std::string story;
  if (options.refit) {
    Progress progress("refit");
    progress.show(0.0);
    const Refit fitted = refit(description, recordings);
    rig = fitted.rig;
    char line[160];
    std::snprintf(line, sizeof line, "refit: normalised error over all channels %.4f -> %.4f\n", fitted.pooled_before,
                  fitted.pooled_after);
    story = line;
    for (const auto& [path, value] : fitted.parameters) {
      auto original = description.rig;
      parameters[path] = value;
      const bool bound = std::find(fitted.at_bound.begin(), fitted.at_bound.end(), path) != fitted.at_bound.end();
      std::snprintf(line, sizeof line, "  %-24s %12.6g -> %12.6g%s\n", path.c_str(), *find_parameter(original, path),
                    value, bound ? "   (at its bound)" : "");
      story += line;
    }
  }

  std::vector<RecordingComparison> results;
  for (const ComparedRecording& recording : recordings) results.push_back(recording.compare(recording.simulate(rig)));

  if (options.json) {
    for (const auto& [path, tolerance] : description.tolerance) {
      if (!parameters.contains(path)) parameters[path] = *find_parameter(rig, path);
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
                                    {"channels", channels_json(r.channels)}});
    }
    const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (*options.json == "-") {
      std::fputs(text.c_str(), stdout);
      return;
    }
    write_file(*options.json, text);
  }
  std::fputs(story.c_str(), stdout);
  for (const RecordingComparison& result : results) print(result);
}

}  // namespace host_sim
