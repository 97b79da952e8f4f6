#include "host_sim/identification/report/diagnosis_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/report/confidence_text.hpp"
#include "host_sim/identification/report/edited_rig.hpp"
#include "host_sim/identification/report/law_figure.hpp"
#include "host_sim/identification/report/shape_words.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::identification {
namespace {

using report::Axis;
using report::Curve;
using report::Dash;
using report::Figure;
using report::figure_text;
using report::Panel;
using report::Report;
using report::Table;

std::string with_interval(const Interval& v, const std::string& unit) {
  return figure_text(v.value, 5) + (unit.empty() ? "" : " " + unit) + " (" + figure_text(v.lower, 5) + " … " +
         figure_text(v.upper, 5) + ")";
}

/// How firmly a headline may say a thing of this confidence: of a hundred that are said plainly, ninety are right.
enum class Firmness : unsigned char { certain, likely, possible };
Firmness firmness_of(double confidence) {
  constexpr double plain = 0.9, more_likely_than_not = 0.5;
  if (confidence >= plain) return Firmness::certain;
  return confidence >= more_likely_than_not ? Firmness::likely : Firmness::possible;
}

/// A sensor's effect while every balance that its channel takes part in holds is a degree less firm.
Firmness firmness_of(const NamedEffect& named, const std::vector<ParityResidual>& relations) {
  Firmness firmness = firmness_of(named.confidence);
  if (!named.effect.channel) return firmness;
  const std::string place = "sensor " + std::string(model::name(*named.effect.channel));
  bool judged = false, fails = false;
  for (const ParityResidual& relation : relations) {
    const bool holds_it = std::any_of(relation.locations.begin(), relation.locations.end(),
                                      [&](const auto& location) { return location.place == place; });
    judged = judged || holds_it;
    fails = fails || (holds_it && relation.significant());
  }
  if (judged && !fails && firmness != Firmness::possible) {
    firmness = firmness == Firmness::certain ? Firmness::likely : Firmness::possible;
  }
  return firmness;
}

/// The channel whose error shrinks most.
const std::pair<const model::Channel, PredictionError>* most_improved(const Diagnosis& diagnosis) {
  const std::pair<const model::Channel, PredictionError>* best = nullptr;
  double most = 1.0;
  for (const auto& entry : diagnosis.prediction_errors) {
    const double ratio = entry.second.refit / std::max(entry.second.after, 1e-12);
    if (ratio > most) {
      most = ratio;
      best = &entry;
    }
  }
  return best;
}

void add_gaps(Report& page, const Diagnosis& diagnosis) {
  if (diagnosis.prediction_errors.empty()) return;
  Figure figure;
  figure.title = "Gap between rig and model, on data that was not used for fitting";
  figure.note = "rms of the error ÷ rms of the channel. A model that is right ends at the noise floor.";
  figure.x = {"error ÷ rms", "%"};
  Panel panel;
  panel.y.quantity = "channel";
  panel.y.of_names = true;
  report::Bars before{"before", {}, {}, 6}, refit{"tolerances refitted", {}, {}, 4}, after{"after", {}, {}, 0},
      floor{"noise floor", {}, {}, 2}, catalogue{"effects of the catalogue alone", {}, {}, 5};
  for (auto entry = diagnosis.prediction_errors.rbegin(); entry != diagnosis.prediction_errors.rend(); ++entry) {
    const std::string channel(model::name(entry->first));
    for (auto [bars, value] : {std::pair(&floor, entry->second.noise_floor), std::pair(&after, entry->second.after),
                               std::pair(&refit, entry->second.refit), std::pair(&before, entry->second.before)}) {
      bars->names.push_back(channel);
      bars->values.push_back(100.0 * value);
    }
    if (!entry->second.catalogue) continue;
    catalogue.names.push_back(channel);
    catalogue.values.push_back(100.0 * *entry->second.catalogue);
  }
  panel.bars = {floor, after};
  if (!catalogue.names.empty()) panel.bars.push_back(catalogue);
  panel.bars.insert(panel.bars.end(), {refit, before});
  figure.panels.push_back(panel);
  figure.height = 140 + 80 * static_cast<int>(diagnosis.prediction_errors.size());
  page.add_figure(figure);
}

void add_parameters_off(Report& page, const Diagnosis& diagnosis) {
  if (diagnosis.parameters_off.empty()) return;
  page.add_section("Parameters that are not as described");
  Table table{
      "", {"parameter", "described", "tolerance [%]", "fitted, 95 % interval", "confidence", "nearest rival"}, {}, 3};
  for (const ParameterOff& off : diagnosis.parameters_off) {
    std::string rival;
    if (!off.alternatives.empty()) {
      rival = words(off.alternatives.front()) + ", " + odds_text(off.alternatives.front().odds_against) + " against";
    }
    table.rows.push_back({off.path, figure_text(off.described, 6), figure_text(100.0 * off.tolerance, 3),
                          with_interval(off.value, ""), confidence_text(off.confidence), rival});
  }
  page.add_table(table);
}

void add_recording_faults(Report& page, const Diagnosis& diagnosis) {
  if (diagnosis.recording_faults.empty()) return;
  const bool any_wrong = std::any_of(diagnosis.recording_faults.begin(), diagnosis.recording_faults.end(),
                                     [](const RecordingFault& fault) { return !fault.is_set_up(); });
  page.add_section(any_wrong ? "What is wrong with the recording" : "The recording");
  for (const RecordingFault& fault : diagnosis.recording_faults) page.add_text(words(fault) + ".");
  const auto is_noise = [](const RecordingFault& fault) { return !fault.is_cause && !fault.is_set_up(); };
  if (std::any_of(diagnosis.recording_faults.begin(), diagnosis.recording_faults.end(), is_noise)) {
    page.add_text("The diagnosis used the noise that the samples show, not the one declared.");
  }
  if (diagnosis.has_cause_in_recording()) {
    page.add_text(
        "These faults were fitted together with the rig. They are no part of the rig description below: a parameter "
        "that "
        "drifts has there its value in the middle of the recording.");
  }
}

void add_effects(Report& page, const Diagnosis& diagnosis) {
  if (diagnosis.effects.empty()) return;
  page.add_section("What is missing, and how sure that is");
  Table found{"Effects", {"effect", "parameter", "confidence"}, {}, 2};
  Table rivals{"Rivals: what else was tried in an effect's place, everything fitted again",
               {"effect", "rival", "odds against it"},
               {},
               2};
  for (const NamedEffect& named : diagnosis.effects) {
    std::string values;
    for (std::size_t p = 0; p < named.parameters.size(); ++p) {
      const auto& card = named.effect.entry->parameters[p];
      values += (p > 0 ? "; " : "") + std::string(card.name) + " " +
                with_interval(named.parameters[p], unit_of(named.effect, p));
    }
    found.rows.push_back({words(named.effect), values, confidence_text(named.confidence)});
    for (const Alternative& other : named.alternatives) {
      std::string rival = words(other);
      if (!other.separate_by.empty()) rival += " – told apart by " + other.separate_by;
      rivals.rows.push_back({words(named.effect), rival, odds_text(other.odds_against)});
    }
  }
  page.add_table(found);
  for (const NamedEffect& named : diagnosis.effects) {
    const std::string shape = shape_words(named.effect, diagnosis.rig.rig);
    page.add_text(words(named.effect) + ": " + (shape.empty() ? "" : shape + ". ") +
                  std::string(named.effect.entry->equation) + ". It shows as " +
                  std::string(named.effect.entry->shows) + ".");
  }
  if (!rivals.rows.empty()) page.add_table(rivals);
}

/// What is left of each channel over the frequency, with its bounds.
Panel left_over(const std::string& when, const std::vector<BandPower>& powers, bool first) {
  Panel panel;
  panel.y = {when + ": power ÷ noise", "1", true};
  for (const BandPower& p : powers) {
    const std::string channel(model::name(p.channel));
    if (panel.curves.empty() || panel.curves.back().name != channel) {
      report::Curve curve;
      curve.name = channel;
      curve.colour = static_cast<int>(panel.curves.size());
      curve.dash = Dash::by_turns;
      curve.marker = report::Marker::circle;
      curve.in_legend = first;
      panel.curves.push_back(std::move(curve));
    }
    report::Curve& curve = panel.curves.back();
    curve.x.push_back(std::sqrt(std::max(p.lowest, 0.25 * p.highest) * p.highest));
    curve.y.push_back(p.power.ratio());
    curve.lower_error.push_back(p.power.ratio() - p.lower);
    curve.upper_error.push_back(p.upper - p.power.ratio());
  }
  panel.guides.push_back({report::Guide::Along::y, 1.0, "noise"});
  return panel;
}

/// The residual of each channel second by second, a strip for each channel.
void add_power_over_time(Report& page, const Diagnosis& diagnosis) {
  constexpr std::size_t most_recordings = 4;
  std::size_t last = 0;
  for (const PowerOverTime& power : diagnosis.power_over_time) last = std::max(last, power.recording);
  for (std::size_t recording = 0; recording <= std::min(last, most_recordings - 1); ++recording) {
    Figure figure;
    figure.title = "What is left, second by second";
    if (last > 0) figure.title += ", recording " + std::to_string(recording + 1);
    figure.note = "Power ÷ power of noise of each stretch of about a second; 1 is noise.";
    figure.x = {"time", "s"};
    for (const PowerOverTime& power : diagnosis.power_over_time) {
      if (power.recording != recording) continue;
      std::vector<double> time;
      for (std::size_t k = 0; k < power.from.size(); ++k) time.push_back(0.5 * (power.from[k] + power.to[k]));
      Curve refit{"tolerances refitted", time, power.refit, 5, Dash::dash_dotted};
      Curve after{"after", time, power.after, 0, Dash::solid};
      refit.in_legend = after.in_legend = figure.panels.empty();
      Panel strip;
      strip.y = {std::string(model::name(power.channel)), "1", true};
      strip.curves = {refit, after};
      strip.guides.push_back({report::Guide::Along::y, 1.0, figure.panels.empty() ? "noise" : ""});
      figure.panels.push_back(strip);
    }
    if (figure.panels.empty()) continue;
    figure.height = 160 + 110 * static_cast<int>(figure.panels.size());
    page.add_figure(figure);
  }
}

void add_where(Report& page, const Diagnosis& diagnosis) {
  if (diagnosis.locations.empty()) return;
  page.add_section("Where");
  page.add_text("Power beyond noise that refitted tolerances do not explain, by channel.");
  Table table{"", {"channel", "subsystem", "from [Hz]", "to [Hz]", "share [%]"}, {}, 2};
  for (const RecordingLocation& place : diagnosis.locations) {
    table.rows.push_back({std::string(model::name(place.channel)), place.subsystem, figure_text(place.lowest, 3),
                          figure_text(place.highest, 3), figure_text(100.0 * place.share, 3)});
  }
  page.add_table(table);
  Figure map;
  map.title = "What is left, by channel and band";
  map.note = "Power ÷ power of noise with 95 % bounds. A channel whose bounds hold 1 in a band shows nothing there.";
  map.x = {"frequency", "Hz", true};
  map.panels = {left_over("refitted", diagnosis.left_by_refit, true), left_over("after", diagnosis.left_after, false)};
  map.height = 560;
  page.add_figure(map);
  add_power_over_time(page, diagnosis);
  if (diagnosis.relations.empty()) return;
  Table relations{"What the rig's own redundancy says, before anything is fitted but tolerances",
                  {"relation", "holds", "power ÷ noise", "from [Hz]", "to [Hz]", "what is left"},
                  {},
                  2};
  for (const ParityResidual& r : diagnosis.relations) {
    const bool failed = r.significant();
    relations.rows.push_back({r.relation, failed ? "no" : "yes", failed ? figure_text(r.ratio, 3) : "",
                              failed ? figure_text(r.lowest, 3) : "", failed ? figure_text(r.highest, 3) : "",
                              r.description});
  }
  page.add_table(relations);
}

void add_overlays(Report& page, const Diagnosis& diagnosis) {
  page.add_section("Measured and simulated");
  for (const Overlay& overlay : diagnosis.overlays) {
    const std::string channel(model::name(overlay.channel)), unit(model::unit(overlay.channel));
    Figure time;
    time.title = channel + " over time";
    time.x = {"time", "s"};
    Panel signals;
    signals.y = {channel, unit};
    signals.curves = {{"measured", overlay.time, overlay.measured, 6, Dash::solid},
                      {"tolerances refitted", overlay.time, overlay.refit, 1, Dash::dashed},
                      {"after", overlay.time, overlay.after, 0, Dash::dotted}};
    time.panels.push_back(signals);
    page.add_figure(time);
    Figure spectrum;
    spectrum.title = "Error of " + channel + " by frequency";
    spectrum.x = {"frequency", "Hz", true};
    Panel densities;
    densities.y = {"spectral density", "(" + unit + ")²/Hz", true};
    densities.curves = {{"measured " + channel, overlay.frequency, overlay.data, 6, Dash::dotted},
                        {"error before", overlay.frequency, overlay.error_before, 1, Dash::dashed},
                        {"error, tolerances refitted", overlay.frequency, overlay.error_refit, 5, Dash::dash_dotted},
                        {"error after", overlay.frequency, overlay.error_after, 0, Dash::solid}};
    if (overlay.noise > 0.0) {
      densities.guides.push_back({report::Guide::Along::y, overlay.noise, "sensor noise"});
    }
    spectrum.panels.push_back(densities);
    page.add_figure(spectrum);
  }
}

/// A row for each part of a budget that counts; only the first names the number. verdict.json has them all.
void add_budget(const std::string& number, const std::string& unit, double value, const UncertaintyBudget& budget,
                Table& table) {
  constexpr double shown = 1e-3;  // of the variance
  const std::string in_unit = unit.empty() ? "" : " " + unit;
  for (std::size_t i = 0; i < budget.parts.size(); ++i) {
    const UncertaintyBudget::Part& part = budget.parts[i];
    const bool first = i == 0;
    if (!first && budget.share(part) < shown) continue;
    table.rows.push_back({first ? number + " = " + figure_text(value, 5) + in_unit : "", words(part),
                          figure_text(part.standard, 3) + in_unit, figure_text(100.0 * budget.share(part), 3) + " %",
                          first ? figure_text(budget.combined, 3) + in_unit : "",
                          first ? "± " + figure_text(budget.coverage * budget.combined, 3) + in_unit : ""});
  }
}

std::string unit_of_parameter(const std::string& path) {
  for (const firmware::ParameterPath& p : firmware::parameter_paths()) {
    if (path == std::string(p.table) + "." + std::string(p.key)) return p.unit == "1" ? "" : std::string(p.unit);
  }
  return {};
}

/// Where the uncertainty of each number comes from.
void add_budgets(Report& page, const Diagnosis& diagnosis) {
  const std::vector<std::string> heading{"number",   "source", "standard uncertainty", "share of the variance",
                                         "combined", "95 %"};
  Table estimates{"Uncertainty budget of what was estimated", heading, {}, 2};
  for (const NamedEffect& named : diagnosis.effects) {
    for (std::size_t p = 0; p < std::min(named.parameters.size(), named.budgets.size()); ++p) {
      add_budget(words(named.effect) + ", " + std::string(named.effect.entry->parameters[p].name),
                 unit_of(named.effect, p), named.parameters[p].value, named.budgets[p], estimates);
    }
  }
  for (const auto& [path, budget] : diagnosis.budgets) {
    add_budget(path, unit_of_parameter(path), diagnosis.parameters.at(path).value, budget, estimates);
  }
  Table predictions{"Uncertainty budget of what the model predicts for the recorded motion", heading, {}, 2};
  for (const auto& [channel, predicted] : diagnosis.predictions) {
    const std::string unit(model::unit(channel)), of = " of " + std::string(model::name(channel));
    add_budget("rms" + of, unit, predicted.rms.interval.value, predicted.rms.budget, predictions);
    add_budget("peak" + of, unit, predicted.peak.interval.value, predicted.peak.budget, predictions);
  }
  if (estimates.rows.empty() && predictions.rows.empty()) return;
  page.add_section("Where the uncertainty comes from");
  page.add_text("Shares of the variance. Parts below 0.1 % stand in verdict.json.");
  if (!estimates.rows.empty()) page.add_table(estimates);
  if (!predictions.rows.empty()) page.add_table(predictions);
}

/// A rig description with a number that is not finite cannot be read again.
void require_finite(const firmware::RigDescription& found) {
  model::RigParameters<double> rig = found.rig;
  for (const firmware::ParameterPath& p : firmware::parameter_paths()) {
    const std::string path = std::string(p.table) + "." + std::string(p.key);
    const double* const value = firmware::find_parameter(rig, path);
    if (value != nullptr && !std::isfinite(*value)) throw std::logic_error("rig.toml: " + path + " is not finite");
  }
  for (const firmware::PlacedEffect& effect : firmware::effects_of(rig)) {
    for (const double value : effect.values) {
      if (!std::isfinite(value)) throw std::logic_error("rig.toml: " + words(effect) + " is not finite");
    }
  }
}

}  // namespace

