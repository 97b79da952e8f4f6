#include "host_sim/sweep/sweep_plan.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/description/text/small_text.hpp"
#include "firmware/description/version.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "firmware/simulation/road.hpp"
#include "firmware/simulation/road_choice.hpp"

namespace host_sim::sweep {
namespace {

constexpr std::string_view standard_road = "iso8608:";
constexpr std::uint32_t draw_stream = 2;  // of the case's seed; 0 and 1 are road and sensor noise

/// Reads one plan from its TOML table.
class PlanReader {
 public:
  PlanReader(const toml::table& top, std::string_view source)
      : top_(top, "", source), folder_(std::filesystem::path(source).parent_path()) {}

  [[nodiscard]] SweepPlan read() {
    plan_.rig_file = folder_ / top_.text("rig");
    plan_.rig = firmware::read_rig(plan_.rig_file);
    firmware::refuse_compensation(plan_.rig, "sweep");
    if (top_.has("seed")) plan_.seed = whole("seed", 0, most_cases);
    if (top_.has("repeats")) plan_.repeats = whole("repeats", 1, most_cases);
    if (auto run = top_.table("run")) read_run(*run);
    if (auto vary = top_.table("vary")) read_factors(*vary);
    if (auto draw = top_.table("draw")) read_draws(*draw);
    top_.finish();
    count_cases();
    plan_.cases.fingerprint = fingerprint();
    return std::move(plan_);
  }

 private:
  [[nodiscard]] std::uint64_t whole(std::string_view key, std::uint64_t lowest, std::uint64_t highest) {
    const auto value = firmware::as_whole(top_.need(key, "a whole number"));
    if (!value || *value < 0 || static_cast<std::uint64_t>(*value) < lowest ||
        static_cast<std::uint64_t>(*value) > highest) {
      top_.fail(key, std::string(key) + " is out of range",
                "a whole number, " + std::to_string(lowest) + " to " + std::to_string(highest));
    }
    return static_cast<std::uint64_t>(*value);
  }

  void read_run(firmware::DescriptionTable& run) {
    if (run.has("road")) plan_.road = road_in(run, *run.raw().get("road"), run.text("road"));
    run.number_in("speed", plan_.speed, 0.1, 150.0, "a speed in m/s");
    run.number_in("duration", plan_.duration, 1e-3, 1e6, "the length of a run in s");
    if (run.has("noise")) plan_.noise = run.truth("noise");
    run.finish();
    if (plan_.duration * plan_.rig.sample_rate > 1e7) {
      run.fail("duration", "run.duration is longer than ten million samples", "a shorter run");
    }
  }

  /// The road as case and command know it; a file is beside the plan.
  [[nodiscard]] std::string road_in(const firmware::DescriptionTable& table, const toml::node& node,
                                    const std::string& text) const {
    if (text.starts_with(standard_road)) {
      try {
        static_cast<void>(firmware::class_roughness(std::string_view(text).substr(standard_road.size())));
      } catch (const firmware::UsageError&) {
        table.fail(node, "unknown road " + firmware::in_quotes(text), "iso8608:A to iso8608:H, or a file");
      }
      return text;
    }
    const std::filesystem::path file = folder_ / text;  // an absolute one stays
    if (!std::ifstream(file)) {
      table.fail(node, "the road " + firmware::in_quotes(text) + " cannot be opened", "iso8608:A to H, or a file");
    }
    return file.string();
  }

  /// Whether a case can set a number of this name to this value.
  [[nodiscard]] bool can_set(std::string_view name) {
    if (name == "speed") return true;
    if (name == "open_ducts") return plan_.rig.rig.has_fdva;
    return firmware::find_parameter(plan_.rig.rig, name) != nullptr;
  }

  void demand_name(const firmware::DescriptionTable& table, const toml::node& node, const std::string& name) {
    if (name == "road" || can_set(name)) {
      const auto same = [&](const auto& other) { return other.name == name; };
      if (std::any_of(plan_.factors.begin(), plan_.factors.end(), same)) {
        table.fail(node, name + " stands in [vary] already", "each name once");
      }
      return;
    }
    std::vector<std::string_view> known{"road", "speed"};
    if (plan_.rig.rig.has_fdva) known.emplace_back("open_ducts");
    std::vector<std::string> paths;
    for (const auto& p : firmware::parameter_paths()) {
      if (firmware::has_part(plan_.rig.rig, p.table)) paths.push_back(std::string(p.table) + "." + std::string(p.key));
    }
    known.insert(known.end(), paths.begin(), paths.end());
    table.fail(node, firmware::with_suggestion("no parameter of this rig", name, known),
               "road, speed, open_ducts or a parameter such as \"suspension.damping\"");
  }

