#include "firmware/description/laws/law_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "firmware/description/laws/law_file.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "model/rig/rig_check.hpp"

namespace firmware {
namespace {

using model::LawOver;
using model::LawPlace;
using Rig = model::RigParameters<double>;

constexpr std::string_view places = "suspension, tyre, piston, body_guide, wheel_guide or \"sensor CHANNEL\"";

/// [1] Of the largest force of a table, what it may be at rest: load cells of class 1. At half of it tables with a
/// reading of nothing would be refused, at twice a damper of 2 kN lets the body sink by 1.3 mm on 31 500 N/m.
constexpr double most_at_rest = 0.01;

/// [N/m] Stiffest spring in series: a steel bar of 1 m² and 0.2 m. Stiffer is another unit, or none at all.
constexpr double most_behind = 1e12;

/// Reads one [laws.NAME].
class LawReader {
 public:
  LawReader(DescriptionTable& table, const std::string& name, Rig& rig) : table_(table), rig_(rig) { law_.name = name; }

  LawDescription read() {
    read_place();
    if (table_.has("feeds_energy")) law_.feeds_energy = table_.truth("feeds_energy");
    const bool curve = table_.has("over") || table_.has("at") || table_.has("value") || table_.has("file");
    if (curve) read_curve_or_surface();
    const bool branches = table_.has("branches");
    if (branches) read_branches();
    if (table_.has("behind")) read_behind(branches);
    table_.finish();
    if (!curve && !branches) table_.need("at", "a curve (over, at, value or file) or branches");
    return law_;
  }

 private:
  void read_place() {
    const std::string word = table_.text("place");
    std::string_view name = word;
    constexpr std::string_view sensor = "sensor ";
    if (name.substr(0, sensor.size()) == sensor) {
      const auto channel = model::find_channel(name.substr(sensor.size()));
      if (!channel) table_.fail("place", "unknown channel in " + in_quotes(word), places);
      place_ = LawPlace::sensor;
      channel_ = *channel;
    } else {
      const auto known = std::find(model::law_place_names.begin(), model::law_place_names.end() - 1, name);
      if (known == model::law_place_names.end() - 1) {
        table_.fail("place", with_suggestion("unknown place", word, model::law_place_names), places);
      }
      place_ = static_cast<LawPlace>(known - model::law_place_names.begin());
    }
    if (!model::has_place(rig_.kind, rig_.has_fdva, place_, channel_)) {
      table_.fail("place", in_quotes(word) + ": " + std::string(model::name(rig_.kind)) + " has no such place",
                  "a place of this rig");
    }
  }

  void read_curve_or_surface() {
    if (place_ == LawPlace::sensor) {
      if (table_.has("over"))
        table_.fail("over", table_.path("over") + " of a sensor",
                    "no key \"over\": a sensor's curve is over its true value");
      return read_curve();
    }
    const toml::node& over = table_.need("over", "\"velocity\", \"deflection\" or [\"deflection\", \"velocity\"]");
    if (const auto* both = over.as_array()) {
      const auto word = [&](std::size_t i) { return both->size() == 2 ? (*both)[i].value_or(std::string_view()) : ""; };
      if (word(0) != "deflection" || word(1) != "velocity") {
        table_.fail(over, table_.path("over") + " names no two variables", "[\"deflection\", \"velocity\"]");
      }
      return read_surface();
    }
    const std::string word = table_.text("over");
    if (word != "velocity" && word != "deflection") {
      table_.fail(over, table_.path("over") + " = " + in_quotes(word),
                  "\"velocity\", \"deflection\" or [\"deflection\", \"velocity\"]");
    }
    over_ = word == "velocity" ? LawOver::velocity : LawOver::deflection;
    read_curve();
  }

