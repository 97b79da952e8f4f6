#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/truth/random.hpp"
#include "tests/truth/truth.hpp"

namespace truth {
namespace {

std::string digits(const char* format, double value) {
  std::array<char, 64> text{};
  (void)std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// A TOML float: shortest of 15 digits, always with a point or an exponent.
std::string toml(double value) {
  std::string text = digits("%.15g", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string unit_of(const std::string& channel) {
  if (channel[0] == 'F') return "N";
  return channel.starts_with("zdd") ? "m/s²" : "m";
}

/// Rows that are not written, and cells that are none: 1 + the column, 0 nowhere.
struct Holes {
  std::vector<bool> lost;
  std::vector<std::size_t> cell;
};

Holes holes_of(const Truth& truth, std::size_t rows, std::size_t columns) {
  const Rough& rough = truth.rough;
  Holes holes{std::vector<bool>(rows), std::vector<std::size_t>(rows)};
  Random random(truth.records.front().noise_seed + 104729);
  const auto any = [&](double share) { return std::ceil(share * static_cast<double>(rows)); };
  for (int i = 0; i < static_cast<int>(any(rough.not_a_number)); ++i)
    holes.cell[static_cast<std::size_t>(random.below(static_cast<int>(rows)))] =
        1 + static_cast<std::size_t>(random.below(static_cast<int>(columns)));
  for (int i = 0; i < static_cast<int>(any(rough.lost)); ++i)
    holes.lost[1 + static_cast<std::size_t>(random.below(static_cast<int>(rows) - 2))] = true;
  for (int i = 0; i < rough.gaps; ++i) {
    const auto length = static_cast<std::size_t>(any(rough.gap_share / rough.gaps));
    const auto part = rows / static_cast<std::size_t>(rough.gaps);
    const std::size_t begin = static_cast<std::size_t>(i) * part + part / 4 +
                              static_cast<std::size_t>(random.below(static_cast<int>(part / 2)));
    for (std::size_t k = begin; k < std::min(begin + length, rows - 1); ++k) holes.lost[k] = true;
  }
  return holes;
}

/// The rough conditions, with the keys of the rough samples where they have one.
void add_rough(const Truth& truth, nlohmann::ordered_json& out) {
  const Rough& rough = truth.rough;
  if (rough.condition.empty()) return;
  out["condition"] = rough.condition;
  out["declared"] = rough.declared;
  out["noise_absent"] = rough.noise_absent;
  out["tolerance_absent"] = rough.tolerance_absent;
  out["off"] = rough.off;
  out["missing"] = rough.missing;
  out["sample_rate"] = truth.sample_rate;
  out["described_rate"] = rough.described_rate;
  out["drift"] = rough.drift;
  out["holes"] = {
      {"nan", rough.not_a_number}, {"lost", rough.lost}, {"gaps", rough.gaps}, {"gap_share", rough.gap_share}};
  out["recorder"] = nlohmann::ordered_json::object();
  for (const auto& [channel, r] : rough.recorder)
    out["recorder"][channel] = {{"corner", r.corner},  {"order", r.order}, {"digital", r.digital},
                                {"late", r.late},      {"drift", r.drift}, {"hum", r.hum},
                                {"hum_hz", r.hum_hz},  {"step", r.step},   {"outliers", r.outliers},
                                {"outlier", r.outlier}};
  out["events"] = nlohmann::ordered_json::array();
  for (const Event& e : rough.events)
    out["events"].push_back({{"where", e.where}, {"from", e.from}, {"to", e.to}, {"force", e.force}});
  out["faults"] = nlohmann::ordered_json::array();
  for (const Fault& f : rough.faults)
    out["faults"].push_back({{"names", f.names}, {"channels", f.channels}, {"parameters", f.parameters}});
}

}  // namespace

std::string name_of(Kind kind) {
  if (kind == Kind::quarter_car) return "quarter_car";
  return kind == Kind::hil ? "hil" : "component_bench";
}

const std::vector<std::string>& channels_of(Kind kind) {
  static const std::vector<std::string> car{"z_r", "zdd_r", "zdd_w", "zdd_b", "F_w", "dz_w", "dz_b"};
  static const std::vector<std::string> hil{"z_r", "z_w", "z_b", "zdd_w", "zdd_b", "F_w", "x_cmd", "x_act", "F"};
  static const std::vector<std::string> bench{"x_cmd", "x_act", "F"};
  if (kind == Kind::quarter_car) return car;
  return kind == Kind::hil ? hil : bench;
}

std::string rig_toml(const Truth& truth) {
  const Rough& rough = truth.rough;
  const double rate = rough.described_rate > 0.0 ? rough.described_rate : truth.sample_rate;
  std::string text = "kind = \"" + name_of(truth.kind) + "\"\nsample_rate = " + toml(rate) + "\n";
  for (const char* table : {"body", "wheel", "tyre", "suspension", "machine", "fdva"}) {
    const std::string begin = std::string(table) + ".";
    bool opened = false;
    for (const auto& [path, value] : truth.nominal) {
      if (!path.starts_with(begin)) continue;
      if (!opened) text += "\n[" + std::string(table) + "]\n";
      opened = true;
      const bool count = path.ends_with("ducts");
      text += path.substr(begin.size()) + " = " + (count ? digits("%.0f", value) : toml(value)) + "\n";
    }
  }
  if (!rough.tolerance_absent) {
    text += "\n[tolerance]\n";
    for (const auto& [path, value] : truth.tolerance) text += "\"" + path + "\" = " + toml(value) + "\n";
  }
  if (!rough.noise_absent) {
    text += "\n[noise]\n";
    for (const auto& [channel, value] : truth.noise) {
      const auto factor = rough.declared.find(channel);
      text += channel + " = " + toml(factor == rough.declared.end() ? value : value * factor->second) + "\n";
    }
  }
  if (!truth.range.empty()) text += "\n[range]\n";
  for (const auto& [channel, limits] : truth.range)
    text += channel + " = [" + toml(limits.first) + ", " + toml(limits.second) + "]\n";
  return text;
}

std::string csv(const Truth& truth, const Record& record) {
  std::string text = "t";
  std::vector<const std::vector<double>*> columns;
  for (const std::string& channel : recorded_channels(truth)) {
    text += "," + channel;
    if (truth.units_in_header) text += " [" + unit_of(channel) + "]";
    columns.push_back(&record.channels.at(channel));
  }
  text += "\n";
  const int decimals = truth.rough.stamp_decimals;
  const std::string stamp =
      decimals < 0 ? (truth.sample_rate > 1000.0 ? "%.4f" : "%.3f") : digits("%%.%.0ff", decimals);
  const Holes holes = holes_of(truth, record.time.size(), columns.size());
  for (std::size_t i = 0; i < record.time.size(); ++i) {
    if (holes.lost[i]) continue;
    text += digits(stamp.c_str(), record.time[i]);
    for (std::size_t c = 0; c < columns.size(); ++c)
      text += holes.cell[i] == c + 1 ? ",nan" : digits(",%.9g", (*columns[c])[i]);
    text += "\n";
  }
  return text;
}

std::string truth_json(const Truth& truth) {
  nlohmann::ordered_json out;
  out["id"] = truth.id;
  out["group"] = truth.group;
  out["kind"] = name_of(truth.kind);
  out["component"] = truth.fdva ? "fdva" : "linear";
  out["effects"] = nlohmann::ordered_json::array();
  for (const Effect& effect : truth.effects) {
    nlohmann::ordered_json one{{"name", effect.name}, {"parameters", effect.parameters}};
    if (effect.parameters.empty()) one["parameters"] = nlohmann::ordered_json::object();
    if (!effect.channel.empty()) one["channel"] = effect.channel;
    out["effects"].push_back(one);
  }
  out["nominal"] = truth.nominal;
  out["true"] = truth.actual;
  out["tolerance"] = truth.tolerance;
  out["noise"] = truth.noise;
  out["size"] = truth.size;
  out["lag_takes_noise"] = truth.lag_takes_noise;
  out["style"] = truth.units_in_header ? "units" : "plain";
  out["records"] = nlohmann::ordered_json::array();
  out["files"] = nlohmann::ordered_json::array();
  int number = 0;
  for (const RecordPlan& plan : truth.records) {
    nlohmann::ordered_json one{{"dur", plan.duration},
                               {"warm", plan.warm},
                               {"road_seed", plan.road_seed},
                               {"noise_seed", plan.noise_seed},
                               {"t0", plan.start}};
    if (!plan.form.empty()) one["form"] = plan.form;
    if (plan.corner > 0.0) one["corner"] = plan.corner;
    if (plan.cut > 0.0) one["cut"] = plan.cut;
    if (truth.kind == Kind::component_bench) {
      one["bench_rms"] = plan.level;
      one["mod_depth"] = plan.modulation_depth;
      one["mod_period"] = plan.modulation_period;
      one["mod_phase"] = plan.modulation_phase;
    } else {
      one["road_scale"] = plan.level;
    }
    out["records"].push_back(one);
    out["files"].push_back("rec" + std::to_string(++number) + ".csv");
  }
  add_rough(truth, out);
  if (!truth.unknown.empty()) {
    out["unknown"] = {{"what", truth.unknown}, {"spec", truth.unknown_parameters}};
    if (!truth.unknown_channel.empty()) out["unknown"]["channel"] = truth.unknown_channel;
  }
  return out.dump(1) + "\n";
}

}  // namespace truth