  void demand_value(const firmware::DescriptionTable& table, const toml::node& node, const std::string& name,
                    double value) const {
    const bool fits = name == "speed" ? value >= 0.1 && value <= 150.0
                      : name == "open_ducts"
                          ? value >= 0.0 && value <= plan_.rig.rig.fdva.ducts && value == std::floor(value)
                          : std::isfinite(value);
    if (fits) return;
    table.fail(node, name + " = " + firmware::shortest(value) + " does not fit",
               name == "speed"        ? "a speed from 0.1 to 150 m/s"
               : name == "open_ducts" ? "a whole number from 0 to " + std::to_string(plan_.rig.rig.fdva.ducts)
                                      : "a finite number");
  }

  /// Walks over names: "suspension.damping" = …, or [vary.suspension] damping = …
  template <class Take>
  void for_each_name(const toml::table& table, const std::string& prefix, const Take& take) {
    for (const auto& [key, node] : table) {
      const std::string name = prefix + std::string(key.str());
      const auto* inner = node.as_table();
      if (inner != nullptr && !inner->contains("from") && !inner->contains("mean")) {
        for_each_name(*inner, name + ".", take);
      } else {
        take(name, node);
      }
    }
  }

  void read_factors(firmware::DescriptionTable& vary) {
    // toml++ sorts its tables by name; the order of the file is that of the lines.
    std::vector<std::pair<std::string, const toml::node*>> entries;
    for_each_name(vary.raw(), "",
                  [&](const std::string& name, const toml::node& node) { entries.emplace_back(name, &node); });
    std::stable_sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) {
      const auto &x = a.second->source().begin, &y = b.second->source().begin;
      return x.line != y.line ? x.line < y.line : x.column < y.column;
    });
    for (const auto& [name, node] : entries) {
      demand_name(vary, *node, name);
      plan_.factors.push_back({name, values_of(vary, name, *node)});
    }
  }

  [[nodiscard]] std::vector<Setting> values_of(const firmware::DescriptionTable& vary, const std::string& name,
                                               const toml::node& node) {
    std::vector<Setting> values;
    if (const auto* range = node.as_table(); range != nullptr && name != "road") {
      firmware::DescriptionTable table(*range, "vary." + name, vary.source());
      const double from = table.number("from"), to = table.number("to");
      const int steps = table.whole_in("steps", 2, 1'000'000);
      table.finish();
      for (int i = 0; i < steps; ++i) {
        values.emplace_back(i + 1 == steps ? to : from + (to - from) * i / (steps - 1));
        demand_value(vary, node, name, std::get<double>(values.back()));
      }
      return values;
    }
    const auto* list = node.as_array();
    if (list == nullptr || list->empty()) {
      vary.fail(node, "vary." + name + " is no list of values",
                "[800.0, 1140.0], or { from = 800, to = 2000, steps = 7 }");
    }
    for (const toml::node& entry : *list) {
      const auto number = firmware::as_number(entry);
      if (name == "road" && entry.is_string()) {
        values.emplace_back(road_in(vary, entry, *entry.value<std::string>()));
      } else if (name != "road" && number) {
        demand_value(vary, entry, name, *number);
        values.emplace_back(*number);
      } else {
        vary.fail(entry, "vary." + name + " holds something else", name == "road" ? "roads in quotes" : "numbers");
      }
    }
    return values;
  }

  void read_draws(firmware::DescriptionTable& draw) {
    if (draw.has("within_tolerance") && draw.truth("within_tolerance")) {
      for (const auto& [path, tolerance] : plan_.rig.tolerance) {
        const double value = *firmware::find_parameter(plan_.rig.rig, path);
        plan_.draws.push_back({path, false, value * (1.0 - tolerance), value * (1.0 + tolerance)});
      }
    }
    for_each_name(draw.raw(), "", [&](const std::string& name, const toml::node& node) {
      if (name == "within_tolerance") return;
      demand_name(draw, node, name);
      const auto* inner = node.as_table();
      if (name == "road" || name == "open_ducts" || inner == nullptr) {
        draw.fail(node, "draw." + name + " is no distribution of a number",
                  "{ from = 280.0, to = 300.0 } or { mean = 290.0, standard_deviation = 3.0 }");
      }
      firmware::DescriptionTable table(*inner, "draw." + name, draw.source());
      Draw drawn{name, table.has("mean"), 0.0, 0.0};
      drawn.a = drawn.normal ? table.number("mean") : table.number("from");
      drawn.b = drawn.normal ? table.not_negative("standard_deviation") : table.number("to");
      table.finish();
      std::erase_if(plan_.draws, [&](const Draw& other) { return other.name == name; });
      plan_.draws.push_back(std::move(drawn));
    });
  }