  std::vector<double> numbers(std::string_view key, const toml::node& node, std::size_t least, std::size_t most) {
    const auto* list = node.as_array();
    const std::string range = std::to_string(least) + " to " + std::to_string(most) + " numbers";
    if (list == nullptr || list->size() < least || list->size() > most) {
      table_.fail(node, table_.path(key) + " is not a list of " + range, "[…] of " + range);
    }
    std::vector<double> values;
    for (const toml::node& entry : *list) {
      const auto value = as_number(entry);
      if (!value || !std::isfinite(*value)) {
        table_.fail(entry,
                    table_.path(key) + ": value " + std::to_string(values.size() + 1) + " is not a finite number",
                    range);
      }
      values.push_back(*value);
    }
    return values;
  }

  std::vector<double> ascending(std::string_view key, std::size_t most, double largest, std::string_view unit) {
    const toml::node& node = table_.need(key, "ascending numbers");
    const std::vector<double> at = numbers(key, node, 2, most);
    for (std::size_t i = 1; i < at.size(); ++i) {
      if (at[i] > at[i - 1]) continue;
      table_.fail(node.as_array()->at(i), table_.path(key) + ": " + shortest(at[i]) + " follows " + shortest(at[i - 1]),
                  "ascending numbers");
    }
    demand_unit(key, at, largest, unit);
    return at;
  }

  void demand_unit(std::string_view key, const std::vector<double>& values, double largest, std::string_view unit) {
    for (const double value : values) {
      if (std::abs(value) <= largest) continue;
      const std::string milli = unit == "N" ? "" : "; is the table in m" + std::string(unit) + "?";
      table_.fail(key,
                  law_.file.empty() ? table_.path(key) + " reaches " + shortest(value) + " " + std::string(unit)
                                    : law_.file + " reaches " + shortest(value) + " " + std::string(unit),
                  "at most " + shortest(largest) + " " + std::string(unit) + milli +
                      (law_.file.empty() ? "" : " Write the units into its header"));
    }
  }

  [[nodiscard]] double largest_at() const {
    if (place_ == LawPlace::sensor) return std::numeric_limits<double>::max();
    return over_ == LawOver::velocity ? law_limits::fastest : law_limits::farthest;
  }
  [[nodiscard]] std::string_view unit_at() const {
    if (place_ == LawPlace::sensor) return model::unit(channel_);
    return over_ == LawOver::velocity ? "m/s" : "m";
  }

  void read_curve() {
    model::Laws<double>& laws = rig_.laws;
    if (laws.curve_count == laws.curves.size()) {
      table_.fail("over", "more than " + std::to_string(laws.curves.size()) + " curves", "fewer laws");
    }
    LawPoints points;
    if (table_.has("file")) {
      law_.file = table_.text("file");
      for (const std::string_view key : {"at", "value"}) {
        if (table_.has(key)) table_.fail(key, table_.path(key) + " beside a file", "either file, or at and value");
      }
      points = read_law_file(law_file_path(table_.source(), law_.file), place_, over_);
      demand_unit("file", points.at, largest_at(), unit_at());
    } else {
      points.at = ascending("at", model::curve_points, largest_at(), unit_at());
      points.value = numbers("value", table_.need("value", "as many numbers as at"), 2, model::curve_points);
      if (points.value.size() != points.at.size()) {
        table_.fail("value", table_.path("value") + " has " + std::to_string(points.value.size()) + " numbers",
                    std::to_string(points.at.size()) + ", as many as at");
      }
    }
    const std::string_view at_key = law_.file.empty() ? "value" : "file";
    if (place_ != LawPlace::sensor) {
      demand_unit(at_key, points.value, law_limits::strongest, "N");
      take_preload_off(at_key, points);
      if (!law_.feeds_energy) demand_resistance(at_key, points);
    }
    law_.curve = laws.curve_count;
    model::CurveTable<double>& curve = laws.curves[laws.curve_count++];
    curve = {place_, over_, channel_, static_cast<std::uint8_t>(points.at.size()), {}, {}};
    std::copy(points.at.begin(), points.at.end(), curve.at.begin());
    std::copy(points.value.begin(), points.value.end(), curve.value.begin());
  }