namespace {

/// "clock_drift of dz_b and F_w", "drift of suspension.damping", "event"
std::string named(const RecordingFault& fault) {
  std::vector<std::string> channels;
  for (const model::Channel channel : fault.channels) channels.emplace_back(model::name(channel));
  const std::string of = fault.path.empty() ? joined(channels) : fault.path;
  return fault.name + (of.empty() ? "" : " of " + of);
}

/// The faults of the recording that must be taken into account, in words; empty without one.
std::string causes_in_recording(const Diagnosis& diagnosis) {
  std::vector<std::string> causes;
  for (const RecordingFault& fault : diagnosis.recording_faults) {
    if (!fault.is_cause) continue;
    std::string text = named(fault) + " (";
    const char* separator = "";
    for (const auto& [parameter, value] : fault.parameters) {
      text += separator + parameter + " " + figure_text(value.value, 4);
      separator = ", ";
    }
    causes.push_back(text + ")");
  }
  return joined(causes);
}

/// " (or suspension.stiffness is 27653)": the nearest parameter that the recordings do not tell from a cause.
std::string or_parameter(const std::vector<Alternative>& alternatives) {
  for (const Alternative& other : alternatives) {
    const auto* const parameter = std::get_if<ParameterValue>(&other.cause);
    if (parameter == nullptr || !is_close(other)) continue;
    return " (or " + parameter->path + " is " + figure_text(parameter->value, 5) + ")";
  }
  return {};
}

/// Whether another effect, or a law outside the catalogue, explains the recordings nearly as well as what is named.
/// Parameters do not count: the sentence names them.
bool has_close_effect(const Diagnosis& diagnosis) {
  const auto among = [](const std::vector<Alternative>& alternatives) {
    return std::any_of(alternatives.begin(), alternatives.end(), [](const Alternative& other) {
      return is_close(other) && std::holds_alternative<firmware::PlacedEffect>(other.cause);
    });
  };
  const auto of_cause = [&](const auto& cause) { return among(cause.alternatives); };
  return std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(),
                     [&](const NamedEffect& named) { return of_cause(named) || is_close(named.other); }) ||
         std::any_of(diagnosis.parameters_off.begin(), diagnosis.parameters_off.end(), of_cause) ||
         std::any_of(diagnosis.recording_faults.begin(), diagnosis.recording_faults.end(), of_cause);
}

