#include "host_sim/compensation/stability_section.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "host_sim/signal/spectrum.hpp"

namespace host_sim::compensation {
namespace {

/// Beyond this growth all is of one colour [1/s]: a loop doubles every 0.23 s.
constexpr double strongest_growth = 3.0;

nlohmann::ordered_json or_null(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::vector<double> in_milliseconds(std::vector<double> values) {
  for (double& value : values) value *= 1e3;
  return values;
}

/// Where the growth changes its sign along a column of one assumed delay, straight between the points.
report::Curve border_of_map(const MismatchMap& map) {
  report::Curve border{
      .name = "border", .x = {}, .y = {}, .colour = 6, .dash = report::Dash::none, .marker = report::Marker::circle};
  const std::size_t columns = map.assumed.size();
  for (std::size_t i = 0; i < columns; ++i) {
    for (std::size_t j = 1; j < map.actual.size(); ++j) {
      const double below = map.growth[(j - 1) * columns + i], above = map.growth[j * columns + i];
      if ((below < 0.0) == (above < 0.0)) continue;
      const double share = below / (below - above);
      border.x.push_back(1e3 * map.assumed[i]);
      border.y.push_back(1e3 * (map.actual[j - 1] + share * (map.actual[j] - map.actual[j - 1])));
    }
  }
  return border;
}

report::Figure map_of_delays(const CompensatedStability& stability, const MismatchMap& map) {
  report::HeatMap colours{.quantity = "growth",
                          .unit = "1/s",
                          .x = in_milliseconds(map.assumed),
                          .y = in_milliseconds(map.actual),
                          .values = map.growth,
                          .limit = strongest_growth};
  for (double& value : colours.values) value = std::clamp(value, -strongest_growth, strongest_growth);
  report::Panel panel{.y = {.quantity = "true delay of the machine", .unit = "ms"}};
  panel.heat_map.push_back(std::move(colours));
  if (report::Curve border = border_of_map(map); !border.x.empty()) panel.curves.push_back(std::move(border));
  panel.curves.push_back({.name = "assumed = true",
                          .x = {1e3 * map.assumed.front(), 1e3 * map.assumed.back()},
                          .y = {1e3 * map.assumed.front(), 1e3 * map.assumed.back()},
                          .colour = 6,
                          .dash = report::Dash::dashed});
  panel.curves.push_back({.name = "described",
                          .x = {1e3 * stability.settings.machine.delay},
                          .y = {1e3 * stability.pure_delay},
                          .colour = 6,
                          .dash = report::Dash::none,
                          .marker = report::Marker::cross});
  return {.title = "Assumed and true delay",
          .note =
              "Blue is stable, orange unstable. A column says how wrong the assumed delay may be. adaptive_time_series "
              "arrives at the true machine whatever it assumes.",
          .x = {.quantity = "assumed delay", .unit = "ms"},
          .panels = {panel},
          .height = 520};
}

report::Figure section_of_map(const CompensatedStability& stability) {
  report::Panel panel{.y = {.quantity = "spectral radius", .unit = "1"}};
  panel.curves.push_back({.name = std::string(name(stability.kind)),
                          .x = in_milliseconds(stability.mismatch.error),
                          .y = stability.mismatch.radius,
                          .colour = 0,
                          .marker = report::Marker::circle});
  panel.guides.push_back({.along = report::Guide::Along::y, .value = 1.0, .label = "border"});
  return {.title = "How wrong may the described delay be?",
          .note = "The loop is stable below 1.",
          .x = {.quantity = "true − described delay", .unit = "ms"},
          .panels = {panel}};
}

}  // namespace

nlohmann::ordered_json to_json(const CompensatedStability& stability, const std::optional<MismatchMap>& map) {
  nlohmann::ordered_json json{{"kind", name(stability.kind)},
                              {"stable", stability.stable},
                              {"spectral_radius", stability.spectral_radius},
                              {"assumed_delay", stability.assumed_delay},
                              {"delay", stability.delay},
                              {"needs_component_model", needs_component_model(stability.kind)}};
  auto& roots = json["roots"] = nlohmann::ordered_json::array();
  for (const Complex root : stability.roots) {
    roots.push_back({{"re", root.real()}, {"im", root.imag()}, {"frequency_hz", root.imag() / full_turn}});
  }
  json["delay_may_be_longer"] = or_null(stability.mismatch.later);
  json["delay_may_be_shorter"] =
      or_null(stability.mismatch.earlier ? std::optional(-*stability.mismatch.earlier) : std::nullopt);
  json["critical_delay_error"] = or_null(stability.stable ? stability.mismatch.smallest() : std::optional(0.0));
  json["nearest_stable_change"] = or_null(stability.mismatch.nearest_stable);
  json["upper_gain"] = or_null(stability.upper_gain);
  json["lower_gain"] = or_null(stability.lower_gain);
  json["over_delay_error"] = {{"delay_error", stability.mismatch.error},
                              {"spectral_radius", stability.mismatch.radius}};
  if (map) json["mismatch_map"] = {{"assumed", map->assumed}, {"true", map->actual}, {"growth", map->growth}};
  return json;
}

void add_stability_section(report::Report& page, const CompensatedStability& stability, const MismatchMap& map) {
  page.add_section("With compensation");
  page.add_text(
      "One period of the code that runs, with car, "
      "compensator, machine and component, is a matrix; the loop is stable where all its eigenvalues lie within the "
      "unit circle.");
  report::Table table{.title = "Roots of the compensated loop, ln λ/h",
                      .headings = {"", "Re [1/s]", "f [Hz]", "damping [1]"},
                      .rows = {}};
  for (std::size_t i = 0; i < stability.roots.size(); ++i) {
    const Complex root = stability.roots[i];
    table.rows.push_back({std::to_string(i + 1), report::figure_text(root.real(), 5),
                          report::figure_text(root.imag() / full_turn, 5),
                          report::figure_text(-root.real() / std::abs(root), 3)});
  }
  page.add_table(table);
  page.add_figure(section_of_map(stability));
  page.add_figure(map_of_delays(stability, map));
}

}  // namespace host_sim::compensation
