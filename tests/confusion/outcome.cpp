#include "tests/confusion/outcome.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/identification/report/law_figure.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/confusion/black_box.hpp"
#include "tests/confusion/laws.hpp"
#include "tests/confusion/rough.hpp"

namespace confusion {
namespace {

using host_sim::identification::Diagnosis;
using host_sim::identification::Interval;
using host_sim::identification::NamedEffect;
using nlohmann::ordered_json;

std::string words(const truth::Effect& effect) {
  return effect.name + (effect.channel.empty() ? "" : " of " + effect.channel);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

Estimate estimate(std::string path, bool effect, const Interval& found, double truth) {
  const double scale = path.ends_with(": gain") ? std::abs(truth - 1.0) : std::abs(truth);
  return {std::move(path), effect, std::abs(found.value - truth) / std::max(scale, 1e-300),
          found.lower <= truth && truth <= found.upper};
}

std::string hidden_words(const truth::Truth& truth) {
  std::string text;
  for (const truth::Effect& effect : truth.effects) {
    text += (text.empty() ? "" : " and ") + words(effect);
    for (const auto& [key, value] : effect.parameters) text += " " + key + "=" + number(value);
  }
  if (!truth.unknown.empty()) {
    text += (text.empty() ? "" : " and ") + truth.unknown +
            (truth.unknown_channel.empty() ? "" : " (" + truth.unknown_channel + ")");
  }
  return text.empty() ? "nothing" : text;
}

std::string found_words(const Diagnosis& diagnosis) {
  std::string text;
  for (const NamedEffect& named : diagnosis.effects) {
    text += (text.empty() ? "" : " and ") + host_sim::identification::words(named.effect);
    for (std::size_t p = 0; p < named.parameters.size(); ++p) {
      text += " " + std::string(named.effect.entry->parameters[p].name) + "=" + number(named.parameters[p].value);
    }
    text += " [" + number(named.confidence) + "]";
  }
  for (const auto& law : diagnosis.laws)
    text += (text.empty() ? "" : " and ") + ("law at " + host_sim::identification::words(law)) + " [" +
            number(law.confidence) + "]";
  return text.empty() ? "nothing" : text;
}

/// As `rigtwin diagnose` reads a file: what may be left out is marked.
std::vector<firmware::Recording> parts_of(const std::string& csv, const firmware::RigDescription& description) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("rigtwin_confusion_" + std::to_string(::getpid()) + ".csv");
  firmware::write_file(file, csv);
  std::vector<firmware::Recording> parts;
  try {
    parts = host_sim::read_parts(file, description.channels, description.sample_rate);
  } catch (...) {
    std::filesystem::remove(file);
    throw;
  }
  std::filesystem::remove(file);
  return parts;
}

/// Some unknowns of the generator are no laws of a rig but faults of a recording, which contract.md names.
bool says_what_is_outside(const std::string& id, const truth::Truth& truth, const Diagnosis& diagnosis) {
  for (const auto& [unknown, fault] :
       {std::pair(":mains_hum:", "mains_hum"), std::pair(":quantisation:", "quantisation"),
        std::pair(":spikes:", "outliers"), std::pair(":clock_drift:", "clock_drift")}) {
    if (id.find(unknown) == std::string::npos) continue;
    for (const auto& said : diagnosis.recording_faults) {
      const auto here = [&](model::Channel c) { return model::name(c) == truth.unknown_channel; };
      if (said.name == fault && std::any_of(said.channels.begin(), said.channels.end(), here)) return true;
    }
  }
  for (const auto& [unknown, path] :
       {std::pair(":fading_damping:", "suspension.damping"), std::pair(":stiffness_drift:", "suspension.stiffness")}) {
    if (id.find(unknown) == std::string::npos) continue;
    if (std::any_of(diagnosis.recording_faults.begin(), diagnosis.recording_faults.end(),
                    [&, p = path](const auto& said) { return said.name == "drift" && said.path == p; }))
      return true;
  }
  return false;
}

/// Whether a law that was learned is the one that hides: a curve at the suspension, which all of these are there.
bool is_hidden_law(const truth::Truth& truth, const host_sim::identification::DescribedLaw& law) {
  if (truth.unknown_parameters.empty() || !truth.unknown_channel.empty()) return false;
  if (law.law.place != host_sim::identification::CurvePlace::suspension) return false;
  for (const char* value :
       {"wen_force", "stribeck_force", "cubic_damping", "asymmetry", "leaf_friction", "lopsided", "stroke_damping",
        "power", "smooth_friction", "bypass", "bristle", "blow_off", "degressive", "iwan", "fractional"}) {
    if (truth.unknown_parameters.contains(value)) return true;
  }
  return false;
}

/// What stands beside each other in laws_text().
std::map<std::string, double> errors_of_force(const Diagnosis& diagnosis, double black_box) {
  const auto it = diagnosis.prediction_errors.find(model::Channel::F);
  if (it == diagnosis.prediction_errors.end()) return {};
  const auto& gap = it->second;
  return {{"described", gap.before}, {"refitted", gap.refit},  {"catalogue", gap.catalogue.value_or(gap.after)},
          {"law", gap.after},        {"black box", black_box}, {"noise", gap.noise_floor}};
}

/// JSON has no NaN: it is written as null.
double number_from(const ordered_json& json) { return json.is_null() ? NAN : json.get<double>(); }

}  // namespace

std::size_t Outcome::effects_found() const {
  return static_cast<std::size_t>(std::count_if(named.begin(), named.end(), [](const Named& n) { return n.right; }));
}

bool Outcome::exact() const { return effects_found() == effects_hidden && named.size() == effects_hidden; }

bool Outcome::wrong_name() const {
  return std::any_of(named.begin(), named.end(), [](const Named& n) { return !n.right && n.confidence > 0.5; });
}

bool Outcome::right() const {
  if (!failure.empty()) return false;
  if (asked.what() == "rough") return rough_right;
  if (asked.what() == "law") return shape_right;
  if (asked.what() == "none") return verdict == "no_discrepancy" && named.empty();
  if (asked.what() == "unknown") return (flagged() || outside_said) && !wrong_name();
  return exact() && (verdict == "named" || verdict == "ambiguous");
}

std::string_view name_in_catalogue(const truth::Truth& truth) {
  for (const auto& [value, name] :
       {std::pair("wen_force", "bouc_wen"), std::pair("stribeck_force", "stribeck_friction"),
        std::pair("asymmetry", "asymmetric_damper")}) {
    if (truth.unknown_parameters.contains(value)) return name;
  }
  return {};
}

Outcome judged(const Asked& asked, const truth::Truth& truth, const Diagnosis& diagnosis) {
  Outcome outcome;
  outcome.asked = asked;
  outcome.hidden = hidden_words(truth);
  outcome.found = found_words(diagnosis);
  outcome.size = truth.size;
  outcome.verdict = host_sim::identification::name(diagnosis.verdict);
  outcome.unexplained = diagnosis.unexplained;
  outcome.outside_said = says_what_is_outside(asked.id(), truth, diagnosis);
  outcome.rest = diagnosis.residual;
  outcome.effects_hidden = truth.effects.size();
  outcome.residual_power = diagnosis.residual_power.after;
  std::vector<std::string> missed;
  for (const truth::Effect& effect : truth.effects) missed.push_back(words(effect));
  bool stribeck = false;  // is dry friction that falls: the friction beside the law is part of it
  for (const auto& law : diagnosis.laws) {
    const bool right = is_hidden_law(truth, law);
    outcome.outside_said = outcome.outside_said || right;
    stribeck = stribeck || (right && law.shape == "stribeck");
    if (!right) outcome.named.push_back({"law " + law.shape, law.confidence, false});
  }
  for (const NamedEffect& named : diagnosis.effects) {
    if (stribeck && named.effect.entry->name == "coulomb_friction") continue;
    const std::string name = host_sim::identification::words(named.effect);
    const auto it = std::find_if(truth.effects.begin(), truth.effects.end(),
                                 [&](const truth::Effect& effect) { return words(effect) == name; });
    const bool outside = it == truth.effects.end() && name == name_in_catalogue(truth);
    outcome.outside_said = outcome.outside_said || outside;
    outcome.named.push_back({name, named.confidence, it != truth.effects.end() || outside});
    if (it == truth.effects.end()) continue;
    std::erase(missed, name);
    for (std::size_t p = 0; p < named.parameters.size(); ++p) {
      const std::string key(named.effect.entry->parameters[p].name);
      outcome.estimates.push_back(estimate(name + ": " + key, true, named.parameters[p], it->parameters.at(key)));
    }
  }
  for (const NamedEffect& named : diagnosis.effects) {
    for (const auto& other : named.alternatives) {
      const auto* const effect = std::get_if<firmware::PlacedEffect>(&other.cause);
      const auto* const parameter = std::get_if<host_sim::identification::ParameterValue>(&other.cause);
      const bool hidden =
          effect != nullptr
              ? std::find(missed.begin(), missed.end(), host_sim::identification::words(*effect)) != missed.end()
              : std::find(truth.rough.off.begin(), truth.rough.off.end(), parameter->path) != truth.rough.off.end();
      outcome.truth_is_rival = outcome.truth_is_rival || hidden;
    }
  }
  if (outcome.exact() && truth.unknown.empty()) {
    for (const auto& [path, value] : diagnosis.parameters) {
      if (truth.actual.contains(path)) outcome.estimates.push_back(estimate(path, false, value, truth.actual.at(path)));
    }
  }
  for (const auto& [channel, gap] : diagnosis.prediction_errors) {
    const double ratio = gap.noise_floor > 0.0 ? gap.after / gap.noise_floor : 0.0;
    if (ratio <= outcome.gap) continue;
    outcome.gap = ratio;
    outcome.gap_channel = model::name(channel);
  }
  return outcome;
}

Outcome run(const Asked& asked, const truth::Wanted& wanted, bool compare_models) {
  Outcome outcome;
  outcome.asked = asked;
  try {
    const bool rough = asked.what() == "rough";
    const truth::Truth truth = rough ? truth::draw_rough(asked.group.substr(asked.group.find(':') + 1), asked.seed)
                                     : truth::draw(asked.group, asked.seed, wanted);
    outcome.hidden = hidden_words(truth);
    outcome.effects_hidden = truth.effects.size();
    if (rough) describe_rough(outcome, truth);
    const firmware::RigDescription description = firmware::parse_rig(truth::rig_toml(truth), "rig.toml");
    std::vector<host_sim::identification::Record> records;
    for (const truth::Record& record : truth::simulate(truth)) {
      const std::string file = "rec" + std::to_string(records.size() + 1) + ".csv";
      if (rough) {
        for (firmware::Recording& part : parts_of(truth::csv(truth, record), description))
          records.push_back({std::move(part), host_sim::identification::Use::shared});
        continue;
      }
      records.push_back({firmware::parse_recording_csv(truth::csv(truth, record), file, description.channels,
                                                       description.sample_rate),
                         host_sim::identification::Use::shared});
    }
    std::optional<BlackBox> black_box;
    if (asked.what() == "law" && truth.kind == truth::Kind::component_bench && records.size() == 1)
      black_box.emplace(records.front().recording);
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t used = std::clock();
    host_sim::identification::Identified identified =
        host_sim::identification::identify(description, std::move(records));
    const Diagnosis& diagnosis = identified.diagnosis;
    outcome = judged(asked, truth, diagnosis);
    if (rough) judge_rough(outcome, truth, diagnosis);
    judge_law(outcome, truth, diagnosis);
    outcome.law_numbers = truth.unknown_parameters;
    if (black_box) outcome.errors_of_force = errors_of_force(diagnosis, black_box->error());
    outcome.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    outcome.processor = static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC;
    if (compare_models) outcome.models = compared_models(identified);
  } catch (const std::exception& problem) {
    outcome.failure = problem.what();
  }
  return outcome;
}

ordered_json to_json(const Outcome& o) {
  ordered_json json{
      {"group", o.asked.group}, {"seed", o.asked.seed}, {"right", o.right()},   {"hidden", o.hidden},
      {"found", o.found},       {"size", o.size},       {"verdict", o.verdict}, {"unexplained", o.unexplained}};
  if (o.outside_said) json["outside_said"] = true;
  if (!o.rest.empty()) json["rest"] = o.rest;
  if (!o.failure.empty()) json["failure"] = o.failure;
  json["effects_hidden"] = o.effects_hidden;
  json["named"] = ordered_json::array();
  for (const Named& n : o.named) {
    json["named"].push_back({{"effect", n.effect}, {"confidence", n.confidence}, {"right", n.right}});
  }
  if (o.truth_is_rival) json["truth_is_rival"] = true;
  json["estimates"] = ordered_json::array();
  for (const Estimate& e : o.estimates) {
    json["estimates"].push_back({{"path", e.path}, {"effect", e.effect}, {"error", e.error}, {"held", e.held}});
  }
  if (!o.condition.empty()) {
    json["rough"] = {{"condition", o.condition},         {"off_hidden", o.off_hidden},     {"off_found", o.off_found},
                     {"faults_hidden", o.faults_hidden}, {"faults_found", o.faults_found}, {"wrong", o.wrong_rough},
                     {"same_thing", o.same_thing},       {"right", o.rough_right}};
  }
  if (o.asked.what() == "law") {
    json["law"] = {{"shape_right", o.shape_right},
                   {"exponent_error", o.exponent_error},
                   {"numbers", o.law_numbers},
                   {"errors_of_force", o.errors_of_force}};
  }
  json["wrong_law"] = o.wrong_law;
  json["gap"] = o.gap;
  json["gap_channel"] = o.gap_channel;
  for (const ComparedModel& model : o.models) {
    json["models"].push_back({{"causes", model.causes}, {"penalised", model.penalised}, {"evidence", model.evidence}});
  }
  json["residual_power"] = o.residual_power;
  json["wall"] = o.wall;
  json["processor"] = o.processor;
  return json;
}

Outcome outcome_from(const ordered_json& json) {
  Outcome o;
  o.asked = {json.at("group"), json.at("seed")};
  o.hidden = json.at("hidden");
  o.found = json.at("found");
  o.size = number_from(json.at("size"));
  o.verdict = json.at("verdict");
  o.unexplained = json.at("unexplained");
  o.outside_said = json.value("outside_said", false);
  o.rest = json.value("rest", "");
  o.failure = json.value("failure", "");
  o.effects_hidden = json.at("effects_hidden");
  for (const auto& n : json.at("named"))
    o.named.push_back({n.at("effect"), number_from(n.at("confidence")), n.at("right")});
  o.truth_is_rival = json.value("truth_is_rival", false);
  for (const auto& model : json.value("models", ordered_json::array())) {
    ComparedModel compared{model.at("causes"), number_from(model.at("penalised")), {}};
    for (const auto& [key, value] : model.at("evidence").items()) compared.evidence[key] = number_from(value);
    o.models.push_back(std::move(compared));
  }
  for (const auto& e : json.at("estimates")) {
    o.estimates.push_back({e.at("path"), e.at("effect"), number_from(e.at("error")), e.at("held")});
  }
  if (json.contains("rough")) {
    const auto& rough = json.at("rough");
    o.condition = rough.at("condition");
    o.off_hidden = rough.at("off_hidden");
    o.off_found = rough.at("off_found");
    o.faults_hidden = rough.at("faults_hidden");
    o.faults_found = rough.at("faults_found");
    o.wrong_rough = rough.at("wrong");
    o.same_thing = rough.at("same_thing");
    o.rough_right = rough.at("right");
  }
  if (json.contains("law")) {
    o.shape_right = json.at("law").at("shape_right");
    o.exponent_error = number_from(json.at("law").at("exponent_error"));
    o.law_numbers = json.at("law").at("numbers").get<std::map<std::string, double>>();
    for (const auto& [of, error] : json.at("law").at("errors_of_force").items())
      o.errors_of_force[of] = number_from(error);  // a black box may diverge
  }
  o.wrong_law = json.value("wrong_law", false);
  o.gap = number_from(json.at("gap"));
  o.gap_channel = json.at("gap_channel");
  o.residual_power = number_from(json.at("residual_power"));
  o.wall = number_from(json.at("wall"));
  o.processor = number_from(json.at("processor"));
  return o;
}

}  // namespace confusion