  /// Forces are dynamic: what a component pushes at rest (the gas of a damper, the load on a spring) carries the body
  /// already and is no part of the law. A table that has it says so, else the body would begin to sink or rise.
  void take_preload_off(std::string_view key, LawPoints& points) {
    const double preload = table_.has("preload") ? table_.number("preload") : 0.0;
    if (std::abs(preload) > law_limits::strongest) {
      table_.fail("preload", table_.path("preload") + " = " + shortest(preload) + " N", "a force in N");
    }
    double largest = 0.0;
    for (double& value : points.value) largest = std::max(largest, std::abs(value -= preload));
    const bool inside = points.at.front() <= 0.0 && points.at.back() >= 0.0;
    if (rig_.kind == model::RigKind::component_bench || law_.feeds_energy || !inside) return;
    const double at_rest = model::Curve<double>(points.at, points.value, points.at.size())(0.0);
    if (std::abs(at_rest) <= most_at_rest * largest) return;
    const auto rounded = [](double force) { return std::round(1e3 * force) / 1e3; };
    std::string described = shortest(rounded(at_rest + preload));
    if (described.find_first_of(".e") == std::string::npos) described += ".0";
    table_.fail(
        table_.has("preload") ? "preload" : key,
        "the law " + law_.name + " pushes with " + shortest(rounded(at_rest)) +
            " N at rest: the body would not stay where it begins",
        "preload = " + described +
            " if the static equilibrium carries that force, as that of a damper's gas, or a table through zero");
  }

  /// A law that pushes the way it is pushed: over a cycle between the ends of its table it gives more than it takes.
  /// The points of the table are its only places, each with the weight of its distance.
  void demand_resistance(std::string_view key, const LawPoints& points) {
    const model::Curve<double> curve(points.at, points.value, points.at.size());
    const double middle = points.at.front() < 0.0 && points.at.back() > 0.0 ? 0.0 : points.at.front();
    double work = 0.0;
    for (std::size_t i = 0; i < points.at.size(); ++i) {
      work += (points.value[i] - curve(middle)) * (points.at[i] - middle);
    }
    if (work >= 0.0) return;
    const bool velocity = over_ == LawOver::velocity;
    table_.fail(
        key,
        "the law " + law_.name + (velocity ? " pushes the way it moves" : " pushes further the way it is deflected"),
        std::string(velocity ? "a force that grows with the velocity" : "a force that grows with the deflection") +
            " (compression positive), or feeds_energy = true");
  }

  /// A spring in series with the curve.
  void read_behind(bool branches) {
    const double stiffness = table_.positive("behind");
    const std::string curve = "a curve over velocity or deflection";
    if (place_ == LawPlace::sensor)
      table_.fail("behind", "a sensor's curve behind a spring", "a place where a force acts");
    if (branches || law_.curve == LawDescription::none) {
      table_.fail("behind", branches ? "branches behind a spring" : "a surface behind a spring",
                  branches ? curve + "; a single branch behind k has the stiffness k c/(k + c)" : curve);
    }
    if (stiffness > most_behind) {
      table_.fail("behind", table_.path("behind") + " = " + shortest(stiffness) + " N/m",
                  "a stiffness in N/m, at most " + shortest(most_behind));
    }
    model::CurveTable<double>& table = rig_.laws.curves[law_.curve];
    if (!model::rises(table.value, table.count)) {
      table_.fail("behind", "the law " + law_.name + " falls, and is behind a spring: it would jump",
                  "values that nowhere fall");
    }
    table.behind = stiffness;
  }

