#include "host_sim/live/live_report.hpp"

#include <cmath>

namespace host_sim::live {
namespace {

using nlohmann::ordered_json;

ordered_json number(double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); }

ordered_json cause_json(const NamedCause& cause) {
  return {{"name", cause.name},
          {"channel", cause.channel.empty() ? ordered_json(nullptr) : ordered_json(cause.channel)},
          {"parameter", cause.parameter},
          {"unit", cause.unit},
          {"value", number(cause.value)},
          {"deviation", number(cause.deviation)},
          {"described", number(cause.described)},
          {"shows", cause.shows}};
}

}  // namespace

ordered_json to_json(const Finding& finding) {
  ordered_json json{{"kind", name(finding.kind)},         {"text", sentence(finding)},
                    {"cause", cause_json(finding.cause)}, {"rivals", ordered_json::array()},
                    {"since", number(finding.since)},     {"named_at", number(finding.named_at)},
                    {"motion", number(finding.motion)},   {"share", number(finding.share)}};
  for (const NamedCause& rival : finding.rivals) json["rivals"].push_back(cause_json(rival));
  return json;
}

ordered_json to_json(const Progress& progress, const std::vector<Finding>& findings, const std::string& stop) {
  ordered_json json{{"schema", "rigtwin/live/1"},        {"stage", name(progress.stage)},
                    {"lacking", progress.lacking},       {"waits_for", progress.waits_for},
                    {"candidates", progress.candidates}, {"largest", progress.largest},
                    {"level", progress.level},           {"watched", progress.watched},
                    {"passed", progress.passed},         {"stop", stop},
                    {"findings", ordered_json::array()}};
  for (const Finding& finding : findings) json["findings"].push_back(to_json(finding));
  return json;
}

}  // namespace host_sim::live