/// "The model lacks A and B; it probably lacks C; it may lack D": what is said first is said most firmly.
std::string lacking(const std::vector<std::string>& certain, const std::vector<std::string>& likely,
                    const std::vector<std::string>& possible) {
  std::string text;
  const auto add = [&text](const std::vector<std::string>& names, const char* verb) {
    if (names.empty()) return;
    text += text.empty() ? "The model " : "; it ";
    text += verb + (" " + joined(names));
  };
  add(certain, "lacks");
  add(likely, "probably lacks");
  add(possible, "may lack");
  return text;
}

/// What an effect makes of a parameter that the rig has anyway: ": suspension.damping is 1800, not 1500". Only a law
/// that is a straight line at the suspension adds to one; where the description has none of it, nothing is said.
std::string as_parameter(const NamedEffect& named, const firmware::RigDescription& found) {
  const model::ForceForm& force = named.effect.entry->force;
  const bool damper = force.is_power(model::Over::velocity, 1.0), spring = force.is_power(model::Over::deflection, 1.0);
  if (named.effect.entry->subsystem != model::Subsystem::suspension || !(damper || spring)) return {};
  const double described = damper ? found.rig.suspension.damping : found.rig.suspension.stiffness;
  if (!(described > 0.0) || named.parameters.size() != 1) return {};
  const std::string path = damper ? "suspension.damping" : "suspension.stiffness";
  const std::string sum = figure_text(described + named.parameters.front().value, 4);
  const auto tolerance = found.tolerance.find(path);
  const bool is_fitted = tolerance != found.tolerance.end() && tolerance->second > 0.0;
  return ": " + path + " is " + sum + (is_fitted ? ", beyond its tolerance" : ", not " + figure_text(described, 4));
}

