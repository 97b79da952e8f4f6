#include "host_sim/plan/plan_json.hpp"

#include <cmath>
#include <string>

namespace host_sim::plan {
namespace {

using nlohmann::ordered_json;

/// Four digits are all that a plan is worth.
double rounded(double value) {
  if (!std::isfinite(value) || value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 3.0);
  const double result = std::round(value / unit) * unit;
  return std::isfinite(result) ? result : value;
}

/// Of a parameter: four digits of the difference to its value without effect.
double rounded_value(const PlannedEffect& effect, double value) {
  const model::EffectParameter& card = effect.subject.entry->parameters[effect.parameter];
  return card.neutral + rounded(value - card.neutral);
}

ordered_json effect_json(const PlannedEffect& effect) {
  ordered_json json{{"name", effect.subject.entry->name}};
  if (effect.subject.channel) json["channel"] = model::name(*effect.subject.channel);
  if (!effect.subject.values.empty()) {
    json["parameter"] = effect.subject.entry->parameters[effect.parameter].name;
    json["unit"] = unit_of(effect.subject, effect.parameter);
    json["default"] = rounded_value(effect, effect.at_default.value);
  }
  if (effect.shows_at) json["shows_at"] = rounded_value(effect, *effect.shows_at);
  if (effect.named_at) json["named_at"] = rounded_value(effect, *effect.named_at);
  json["sigma_at_default"] = rounded(effect.at_default.significance);
  if (!effect.why.empty()) json["why"] = effect.why;
  json["taken_for"] = ordered_json::array();
  for (const TakenFor& other : effect.taken_for) {
    json["taken_for"].push_back({{"name", other.name}, {"left_sigma", rounded(other.left)}});
  }
  return json;
}

}  // namespace

ordered_json to_json(const Plan& plan) {
  ordered_json json;
  json["duration"] = plan.duration;
  json["channels"] = ordered_json::array();
  for (const model::Channel channel : plan.channels) json["channels"].push_back(model::name(channel));
  json["effects"] = ordered_json::array();
  for (const PlannedEffect& effect : plan.effects) json["effects"].push_back(effect_json(effect));
  json["parameters"] = ordered_json::array();
  for (const PlannedParameter& p : plan.parameters) {
    json["parameters"].push_back({{"path", p.path},
                                  {"described", p.described},
                                  {"determined_to", rounded(p.determined_to)},
                                  {"beside_tolerances", rounded(p.beside_tolerances)},
                                  {"tolerance", p.tolerance}});
    if (!p.why.empty()) json["parameters"].back()["why"] = p.why;
  }
  json["undetermined"] = ordered_json::array();
  for (const OpenCombination& open : plan.open) {
    json["undetermined"].push_back({{"combination", open.combination}, {"why", open.why}});
  }
  json["advice"] = ordered_json::array();
  for (const Advice& advice : plan.advice) {
    ordered_json one{{"what", advice.what}, {"gain", rounded(advice.gain)}};
    if (!advice.helps.empty()) {
      one["helps_most"] = advice.helps;
      one["its_gain"] = rounded(advice.most);
    }
    if (!advice.determines.empty()) one["determines"] = advice.determines;
    json["advice"].push_back(std::move(one));
  }
  json["remarks"] = plan.remarks;
  return json;
}

}  // namespace host_sim::plan
