#include "host_sim/diagnose/verdict_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace host_sim::diagnose {
namespace {

using nlohmann::ordered_json;

void put_channel(ordered_json& json, const PlacedEffect& effect) {
  if (effect.channel) json["channel"] = model::name(*effect.channel);
}

ordered_json to_json(const Interval& interval) {
  return {{"value", interval.value}, {"ci95", {interval.lower, interval.upper}}};
}

ordered_json to_json(const NamedEffect& named) {
  ordered_json json{{"name", named.effect.entry->name}};
  put_channel(json, named.effect);
  json["parameters"] = ordered_json::object();
  for (std::size_t p = 0; p < named.parameters.size(); ++p) {
    json["parameters"][named.effect.entry->parameters[p].name] = to_json(named.parameters[p]);
  }
  json["confidence"] = named.confidence;
  json["alternatives"] = ordered_json::array();
  for (const Alternative& alternative : named.alternatives) {
    ordered_json other{{"name", alternative.effect.entry->name}};
    put_channel(other, alternative.effect);
    other["odds_against"] = alternative.odds_against;
    if (!alternative.separate_by.empty()) other["separate_by"] = alternative.separate_by;
    json["alternatives"].push_back(std::move(other));
  }
  return json;
}

}  // namespace

ordered_json to_json(const Diagnosis& diagnosis) {
  ordered_json json{{"verdict", name(diagnosis.verdict)}};
  json["where"] = ordered_json::array();
  for (const Place& place : diagnosis.where) {
    json["where"].push_back({{"channel", model::name(place.channel)},
                             {"band_hz", {place.lowest, place.highest}},
                             {"subsystem", place.subsystem},
                             {"share", place.share}});
  }
  json["relations"] = ordered_json::array();
  for (const Residue& r : diagnosis.relations) {
    json["relations"].push_back({{"relation", r.relation}, {"holds", !r.loud()}, {"power_over_noise", r.ratio}});
    if (!r.loud()) continue;
    json["relations"].back()["band_hz"] = {r.lowest, r.highest};
    if (!r.looks.empty()) json["relations"].back()["looks"] = r.looks;
  }
  json["effects"] = ordered_json::array();
  for (const NamedEffect& effect : diagnosis.effects) json["effects"].push_back(to_json(effect));
  json["gap"] = ordered_json::object();
  for (const auto& [channel, gap] : diagnosis.gap) {
    json["gap"][model::name(channel)] = {
        {"before", gap.before}, {"refit", gap.refit}, {"after", gap.after}, {"noise_floor", gap.noise_floor}};
  }
  json["parameters"] = ordered_json::object();
  for (const auto& [path, value] : diagnosis.parameters) json["parameters"][path] = to_json(value);
  json["unexplained"] = diagnosis.unexplained;
  if (!diagnosis.rest.empty()) json["rest"] = diagnosis.rest;
  json["residual_power"] = {{"given", diagnosis.chi_squared_before},
                            {"refit", diagnosis.chi_squared_refit},
                            {"after", diagnosis.chi_squared_after}};
  json["effort"] = {{"candidates", diagnosis.candidates}, {"simulations", diagnosis.simulations}};
  json["remarks"] = diagnosis.remarks;
  return json;
}

}  // namespace host_sim::diagnose
