#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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
  std::string text = "kind = \"" + name_of(truth.kind) + "\"\nsample_rate = " + toml(truth.sample_rate) + "\n";
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
  text += "\n[tolerance]\n";
  for (const auto& [path, value] : truth.tolerance) text += "\"" + path + "\" = " + toml(value) + "\n";
  text += "\n[noise]\n";
  for (const auto& [channel, value] : truth.noise) text += channel + " = " + toml(value) + "\n";
  if (!truth.range.empty()) text += "\n[range]\n";
  for (const auto& [channel, limits] : truth.range)
    text += channel + " = [" + toml(limits.first) + ", " + toml(limits.second) + "]\n";
  return text;
}

std::string csv(const Truth& truth, const Record& record) {
  std::string text = "t";
  std::vector<const std::vector<double>*> columns;
  for (const std::string& channel : channels_of(truth.kind)) {
    text += "," + channel;
    if (truth.units_in_header) text += " [" + unit_of(channel) + "]";
    columns.push_back(&record.channels.at(channel));
  }
  text += "\n";
  for (std::size_t i = 0; i < record.time.size(); ++i) {
    text += digits(truth.sample_rate > 1000.0 ? "%.4f" : "%.3f", record.time[i]);
    for (const std::vector<double>* column : columns) text += digits(",%.9g", (*column)[i]);
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
  if (!truth.unknown.empty()) {
    out["unknown"] = {{"what", truth.unknown}, {"spec", truth.unknown_parameters}};
    if (!truth.unknown_channel.empty()) out["unknown"]["channel"] = truth.unknown_channel;
  }
  return out.dump(1) + "\n";
}

}  // namespace truth
