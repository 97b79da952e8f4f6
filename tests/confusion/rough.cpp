#include "tests/confusion/rough.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "tests/confusion/table.hpp"
#include "tests/confusion/text.hpp"

namespace confusion {
namespace {

using host_sim::identification::Diagnosis;
using host_sim::identification::Interval;
using host_sim::identification::ParameterOff;
using host_sim::identification::RecordingFault;

constexpr double sure = 0.5;
/// [1] by which a number of a fault may be off: it is named, not measured, here.
constexpr double fault_tolerance = 0.3;
/// [s] by which begin and end of an event may be off.
constexpr double event_tolerance = 0.5;

bool holds(const std::vector<std::string>& list, const std::string& word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

bool number_agrees(const std::string& key, const Interval& found, double truth) {
  if (found.lower <= truth && truth <= found.upper) return true;
  if (key == "from_s" || key == "to_s") return std::abs(found.value - truth) <= event_tolerance;
  // Which of two clocks is late is a matter of words.
  const bool either_sign = key == "seconds" || key == "ppm";
  const double value = either_sign ? std::abs(found.value) : found.value;
  return std::abs(value - truth) <= fault_tolerance * std::abs(truth);
}

bool is_named(const truth::Fault& fault, const RecordingFault& found) {
  if (found.confidence <= sure || !holds(fault.names, found.name)) return false;
  // A clock of some channels is the clock of the others the other way round.
  const bool of_group = found.name.starts_with("clock");
  bool shared = fault.channels.empty() || found.channels.empty() || of_group;
  for (const model::Channel channel : found.channels)
    shared = shared || holds(fault.channels, std::string(model::name(channel)));
  if (!shared) return false;
  return std::all_of(fault.parameters.begin(), fault.parameters.end(), [&](const auto& number) {
    const auto it = found.parameters.find(number.first);
    return it == found.parameters.end() || number_agrees(number.first, it->second, number.second);
  });
}

/// A fault that is sure of itself and is none of those of the recording. Level and colour of noise are never wrong by
/// themselves: they are estimates.
bool is_invented(const RecordingFault& found, const truth::Truth& truth) {
  if (found.confidence <= sure || found.name.starts_with("noise_")) return false;
  if (found.name == "quantisation" || found.name == "outliers" || found.name == "gap" || found.name == "lost_rows")
    return false;  // counted, not inferred
  return std::none_of(truth.rough.faults.begin(), truth.rough.faults.end(), [&](const truth::Fault& fault) {
    const bool clock = found.name.starts_with("clock");
    return std::any_of(fault.names.begin(), fault.names.end(), [&](const std::string& name) {
      return name == found.name || (clock && name.starts_with("clock"));
    });
  });
}

/// A rise of the described damping is the effect viscous_damping as well: the same equation.
bool is_same_thing(const truth::Truth& truth, const std::string& effect) {
  return effect == "viscous_damping" && holds(truth.rough.off, "suspension.damping") &&
         truth.actual.at("suspension.damping") > truth.nominal.at("suspension.damping");
}

bool unseen_counts(const std::string& condition) {
  return condition == "drift" || condition == "events" || condition == "neighbour_laws";
}

/// Names of the catalogue for what hides outside the generator's own effects (1 or 0).
std::size_t outside_named(const Outcome& o, const truth::Truth& truth) {
  return static_cast<std::size_t>(std::count_if(o.named.begin(), o.named.end(), [&](const Named& named) {
    return named.right && named.effect == name_in_catalogue(truth);
  }));
}

bool is_right(const Outcome& o, const truth::Truth& truth) {
  if (o.wrong_rough) return false;
  const bool all_effects = o.effects_found() - outside_named(o, truth) == o.effects_hidden;
  const bool all_parameters = o.off_found == o.off_hidden;
  if (!all_effects || !all_parameters) return false;
  // What stands beside the catalogue must at least be seen.
  if (unseen_counts(truth.rough.condition)) {
    const bool said = o.faults_hidden > 0 && o.faults_found == o.faults_hidden;
    return o.flagged() || said || o.outside_said;
  }
  if (o.named.size() != o.effects_hidden + o.same_thing) return false;
  if (o.effects_hidden + o.off_hidden > 0) return o.verdict == "named" || o.verdict == "ambiguous";
  return o.verdict == "no_discrepancy" || (o.verdict == "named" && o.faults_hidden > 0);
}

struct Line {
  Share right, wrong_name, false_alarm, faults, intervals;
  double processor = 0.0;

  void add(const Outcome& o) {
    right.add(o.right());
    wrong_name.add(o.wrong_rough);
    if (o.effects_hidden + o.off_hidden == 0 && !unseen_counts(o.condition)) {
      const bool unsaid = o.verdict == "ambiguous" || o.verdict == "unexplained" || o.unexplained;
      false_alarm.add(o.failure.empty() && (unsaid || !o.named.empty() || o.wrong_rough));
    }
    faults.add(o.faults_found, o.faults_hidden);
    for (const Estimate& e : o.estimates) intervals.add(e.held);
    processor += o.processor;
  }
};

std::string line_text(const std::string& name, const Line& shares) {
  return written("%-16s", name.c_str()) + per_cent(shares.right) + "  " + per_cent(shares.wrong_name) + "  " +
         per_cent(shares.false_alarm) + "  " + per_cent(shares.faults) + "  " + per_cent(shares.intervals) +
         written("  %7.1f\n", shares.processor);
}

}  // namespace

std::vector<Asked> rough_plan(std::uint64_t seed, std::size_t count, const std::string& condition) {
  std::vector<Asked> all;
  for (const std::string& name : truth::conditions()) {
    if (!condition.empty() && condition != name) continue;
    for (std::size_t k = 0; k < count; ++k) all.push_back({"rough:" + name, 100 * seed + k});
  }
  if (all.empty()) throw std::invalid_argument("no such condition: " + condition);
  return all;
}

void describe_rough(Outcome& o, const truth::Truth& truth) {
  o.condition = truth.rough.condition;
  o.off_hidden = truth.rough.off.size();
  o.faults_hidden = truth.rough.faults.size();
  if (o.hidden == "nothing") o.hidden.clear();
  for (const std::string& path : truth.rough.off)
    o.hidden += (o.hidden.empty() ? "" : " and ") + path +
                written(" %+.1f %%", 100.0 * (truth.actual.at(path) / truth.nominal.at(path) - 1.0));
  for (const truth::Fault& fault : truth.rough.faults) {
    o.hidden += (o.hidden.empty() ? "(" : " (") + fault.names.front();
    for (const std::string& channel : fault.channels) o.hidden += " " + channel;
    for (const auto& [key, value] : fault.parameters) o.hidden += " " + key + written("=%.3g", value);
    o.hidden += ")";
  }
  if (o.hidden.empty()) o.hidden = "nothing";
}

void judge_rough(Outcome& o, const truth::Truth& truth, const Diagnosis& diagnosis) {
  describe_rough(o, truth);
  o.wrong_rough = false;
  for (const Named& named : o.named) {
    if (is_same_thing(truth, named.effect)) {
      o.off_found = o.same_thing = 1;
      continue;
    }
    o.wrong_rough = o.wrong_rough || (!named.right && named.confidence > sure);
  }
  for (const ParameterOff& off : diagnosis.parameters_off) {
    const bool hidden = holds(truth.rough.off, off.path);
    if (hidden && off.confidence > sure) o.off_found = 1;
    if (!hidden && off.confidence > sure) o.wrong_rough = true;
    o.found += " and " + off.path +
               written(" %+.1f %% [%.3g]", 100.0 * (off.value.value / off.described - 1.0), off.confidence);
    if (hidden)
      o.estimates.push_back(
          {off.path, true, std::abs(off.value.value / truth.actual.at(off.path) - 1.0),
           off.value.lower <= truth.actual.at(off.path) && truth.actual.at(off.path) <= off.value.upper});
  }
  for (const truth::Fault& fault : truth.rough.faults)
    o.faults_found +=
        static_cast<std::size_t>(std::any_of(diagnosis.recording_faults.begin(), diagnosis.recording_faults.end(),
                                             [&](const RecordingFault& found) { return is_named(fault, found); }));
  for (const RecordingFault& found : diagnosis.recording_faults) {
    o.wrong_rough = o.wrong_rough || is_invented(found, truth);
    o.found += " (" + found.name;
    for (const model::Channel channel : found.channels) o.found += " " + std::string(model::name(channel));
    for (const auto& [key, value] : found.parameters) o.found += " " + key + written("=%.3g", value.value);
    o.found += written(" [%.3g])", found.confidence);
  }
  // A parameter that changes has no value to be held.
  std::erase_if(o.estimates, [&](const Estimate& e) { return truth.rough.drift.contains(e.path); });
  o.rough_right = is_right(o, truth);
}

std::string rough_text(const std::vector<Outcome>& outcomes) {
  std::map<std::string, Line> lines;
  Line all;
  for (const Outcome& o : outcomes) {
    lines[o.asked.group.substr(o.asked.group.find(':') + 1)].add(o);
    all.add(o);
  }
  std::string out = "condition             right   wrong > 0.5  false alarm faults named    intervals     CPU s\n";
  for (const std::string& name : truth::conditions())
    if (lines.contains(name)) out += line_text(name, lines.at(name));
  if (lines.size() > 1) out += line_text("all", all);
  bool first = true;
  for (const Outcome& o : outcomes) {
    if (o.right()) continue;
    if (first) out += "\nnot right\n";
    first = false;
    if (!o.failure.empty()) {
      out += "  " + o.asked.id() + ": " + o.failure + "; hidden " + o.hidden + "\n";
      continue;
    }
    out += "  " + o.asked.id() + ": " + o.verdict + (o.unexplained ? ", rest" : "") + "; found " + o.found +
           "; hidden " + o.hidden + written("; χ²/n %.4g, %.1f s", o.residual_power, o.processor);
    if (o.truth_is_rival) out += "; a rival is the truth";
    if (!o.rest.empty()) out += "; rest: " + o.rest;
    out += "\n";
  }
  return out;
}

}  // namespace confusion
