#include "tests/confusion/table.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/confusion/text.hpp"

namespace confusion {
namespace {

constexpr std::array<double, 3> confidence_edges{0.5, 0.9, 0.99};
constexpr double at_floor = 1.15;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Two blanks, the words, blanks up to column 60: a letter of UTF-8 is one column, however many bytes it has.
std::string padded(const std::string& words) {
  const auto letters = std::count_if(words.begin(), words.end(), [](char c) { return (c & 0xC0) != 0x80; });
  return "  " + words + std::string(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, 58 - letters)), ' ');
}

std::string share_line(const std::string& what, const Share& share, const char* aim) {
  return padded(what) + written("%4zu of %-4zu %6.1f %%   %s\n", share.count, share.of, 100.0 * share.value(), aim);
}

nlohmann::ordered_json to_json(const Share& share) { return {{"count", share.count}, {"of", share.of}}; }

}  // namespace

std::string per_cent(const Share& share) {
  return share.of == 0 ? std::string("       –   ")
                       : written("%3zu/%-3zu %3.0f%%", share.count, share.of, 100.0 * share.value());
}

Table table_of(const std::vector<Outcome>& outcomes) {
  Table table;
  for (const char* what : {"single", "pair", "triple", "none", "unknown"}) table.right[what];
  std::vector<double> errors, tolerated_errors, walls;
  for (const Outcome& o : outcomes) {
    const std::string what = o.asked.what();
    const bool right = o.right(), in_catalogue = what != "none" && what != "unknown";
    table.right[what].add(right);
    if (what == "single") table.singles_found.add(o.effects_found() > 0);
    if (what == "pair") table.pair_effects_found.add(o.effects_found(), o.effects_hidden);
    if (what == "triple") table.triple_effects_found.add(o.effects_found(), o.effects_hidden);
    if (in_catalogue) table.ambiguous.add(o.verdict == "ambiguous");
    if (what == "none") table.false_alarm.add(!right);
    if (what == "unknown") {
      table.unknown_flagged.add(o.flagged() || o.outside_said);
      table.unknown_named.add(o.wrong_name());
    } else {
      table.at_noise_floor.add(o.failure.empty() && o.gap <= at_floor);
    }
    table.wrong_names.add(o.wrong_name());
    if (in_catalogue && right) {
      table.unexplained_beside.add(o.unexplained);
      for (const Estimate& e : o.estimates) {
        (e.effect ? table.intervals : table.tolerated_intervals).add(e.held);
        (e.effect ? errors : tolerated_errors).push_back(e.error);
      }
    }
    for (const Named& n : o.named) {
      const auto bin = std::upper_bound(confidence_edges.begin(), confidence_edges.end(), n.confidence);
      table.calibration[static_cast<std::size_t>(bin - confidence_edges.begin())].add(n.right);
    }
    if (!o.failure.empty()) continue;
    walls.push_back(o.wall);
    table.processor += o.processor;
    if (o.wall > table.worst_wall) {
      table.worst_wall = o.wall;
      table.slowest = o.asked.id();
    }
  }
  table.median_error = median(errors);
  table.tolerated_error = median(tolerated_errors);
  table.median_wall = median(walls);
  return table;
}