  void read_surface() {
    model::Laws<double>& laws = rig_.laws;
    if (laws.surface_count == laws.surfaces.size()) {
      table_.fail("over", "more than " + std::to_string(laws.surfaces.size()) + " surface", "fewer surfaces");
    }
    const double preload = table_.has("preload") ? table_.number("preload") : 0.0;
    const auto deflection = ascending("at", model::surface_points, law_limits::farthest, "m");
    const auto velocity = ascending("at_2", model::surface_points, law_limits::fastest, "m/s");
    const toml::node& value = table_.need("value", "a list of numbers over at_2 for each number of at");
    const auto* rows = value.as_array();
    if (rows == nullptr || rows->size() != deflection.size()) {
      table_.fail(value, table_.path("value") + " has not a list for each number of at",
                  std::to_string(deflection.size()) + " lists of " + std::to_string(velocity.size()) + " numbers");
    }
    model::SurfaceTable<double> surface{.place = place_,
                                        .rows = static_cast<std::uint8_t>(deflection.size()),
                                        .columns = static_cast<std::uint8_t>(velocity.size())};
    std::copy(deflection.begin(), deflection.end(), surface.deflection.begin());
    std::copy(velocity.begin(), velocity.end(), surface.velocity.begin());
    for (std::size_t i = 0; i < deflection.size(); ++i) {
      auto row = numbers("value", *rows->get(i), velocity.size(), velocity.size());
      for (double& force : row) force -= preload;
      demand_unit("value", row, law_limits::strongest, "N");
      over_ = LawOver::velocity;
      if (!law_.feeds_energy) demand_resistance("value", {velocity, row});
      std::copy(row.begin(), row.end(), surface.value[i].begin());
    }
    law_.surface = laws.surface_count;
    laws.surfaces[laws.surface_count++] = surface;
  }

  void read_branches() {
    model::Laws<double>& laws = rig_.laws;
    const toml::node& node = table_.need("branches", "a list of branches");
    constexpr std::string_view expected =
        "1 to 8 branches { stiffness = …, time_constant = … } or { stiffness = …, slip_force = …, gap = … }";
    if (place_ == LawPlace::sensor) table_.fail(node, "branches of a sensor", "a place where a force acts");
    const auto* list = node.as_array();
    if (list == nullptr || list->empty()) table_.fail(node, table_.path("branches") + " is not a list", expected);
    law_.first_branch = laws.branch_count;
    for (const toml::node& entry : *list) {
      const auto* inner = entry.as_table();
      if (inner == nullptr) table_.fail(entry, "a branch of " + law_.name + " is not a table", expected);
      if (laws.branch_count == laws.branches.size()) table_.fail(entry, "more than 8 branches", expected);
      DescriptionTable branch(*inner, table_.path("branches"), table_.source());
      model::BranchNumbers<double> numbers{.place = place_, .stiffness = branch.positive("stiffness")};
      const bool time = branch.has("time_constant"), slip = branch.has("slip_force");
      if (time == slip)
        table_.fail(
            entry,
            "a branch of " + law_.name + " with " + (time ? "both" : "neither") + " time_constant and slip_force",
            expected);
      (time ? numbers.time_constant : numbers.slip_force) = branch.positive(time ? "time_constant" : "slip_force");
      if (branch.has("gap")) {
        if (time)
          table_.fail(entry, "a gap of a branch of " + law_.name + " with a time_constant", "a gap of a slider");
        numbers.gap = branch.not_negative("gap");
      }
      branch.finish();
      laws.branches[laws.branch_count++] = numbers;
      ++law_.branches;
    }
  }

  DescriptionTable& table_;
  Rig& rig_;
  LawDescription law_;
  LawPlace place_{};
  LawOver over_{};
  model::Channel channel_{};
};

}  // namespace

std::vector<LawDescription> read_laws(DescriptionTable& top, Rig& rig) {
  std::vector<LawDescription> laws;
  auto tables = top.table("laws");
  if (!tables) return laws;
  for (const auto& [key, node] : tables->raw()) {
    const std::string name(key.str());
    if (name.empty() || name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") !=
                            std::string::npos) {
      tables->fail(node, "the name " + in_quotes(name) + " of a law", "letters, digits, _ and -");
    }
    DescriptionTable table = *tables->table(name);
    laws.push_back(LawReader(table, name, rig).read());
  }
  tables->accept_all_keys();
  return laws;
}

}  // namespace firmware
