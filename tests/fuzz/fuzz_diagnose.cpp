// Finite or nothing: `rigtwin diagnose` on any small rig and any short recording ends with one line, or with a verdict,
// a page and a rig description in which every number is finite.
//
// The bytes choose: a kind of rig, values of its description, tolerances, noise and effects; the values of the rig that
// is recorded; and what happens to the recording: cells without a number, huge numbers, a channel that stands still,
// columns swapped or scaled, rows lost, a spike, a growing tone. No byte: an ordinary rig and its own recording.
#include <unistd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/commands/diagnose_command.hpp"

namespace {

namespace fs = std::filesystem;

void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz_diagnose: %s\n", what.c_str());
  std::abort();
}

void require_one_line(std::string_view line) {
  require(line.find('\n') == std::string_view::npos, "an error of several lines: " + std::string(line));
  require(!line.empty(), "an error without a word");
}

/// The bytes one after the other; zeros after the last.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  unsigned next() { return at_ < size_ ? data_[at_++] : 0U; }
  unsigned below(unsigned count) { return next() % count; }
  bool more() const { return at_ < size_; }
  /// 1 for two bytes of three; else one of the factors that people get wrong, or a number that nobody means.
  double factor() {
    constexpr double factors[] = {1.1, 0.95, 2.0,  0.5,   10.0,  0.1,  1e-3, 1e3,
                                  1e6, 1e-6, 1e12, 1e-12, 1e300, -1.0, 0.0,  1e-300};
    constexpr unsigned ones = 170;
    const unsigned byte = next();
    return byte < ones ? 1.0 : factors[(byte - ones) % std::size(factors)];
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  // TOML tells integers from numbers by their looks.
  const bool plain = std::string_view(text).find_first_of(".en") == std::string_view::npos;
  return std::string(text) + (plain ? ".0" : "");
}

struct Value {
  const char* table;
  const char* key;
  double value;
};

std::vector<Value> values_of(unsigned kind) {
  std::vector<Value> values;
  if (kind != 2) {
    values = {
        {"body", "mass", 290.0}, {"wheel", "mass", 40.0}, {"tyre", "stiffness", 200e3}, {"tyre", "damping", 100.0}};
  }
  values.push_back({"suspension", "stiffness", 31500.0});
  values.push_back({"suspension", "damping", 1140.0});
  if (kind == 1) values.push_back({"machine", "virtual_damping", 1140.0});
  return values;
}

/// An effect as a table of the description, its parameters of any size; "": none.
std::string effect_text(Bytes& bytes) {
  constexpr const char* effects[] = {"[effects.coulomb_friction]\nforce = ",
                                     "[effects.quadratic_damping]\ncoefficient = ",
                                     "[effects.backlash]\ngap = ",
                                     "[effects.actuator_delay]\ndelay = ",
                                     "[effects.actuator_lag]\ntime_constant = ",
                                     "[effects.progressive_spring]\ncubic_stiffness = ",
                                     "[effects.top_mount]\nstiffness = ",
                                     "[effects.sensor_lag.F]\ntime_constant = ",
                                     "[effects.sensor_gain.zdd_b]\ngain = ",
                                     "[effects.body_guide_friction]\nforce = "};
  constexpr double sizes[] = {30.0, 300.0, 2e-3, 8e-3, 3e-3, 1e6, 2e5, 2e-3, 1.2, 30.0};
  const unsigned choice = bytes.below(2 * std::size(effects));
  if (choice < std::size(effects)) return "";
  const std::size_t i = choice - std::size(effects);
  return effects[i] + number(sizes[i] * bytes.factor()) + "\n";
}

constexpr double rates[] = {200.0, 200.0, 100.0, 250.0, 333.0, 1000.0};

/// The description. `exact`: the rig that is recorded, without tolerances and noise.
std::string rig_text(Bytes& bytes, unsigned kind, double rate) {
  constexpr const char* kinds[] = {"quarter_car", "hil", "component_bench"};
  std::string text = std::string("kind = \"") + kinds[kind] + "\"\nsample_rate = " + number(rate) + "\n";
  std::string_view table;
  for (const Value& value : values_of(kind)) {
    if (table != value.table) text += std::string("[") + value.table + "]\n";
    table = value.table;
    text += std::string(value.key) + " = " + number(value.value * bytes.factor()) + "\n";
  }
  return text + effect_text(bytes);
}

std::string declarations(Bytes& bytes, unsigned kind) {
  std::string text = "[tolerance]\n";
  constexpr double tolerances[] = {0.03, 0.0, 0.3, 0.95, 1e-9, 3.0};
  for (const Value& value : values_of(kind)) {
    if (bytes.below(3) != 0) {
      text += std::string("\"") + value.table + "." + value.key + "\" = " + number(tolerances[bytes.below(6)]) + "\n";
    }
  }
  text += "[noise]\n";
  constexpr const char *of_car = "zdd_b", *of_bench = "F";
  if (bytes.below(2) != 0) {
    text +=
        std::string(kind == 0 ? of_car : of_bench) + " = " + number((kind == 0 ? 0.05 : 10.0) * bytes.factor()) + "\n";
  }
  text += "[range]\n";
  if (bytes.below(4) == 3) {
    text += std::string(kind == 0 ? of_car : of_bench) + " = [" + number(-bytes.factor()) + ", 5.0]\n";
  }
  return text;
}

/// A recording as a table of text.
struct Table {
  std::vector<std::vector<double>> columns;
  std::vector<std::string> names;
  [[nodiscard]] std::size_t rows() const { return columns.front().size(); }
};

constexpr double seconds = 3.0;