std::string text(const Table& t, const std::vector<Outcome>& outcomes) {
  std::string out = written("%zu recordings\n", outcomes.size());
  out += share_line("single effects named right, and nothing else", t.right.at("single"), "to reach 99 %");
  out += share_line("  named, alone or with others", t.singles_found, "");
  out += share_line("pairs: both named right, and nothing else", t.right.at("pair"), "to reach 97 %");
  out += share_line("  effects of pairs named", t.pair_effects_found, "");
  out += share_line("triples: all named right, and nothing else", t.right.at("triple"), "");
  out += share_line("  effects of triples named", t.triple_effects_found, "");
  out += share_line("verdicts ambiguous, of those three", t.ambiguous, "");
  out += share_line("false alarms where nothing is", t.false_alarm, "at most 1 %");
  out += share_line("outside the catalogue: flagged or named as fault", t.unknown_flagged, "to reach 97 %");
  out += share_line("  a name above 0.5 all the same", t.unknown_named, "none");
  out += share_line("  flagged and no such name", t.right.at("unknown"), "");
  out += share_line("a wrong name above 0.5, of all recordings", t.wrong_names, "");
  out += share_line("a rest seen beside a right answer", t.unexplained_beside, "at most 10 %");
  out += share_line("after ≤ 1.15 × noise floor, catalogue and none", t.at_noise_floor, "to reach 97 %");
  out += share_line("95 % intervals that hold the truth, effects", t.intervals, "90 … 98 %");
  out += share_line("  tolerated parameters", t.tolerated_intervals, "");
  out +=
      padded("median error of effects' parameters") + written("%18.3f %%   at most 0.5 %%\n", 100.0 * t.median_error);
  out += padded("  of tolerated parameters") + written("%18.3f %%\n", 100.0 * t.tolerated_error);
  Share confident = t.calibration[2];
  confident.count += t.calibration[3].count;
  confident.of += t.calibration[3].of;
  out += share_line("effects named with 0.9 … 1: in the rig", confident, "to reach 90 %");
  for (std::size_t b = 0; b < t.calibration.size(); ++b) {
    const double low = b == 0 ? 0.0 : confidence_edges[b - 1], high = b == 3 ? 1.0 : confidence_edges[b];
    out += share_line(written("  with %.2g … %.2g", low, high), t.calibration[b], "");
  }
  out += written("  time: median %.2f s, worst %.1f s (%s); processor %.0f s in all\n", t.median_wall, t.worst_wall,
                 t.slowest.c_str(), t.processor);
  const auto details = [&](const char* title, const auto& holds) {
    bool first = true;
    for (const Outcome& o : outcomes) {
      if (!holds(o)) continue;
      if (first) out += written("\n%s\n", title);
      first = false;
      if (!o.failure.empty()) {
        out += written("  %s: %s\n", o.asked.id().c_str(), o.failure.c_str());
        continue;
      }
      out += "  " + o.asked.id() + ": " + o.verdict + (o.unexplained ? ", rest" : "") + "; found " + o.found +
             "; hidden " + o.hidden;
      out += written(" (%.3g × noise); χ²/n %.4g", o.size, o.residual_power);
      if (o.gap > at_floor) out += written("; after %.3g × floor in %s", o.gap, o.gap_channel.c_str());
      if (o.truth_is_rival) out += "; a rival is the truth";
      if (!o.rest.empty()) out += "; rest: " + o.rest;
      out += "\n";
    }
  };
  details("not right", [](const Outcome& o) { return !o.right(); });
  const auto right_in_catalogue = [](const Outcome& o) { return o.right() && o.asked.what() != "unknown"; };
  details("right, with a rest beside", [&](const Outcome& o) { return right_in_catalogue(o) && o.unexplained; });
  details("right, above the noise floor", [&](const Outcome& o) { return right_in_catalogue(o) && o.gap > at_floor; });
  bool first = true;
  for (const Outcome& o : outcomes) {
    for (const Estimate& e : o.estimates) {
      if (!o.right() || !e.effect || (e.held && e.error <= 0.05)) continue;
      if (first) out += "\nparameters outside their interval, or 5 % off\n";
      first = false;
      out += written("  %s: %s %.3g %%%s\n", o.asked.id().c_str(), e.path.c_str(), 100.0 * e.error,
                     e.held ? "" : ", outside");
    }
  }
  return out;
}

nlohmann::ordered_json to_json(const Table& t) {
  nlohmann::ordered_json json;
  for (const auto& [what, share] : t.right) json["right"][what] = to_json(share);
  json["singles_found"] = to_json(t.singles_found);
  json["pair_effects_found"] = to_json(t.pair_effects_found);
  json["triple_effects_found"] = to_json(t.triple_effects_found);
  json["ambiguous"] = to_json(t.ambiguous);
  json["false_alarm"] = to_json(t.false_alarm);
  json["unknown_flagged"] = to_json(t.unknown_flagged);
  json["unknown_named"] = to_json(t.unknown_named);
  json["wrong_names"] = to_json(t.wrong_names);
  json["unexplained_beside"] = to_json(t.unexplained_beside);
  json["at_noise_floor"] = to_json(t.at_noise_floor);
  json["intervals"] = to_json(t.intervals);
  json["tolerated_intervals"] = to_json(t.tolerated_intervals);
  json["median_error"] = t.median_error;
  json["tolerated_error"] = t.tolerated_error;
  json["calibration"] = nlohmann::ordered_json::array();
  for (const Share& share : t.calibration) json["calibration"].push_back(to_json(share));
  json["median_wall"] = t.median_wall;
  json["worst_wall"] = t.worst_wall;
  json["slowest"] = t.slowest;
  json["processor"] = t.processor;
  return json;
}

}  // namespace confusion