/// The law and an effect of the same place and kind are one law: " (with coulomb_friction, 45 N in all)", where both
/// are a force that does not grow with the motion.
std::string split_of(const DescribedLaw& law, const std::vector<NamedEffect>& effects) {
  const auto force = std::find_if(law.numbers.begin(), law.numbers.end(),
                                  [](const LawNumber& number) { return number.name == "force"; });
  if (force == law.numbers.end()) return {};
  for (const NamedEffect& named : effects) {
    const auto& card = *named.effect.entry;
    const bool same_place = std::string(model::name(card.subsystem)) == std::string(name(law.law.place));
    if (!same_place || card.parameters.size() != 1 || card.parameters.front().unit != "N") continue;
    return " (with " + words(named.effect) + " at the same place one law of " +
           figure_text(force->value + named.parameters.front().value, 3) + " N in all)";
  }
  return {};
}

}  // namespace

std::string odds_text(double odds) {
  if (odds < 1.0) return "1 to " + figure_text(1.0 / odds, 3);
  return odds > 1e6 ? "over a million to 1" : figure_text(odds, 3) + " to 1";
}

std::string words(const Alternative& other) {
  if (const auto* const parameter = std::get_if<ParameterValue>(&other.cause)) {
    return parameter->path + " of " + figure_text(parameter->value, 6);
  }
  return words(std::get<firmware::PlacedEffect>(other.cause));
}