  void count_cases() {
    std::uint64_t count = plan_.repeats;
    for (const Factor& factor : plan_.factors) {
      if (count > most_cases / factor.values.size()) {
        throw firmware::InputError(top_.source(), 0, "the plan has more than " + std::to_string(most_cases) + " cases",
                                   "fewer values or repeats");
      }
      count *= factor.values.size();
    }
    plan_.cases.count = count;
  }

  /// Everything that the results depend on: program, plan, rig with its laws, roads from files.
  [[nodiscard]] std::string fingerprint() const {
    std::ostringstream all;
    all << firmware::version << '\n' << firmware::format_rig(plan_.rig) << '\n';
    all << plan_.seed << ' ' << plan_.repeats << ' ' << firmware::shortest(plan_.duration) << ' ' << plan_.noise
        << '\n';
    const auto add = [&](const Setting& setting) {
      const auto* road = std::get_if<std::string>(&setting);
      if (road == nullptr) {
        all << firmware::shortest(std::get<double>(setting)) << '\n';
      } else if (road->starts_with(standard_road)) {
        all << *road << '\n';
      } else {
        all << std::ifstream(*road, std::ios::binary).rdbuf() << '\n';
      }
    };
    add(plan_.road);
    add(plan_.speed);
    for (const Factor& factor : plan_.factors) {
      all << factor.name << '\n';
      for (const Setting& value : factor.values) add(value);
    }
    for (const Draw& draw : plan_.draws) {
      all << draw.name << ' ' << draw.normal << ' ' << firmware::shortest(draw.a) << ' ' << firmware::shortest(draw.b)
          << '\n';
    }
    return firmware::sha256(all.str());
  }

  firmware::DescriptionTable top_;
  std::filesystem::path folder_;
  SweepPlan plan_;
};

void set(RigCase& one, const std::string& name, const Setting& setting) {
  if (name == "road") {
    one.road = std::get<std::string>(setting);
  } else if (name == "speed") {
    one.speed = std::get<double>(setting);
  } else if (name == "open_ducts") {
    one.rig.rig.fdva.open_ducts = static_cast<int>(std::get<double>(setting));
  } else {
    *firmware::find_parameter(one.rig.rig, name) = std::get<double>(setting);
  }
  one.settings.emplace_back(name, setting);
}

}  // namespace

SweepPlan parse_plan(std::string_view text, std::string_view source) {
  toml::table table;
  try {
    table = toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw firmware::InputError(source, error.source().begin.line, "TOML syntax: " + std::string(error.description()),
                               "a plan in TOML, beginning with rig");
  }
  return PlanReader(table, source).read();
}

SweepPlan read_plan(const std::filesystem::path& file) {
  return parse_plan(firmware::read_small_text(file, "a plan in TOML"), file.string());
}

std::uint64_t seed_of_case(std::uint64_t base, std::uint64_t id) {
  std::uint64_t z = base + (id + 1) * 0x9E3779B97F4A7C15ULL;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

RigCase case_of(const SweepPlan& plan, std::uint64_t id) {
  RigCase one{id, seed_of_case(plan.seed, id), {}, plan.rig, plan.road, plan.speed};
  std::vector<std::size_t> which(plan.factors.size());
  std::uint64_t point = id / plan.repeats;
  for (std::size_t f = plan.factors.size(); f-- > 0;) {
    const std::uint64_t values = plan.factors[f].values.size();
    which[f] = static_cast<std::size_t>(point % values);
    point /= values;
  }
  for (std::size_t f = 0; f < plan.factors.size(); ++f)
    set(one, plan.factors[f].name, plan.factors[f].values[which[f]]);
  std::seed_seq words{static_cast<std::uint32_t>(one.seed), static_cast<std::uint32_t>(one.seed >> 32U), draw_stream};
  std::mt19937_64 uniform(words);
  firmware::Gaussian normal(one.seed, draw_stream + 1);
  for (const Draw& draw : plan.draws) {
    const double share = static_cast<double>(uniform() >> 11U) * 0x1p-53;
    set(one, draw.name, draw.normal ? draw.a + draw.b * normal() : draw.a + (draw.b - draw.a) * share);
  }
  return one;
}

}  // namespace host_sim::sweep