Table recorded(const firmware::RigDescription& rig, Bytes& bytes) {
  const double rate = rig.sample_rate, level = bytes.factor();
  const auto samples = static_cast<std::size_t>(seconds * rate);
  firmware::FootPointMotion motion(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) / rate;
    for (const double hz : {0.9, 2.3, 5.1, 11.7}) {
      const double w = 2.0 * 3.141592653589793 * hz, a = level * 5e-3 / hz;
      motion[k].position += a * std::sin(w * t);
      motion[k].velocity += a * w * std::cos(w * t);
      motion[k].acceleration -= a * w * w * std::sin(w * t);
    }
  }
  const auto input = firmware::excitation(rig.rig, motion, rate);
  const firmware::Recording run = host_sim::run_closed_loop(rig, input, {}).recording;
  Table table{{run.time}, {"t"}};
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (run.channels[c].empty()) continue;
    table.names.emplace_back(model::name(model::channel_at(c)));
    table.columns.push_back(run.channels[c]);
  }
  return table;
}

void spoil(Bytes& bytes, Table& table) {
  const std::size_t column = 1 + bytes.below(static_cast<unsigned>(table.columns.size()) - 1);
  std::vector<double>& values = table.columns[column];
  const std::size_t at = bytes.next() * values.size() / 256, count = 1 + bytes.below(40);
  const double size = bytes.factor() * 100.0;
  const auto each = [&](const auto& change) {
    for (std::size_t k = at; k < std::min(values.size(), at + count); ++k) change(values[k], k);
  };
  switch (bytes.below(10)) {
    case 0:
      return each([](double& v, std::size_t) { v = NAN; });
    case 1:
      return each([&](double& v, std::size_t) { v = size; });
    case 2:
      return values.assign(values.size(), size);
    case 3:
      return table.names[column].swap(table.names[1 + at % (table.columns.size() - 1)]);
    case 4:
      for (double& v : values) v *= size;
      return;
    case 5:
      values[at] += size;
      return;
    case 6:
      for (std::size_t k = 0; k < values.size(); ++k)
        values[k] += 1e-6 * size * std::exp(0.02 * static_cast<double>(k));
      return;
    case 7:
      for (auto& c : table.columns)
        c.erase(c.begin() + static_cast<std::ptrdiff_t>(at),
                c.begin() + static_cast<std::ptrdiff_t>(std::min(c.size(), at + count)));
      return;
    case 8:
      for (double& v : values) v = size * std::round(v / size);
      return;
    default:
      table.columns[column] = table.columns[0];
      return;
  }
}

std::string csv(const Table& table) {
  std::string text;
  for (std::size_t c = 0; c < table.names.size(); ++c) text += (c == 0 ? "" : ",") + table.names[c];
  text += "\n";
  char cell[40];
  for (std::size_t k = 0; k < table.rows(); ++k) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      std::snprintf(cell, sizeof cell, "%s%.9g", c == 0 ? "" : ",", table.columns[c][k]);
      text += cell;
    }
    text += "\n";
  }
  return text;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

void require_finite(const nlohmann::json& json, const std::string& where) {
  require(!json.is_null(), "null in " + where);
  require(!json.is_number_float() || std::isfinite(json.get<double>()), "no finite number in " + where);
  if (!json.is_structured()) return;
  for (const auto& [key, item] : json.items()) require_finite(item, where + "." + key);
}

void check_results(const fs::path& folder) {
  const auto json = nlohmann::json::parse(text_of(folder / "verdict.json"), nullptr, false);
  require(!json.is_discarded(), "verdict.json is no JSON");
  require_finite(json, "verdict");
  for (const char* key : {"verdict", "where", "effects", "gap", "parameters", "unexplained", "parameters_off",
                          "recording", "laws", "undetermined"}) {
    require(json.contains(key), std::string("verdict.json lacks ") + key);
  }
  for (const auto& effect : json["effects"]) {
    require(effect["confidence"] >= 0.0 && effect["confidence"] <= 1.0, "a confidence beyond 0 … 1");
  }
  require(text_of(folder / "report.html").ends_with("</html>\n"), "report.html is cut off");
  (void)firmware::read_rig(folder / "rig.toml");  // every other command takes it
}

const fs::path& folder() {
  static const fs::path path = [] {
    std::string name = (fs::temp_directory_path() / "rigtwin_fuzz_XXXXXX").string();
    require(::mkdtemp(name.data()) != nullptr, "no folder for files");
    return fs::path(name);
  }();
  return path;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const unsigned kind = bytes.below(3);
  const double rate = rates[bytes.below(std::size(rates))];
  const fs::path rig = folder() / "rig.toml", recording = folder() / "rec.csv", out = folder() / "out";
  fs::remove_all(out);
  try {
    Bytes none(nullptr, 0);
    const bool as_described = bytes.below(2) == 0;
    const std::string truth = as_described ? rig_text(none, kind, rate) : rig_text(bytes, kind, rate);
    Table table = recorded(firmware::parse_rig(truth, "truth.toml"), bytes);
    if (table.columns.size() < 2 || table.rows() == 0) return 0;  // the firmware did not begin
    for (unsigned faults = bytes.below(4); faults > 0 && table.rows() > 0; --faults) spoil(bytes, table);
    std::ofstream(recording) << csv(table);
    std::ofstream(rig) << rig_text(bytes, kind, rate) << declarations(bytes, kind);
  } catch (const firmware::InputError& error) {
    require_one_line(error.what());  // such a rig cannot be recorded
    return 0;
  }
  try {
    host_sim::run_diagnosis({.rig = rig, .out = out, .data = {recording}, .holdout = {}, .explain = ""});
  } catch (const firmware::InputError& error) {
    require_one_line(error.what());
    require(!fs::exists(out) || fs::is_empty(out), "files beside an error");
    return 0;
  }
  check_results(out);
  return 0;
}