std::string unit_of(const firmware::PlacedEffect& effect, std::size_t parameter) {
  const std::string_view unit = effect.entry->parameters[parameter].unit;
  if (unit == "of the channel" && effect.channel) return std::string(model::unit(*effect.channel));
  return unit == "1" ? std::string() : std::string(unit);
}

std::string sentence(const Diagnosis& diagnosis) {
  std::vector<std::string> names, likely, possible;  // by firmness
  for (const NamedEffect& named : diagnosis.effects) {
    if (named.is_by_chance()) continue;
    std::string text = words(named.effect);
    if (!named.parameters.empty()) {
      const std::string unit = unit_of(named.effect, 0);
      text += " (" + figure_text(named.parameters.front().value, 4) + (unit.empty() ? "" : " " + unit) +
              as_parameter(named, diagnosis.rig) + ")";
    }
    text += or_parameter(named.alternatives);
    const Firmness firmness = firmness_of(named, diagnosis.relations);
    (firmness == Firmness::certain ? names : firmness == Firmness::likely ? likely : possible).push_back(text);
  }
  for (const DescribedLaw& law : diagnosis.laws) {
    const Firmness firmness = firmness_of(law.confidence);
    (firmness == Firmness::certain  ? names
     : firmness == Firmness::likely ? likely
                                    : possible)
        .push_back("a law at the " + words(law) + split_of(law, diagnosis.effects));
  }
  const bool lacks_any = !names.empty() || !likely.empty() || !possible.empty();
  std::vector<std::string> off;
  for (const ParameterOff& parameter : diagnosis.parameters_off) {
    const Firmness firmness = firmness_of(parameter.confidence);
    off.push_back(parameter.path +
                  (firmness == Firmness::certain  ? " is "
                   : firmness == Firmness::likely ? " is probably "
                                                  : " may be ") +
                  figure_text(parameter.value.value, 5) + ", not " + figure_text(parameter.described, 5));
    off.back() += or_parameter(parameter.alternatives);
  }
  const std::string causes = causes_in_recording(diagnosis);
  if (off.empty() && !lacks_any && !causes.empty() && diagnosis.verdict != Verdict::unexplained) {
    return "Rig and model agree, but the recording does not: " + causes + "." +
           (diagnosis.residual.empty() ? "" : " Left over: " + diagnosis.residual + ".");
  }
  if (!off.empty() && !lacks_any) {
    std::string text = joined(off);
    if (diagnosis.verdict == Verdict::ambiguous)
      text += has_close_effect(diagnosis) ? ", or an effect that these recordings cannot tell apart from it"
                                          : ", which these recordings do not tell apart";
    if (diagnosis.verdict == Verdict::unexplained)
      text = "Rig and model disagree by more than a parameter explains; " + text;
    if (const auto* best = most_improved(diagnosis); best != nullptr) {
      text += ": with it the error of " + std::string(model::name(best->first)) + " falls from " +
              figure_text(100.0 * best->second.refit, 3) + " to " + figure_text(100.0 * best->second.after, 3) + " %";
    }
    if (!causes.empty()) text += "; in the recording " + causes;
    return text + "." + (diagnosis.residual.empty() ? "" : " Left over: " + diagnosis.residual + ".");
  }
  std::string text;
  switch (diagnosis.verdict) {
    case Verdict::no_discrepancy:
      return "Rig and model agree: what is left over is noise, with every parameter within its tolerance.";
    case Verdict::unexplained:
      text = "Rig and model disagree, and no effect of the catalogue explains it";
      if (lacks_any) {
        std::vector<std::string> all = names;
        all.insert(all.end(), likely.begin(), likely.end());
        all.insert(all.end(), possible.begin(), possible.end());
        text = "Rig and model disagree by more than the catalogue explains; " + joined(all) + " would help";
      }
      break;
    case Verdict::ambiguous:
      text = lacking(names, likely, possible) + (has_close_effect(diagnosis)
                                                     ? ", or a rival that these recordings cannot tell apart from it"
                                                     : ", which these recordings do not tell apart");
      break;
    case Verdict::named:
      text = lacking(names, likely, possible);
      break;
  }
  if (const auto* best = most_improved(diagnosis); best != nullptr && lacks_any) {
    text += ": with it the error of " + std::string(model::name(best->first)) + " falls from " +
            figure_text(100.0 * best->second.refit, 3) + " to " + figure_text(100.0 * best->second.after, 3) + " %";
  }
  text += ".";
  if (!off.empty()) text += " Beside it " + joined(off) + ".";
  if (!causes.empty()) text += " In the recording: " + causes + ".";
  if (!diagnosis.residual.empty()) text += " Left over: " + diagnosis.residual + ".";
  if (diagnosis.next_step) text += " Next: " + words(*diagnosis.next_step, diagnosis.rig.rig.kind) + ".";
  return text;
}

