#include "host_sim/identification/report/verdict_json.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "host_sim/identification/report/law_figure.hpp"
#include "host_sim/identification/report/shape_words.hpp"

namespace host_sim::identification {
namespace {

using nlohmann::ordered_json;

void put_channel(ordered_json& json, const firmware::PlacedEffect& effect) {
  if (effect.channel) json["channel"] = model::name(*effect.channel);
}

/// A number that JSON can hold: there is none of a value that is not finite.
class FiniteNumber {
 public:
  [[nodiscard]] static std::optional<FiniteNumber> of(double value) {
    if (!std::isfinite(value)) return std::nullopt;
    return FiniteNumber(value);
  }
  [[nodiscard]] double value() const { return value_; }

 private:
  explicit FiniteNumber(double value) : value_(value) {}
  double value_;
};

/// {"value": …, "ci95": […, …]}; nothing where one of the three is not finite: what the recordings leave open has no
/// number.
std::optional<ordered_json> finite_json(double value, double lower, double upper) {
  const auto v = FiniteNumber::of(value), l = FiniteNumber::of(lower), u = FiniteNumber::of(upper);
  if (!v || !l || !u) return std::nullopt;
  return ordered_json{{"value", v->value()}, {"ci95", {l->value(), u->value()}}};
}

ordered_json to_json(const Interval& interval) {
  return {{"value", interval.value}, {"ci95", {interval.lower, interval.upper}}};
}

/// {"combined": …, "coverage": …, "parts": [{"source": "calibration", "of": "F", "standard": …, "share": …}]}
ordered_json to_json(const UncertaintyBudget& budget) {
  ordered_json json{{"combined", budget.combined}, {"coverage", budget.coverage}, {"parts", ordered_json::array()}};
  for (const UncertaintyBudget::Part& part : budget.parts) {
    ordered_json one{{"source", name(part.source)}};
    if (!part.of.empty()) one["of"] = part.of;
    one["standard"] = part.standard;
    one["share"] = budget.share(part);
    json["parts"].push_back(std::move(one));
  }
  return json;
}

/// Only where the budget has a number: what the recordings leave open has none.
void put_budget(ordered_json& json, const UncertaintyBudget& budget) {
  if (budget.parts.empty() || !std::isfinite(budget.combined) || !std::isfinite(budget.coverage)) return;
  json["uncertainty_budget"] = to_json(budget);
}

ordered_json to_json(const PredictedNumber& predicted) {
  ordered_json json = to_json(predicted.interval);
  put_budget(json, predicted.budget);
  return json;
}

ordered_json to_json(const std::vector<Alternative>& alternatives) {
  ordered_json list = ordered_json::array();
  for (const Alternative& alternative : alternatives) {
    ordered_json other;
    if (const auto* const parameter = std::get_if<ParameterValue>(&alternative.cause)) {
      other = {{"name", parameter->path}, {"value", parameter->value}};
    } else {
      const auto& effect = std::get<firmware::PlacedEffect>(alternative.cause);
      other["name"] = effect.entry->name;
      put_channel(other, effect);
    }
    other["odds_against"] = alternative.odds_against;
    if (!alternative.separate_by.empty()) other["separate_by"] = alternative.separate_by;
    list.push_back(std::move(other));
  }
  return list;
}

/// When a channel disagrees: in the recording with most of it, the time that holds the middle 80 %, and the power of
/// each stretch (about a second) relative to noise.
void put_time(ordered_json& json, const std::vector<PowerOverTime>& powers, model::Channel channel) {
  const PowerOverTime* most = nullptr;
  for (const PowerOverTime& power : powers) {
    if (power.channel == channel && (most == nullptr || power.excess() > most->excess())) most = &power;
  }
  if (most == nullptr) return;  // the virtual tyre: no sensor is between the program and its recording
  const auto [from, to] = most->middle();
  json["time_s"] = {from, to};
  json["recording"] = most->recording;
  json["seconds"] = ordered_json::array();
  for (std::size_t k = 0; k < most->from.size(); ++k) json["seconds"].push_back({most->from[k], most->to[k]});
  json["power_per_second"] = most->refit;
}

ordered_json to_json(const NamedEffect& named, const model::RigParameters<double>& rig) {
  ordered_json json{{"name", named.effect.entry->name}};
  put_channel(json, named.effect);
  if (const std::string shape = shape_words(named.effect, rig); !shape.empty()) json["words"] = shape;
  json["parameters"] = ordered_json::object();
  for (std::size_t p = 0; p < named.parameters.size(); ++p) {
    ordered_json& parameter = json["parameters"][named.effect.entry->parameters[p].name] = to_json(named.parameters[p]);
    if (p < named.budgets.size()) put_budget(parameter, named.budgets[p]);
  }
  json["confidence"] = named.confidence;
  json["share"] = named.share;
  json["alternatives"] = to_json(named.alternatives);
  return json;
}

ordered_json numbers(const std::array<double, model::surface_points>& values, std::size_t count) {
  return std::vector<double>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

ordered_json to_json(const DescribedLaw& law) {
  ordered_json json{
      {"place", name(law.law.place)}, {"over", ordered_json::array()}, {"shape", law.shape}, {"words", law.words}};
  if (law.law.over == CurveOver::both) {
    json["over"] = {name(CurveOver::deflection), name(CurveOver::velocity)};
  } else {
    json["over"] = {name(law.law.over)};
  }
  json["parameters"] = ordered_json::object();
  for (const LawNumber& number : law.numbers) {
    if (auto one = finite_json(number.value, number.lower, number.upper)) {
      json["parameters"][number.name] = std::move(*one);
    }
  }
  json["memory"] = has_memory(law.law.family);
  if (has_memory(law.law.family)) {
    json["branches"] = ordered_json::array();
    for (const model::BranchNumbers<double>& branch : branches_of(law.law)) {
      ordered_json numbers{{"stiffness", branch.stiffness}};
      if (branch.slip_force > 0.0) numbers["slip_force"] = branch.slip_force;
      if (branch.time_constant > 0.0) numbers["time_constant"] = branch.time_constant;
      if (branch.gap > 0.0) numbers["gap"] = branch.gap;
      json["branches"].push_back(std::move(numbers));
    }
  }
  if (is_surface(law.law.family)) {
    const model::SurfaceTable<double> surface = surface_of(law.law);
    ordered_json rows = ordered_json::array();
    for (std::size_t i = 0; i < surface.rows; ++i) rows.push_back(numbers(surface.value[i], surface.columns));
    json["surface"] = {{"deflection", numbers(surface.deflection, surface.rows)},
                       {"velocity", numbers(surface.velocity, surface.columns)},
                       {"force", std::move(rows)}};
    json["table"] = {{"deflection", law.at}, {"at_velocity", law.law.rms_velocity}};
  } else {
    json["table"] = {{name(law.law.over), law.at}};
  }
  json["table"]["force"] = law.force;
  json["table"]["band95"] = ordered_json::array();
  for (std::size_t i = 0; i < law.at.size(); ++i) json["table"]["band95"].push_back({law.lower[i], law.upper[i]});
  json["excited"] = {law.lowest, law.highest};
  json["confidence"] = law.confidence;
  return json;
}

}  // namespace

namespace {

/// JSON has neither infinity nor NaN, and no reader could use them.
void require_finite(const ordered_json& json, const std::string& where) {
  if (json.is_structured()) {
    for (const auto& [key, item] : json.items()) {
      require_finite(item, where.empty() ? key : std::string(where).append(".").append(key));
    }
  } else if (json.is_null() || (json.is_number_float() && !std::isfinite(json.get<double>()))) {
    throw std::logic_error("verdict.json: " + where + " is not a finite number");
  }
}

}  // namespace

ordered_json to_json(const Diagnosis& diagnosis) {
  ordered_json json{{"verdict", name(diagnosis.verdict)}, {"certificates", diagnosis.certificates}};
  json["where"] = ordered_json::array();
  for (const RecordingLocation& place : diagnosis.locations) {
    json["where"].push_back({{"channel", model::name(place.channel)},
                             {"band_hz", {place.lowest, place.highest}},
                             {"subsystem", place.subsystem},
                             {"share", place.share}});
    put_time(json["where"].back(), diagnosis.power_over_time, place.channel);
  }
  json["relations"] = ordered_json::array();
  for (const ParityResidual& r : diagnosis.relations) {
    json["relations"].push_back({{"relation", r.relation}, {"holds", !r.significant()}, {"power_over_noise", r.ratio}});
    if (!r.significant()) continue;
    json["relations"].back()["band_hz"] = {r.lowest, r.highest};
    if (!r.description.empty()) json["relations"].back()["looks"] = r.description;
  }
  json["effects"] = ordered_json::array();
  for (const NamedEffect& effect : diagnosis.effects) json["effects"].push_back(to_json(effect, diagnosis.rig.rig));
  json["gap"] = ordered_json::object();
  for (const auto& [channel, gap] : diagnosis.prediction_errors) {
    json["gap"][model::name(channel)] = {
        {"before", gap.before}, {"refit", gap.refit}, {"after", gap.after}, {"noise_floor", gap.noise_floor}};
    if (gap.catalogue) json["gap"][model::name(channel)]["catalogue"] = *gap.catalogue;
  }
  json["parameters"] = ordered_json::object();
  for (const auto& [path, value] : diagnosis.parameters) {
    json["parameters"][path] = to_json(value);
    if (const auto budget = diagnosis.budgets.find(path); budget != diagnosis.budgets.end()) {
      put_budget(json["parameters"][path], budget->second);
    }
  }
  json["predictions"] = ordered_json::object();
  for (const auto& [channel, predicted] : diagnosis.predictions) {
    json["predictions"][model::name(channel)] = {{"rms", to_json(predicted.rms)}, {"peak", to_json(predicted.peak)}};
  }
  json["unexplained"] = diagnosis.unexplained;
  json["unexplained_probability"] = diagnosis.unexplained_probability;
  if (!diagnosis.residual.empty()) json["rest"] = diagnosis.residual;
  json["residual_power"] = {{"given", diagnosis.residual_power.given},
                            {"refit", diagnosis.residual_power.refit},
                            {"after", diagnosis.residual_power.after}};
  json["budget"] = {{"tried", diagnosis.candidates}, {"not_tried", diagnosis.not_tried}};
  json["effort"] = {{"candidates", diagnosis.candidates}, {"simulations", diagnosis.simulations}};
  json["remarks"] = diagnosis.remarks;
  json["parameters_off"] = ordered_json::array();
  for (const ParameterOff& off : diagnosis.parameters_off) {
    ordered_json one{{"path", off.path}, {"described", off.described}, {"tolerance", off.tolerance}};
    one.update(to_json(off.value));
    if (const auto budget = diagnosis.budgets.find(off.path); budget != diagnosis.budgets.end()) {
      put_budget(one, budget->second);
    }
    one["confidence"] = off.confidence;
    one["alternatives"] = to_json(off.alternatives);
    json["parameters_off"].push_back(std::move(one));
  }
  json["recording"] = ordered_json::array();
  for (const RecordingFault& fault : diagnosis.recording_faults) {
    ordered_json one{{"name", fault.name}, {"channels", ordered_json::array()}, {"parameters", ordered_json::object()}};
    for (const model::Channel channel : fault.channels) one["channels"].push_back(model::name(channel));
    for (const auto& [parameter, value] : fault.parameters) one["parameters"][parameter] = to_json(value);
    if (!fault.path.empty()) one["path"] = fault.path;
    one["confidence"] = fault.confidence;
    if (fault.is_cause) one["alternatives"] = to_json(fault.alternatives);
    json["recording"].push_back(std::move(one));
  }
  json["laws"] = ordered_json::array();
  for (const DescribedLaw& law : diagnosis.laws) json["laws"].push_back(to_json(law));
  if (diagnosis.next_step) {
    const NextStep& next = *diagnosis.next_step;
    json["next_step"] = {{"words", words(next, diagnosis.rig.rig.kind)},
                         {"tells_apart", {next.one, next.other}},
                         {"frequency", next.test.frequency},
                         {"amplitude", next.test.amplitude},
                         {"separates", next.test.separates}};
  }
  json["undetermined"] = ordered_json::array();
  for (const Undetermined& open : diagnosis.undetermined) {
    json["undetermined"].push_back({{"combination", open.combination}, {"why", open.why}});
    if (!open.cause.empty()) json["undetermined"].back()["cause"] = open.cause;
  }
  require_finite(json, "");
  return json;
}

}  // namespace host_sim::identification