std::string words(const RecordingFault& fault) {
  if (!fault.text.empty()) return fault.text;
  std::string text = named(fault);
  const char* separator = ": ";
  for (const auto& [parameter, value] : fault.parameters) {
    const bool exact = !(value.upper > value.lower);
    text += separator + parameter + " " + (exact ? figure_text(value.value, 5) : with_interval(value, ""));
    separator = ", ";
  }
  if (fault.name == "drift") {
    const double change = fault.parameters.at("per_cent_over_record").value;
    text += std::string(change < 0.0 ? ", fades by " : ", grows by ") + figure_text(std::abs(change), 2) +
            " % over the record";
  }
  if (fault.is_cause) text += ", confidence " + confidence_text(fault.confidence);
  return text;
}

std::string report_html(const Diagnosis& diagnosis, const firmware::RigDescription& given) {
  Report page("Diagnosis of " + given.source,
              "Measured recordings held against the model of a " + std::string(model::name(given.rig.kind)) + " rig.");
  page.add_verdict(diagnosis.verdict == Verdict::unexplained || diagnosis.verdict == Verdict::ambiguous
                       ? report::Verdict::bad
                       : report::Verdict::good,
                   sentence(diagnosis));
  for (const std::string& objection : diagnosis.certificates) page.add_text("Calibration: " + objection + ".");
  add_gaps(page, diagnosis);
  add_overlays(page, diagnosis);
  add_parameters_off(page, diagnosis);
  add_recording_faults(page, diagnosis);
  add_effects(page, diagnosis);
  add_laws(page, diagnosis.laws);
  add_described_curves(page, diagnosis.described_curves);
  add_where(page, diagnosis);
  if (!diagnosis.parameters.empty()) {
    page.add_section("Tolerated parameters, refitted");
    Table table{"", {"parameter", "given", "refitted", "95 % from", "to"}, {}, 1};
    model::RigParameters<double> rig = given.rig;
    for (const auto& [path, value] : diagnosis.parameters) {
      const double* const before = firmware::find_parameter(rig, path);
      table.rows.push_back({path, before != nullptr ? figure_text(*before, 5) : "–", figure_text(value.value, 5),
                            figure_text(value.lower, 5), figure_text(value.upper, 5)});
    }
    page.add_table(table);
  }
  add_budgets(page, diagnosis);
  for (const Undetermined& open : diagnosis.undetermined) {
    page.add_text("Not determined: " + open.combination + "; " + open.why + ".");
  }
  for (const std::string& remark : diagnosis.remarks) page.add_text(remark + ".");
  page.add_appendix("Rig description with what was found", edited_rig(given, diagnosis.rig));
  return page.html();
}

std::string result_rig(const firmware::RigDescription& found, const firmware::RigDescription& given,
                       std::string_view name) {
  require_finite(found);
  return std::string(result_rig_mark) + ": " + firmware::one_line(name) + " with what was found\n" +
         edited_rig(given, found);
}

std::string explanation(const firmware::CatalogueEntry& entry) {
  std::string text = std::string(entry.name) + "\n  acts on    " + std::string(model::name(entry.subsystem)) +
                     "\n  equation   " + std::string(entry.equation) + "\n  shows as   " + std::string(entry.shows) +
                     "\n";
  for (const model::EffectParameter& p : entry.parameters) {
    text += "  " + std::string(p.name) + " [" + std::string(p.unit) + "], " + figure_text(p.lower, 3) + " to " +
            figure_text(p.upper, 3) + "\n";
  }
  text += "  rigs      ";
  for (std::size_t kind = 0; kind < model::rig_kind_names.size(); ++kind) {
    if (entry.rigs.contains(static_cast<model::RigKind>(kind))) text += " " + std::string(model::rig_kind_names[kind]);
  }
  if (entry.needs_fdva) text += ", with an FDVA";
  if (entry.needs_air_spring) text += ", with an air spring";
  return text + "\n";
}

}  // namespace host_sim::identification
