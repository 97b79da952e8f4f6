#include "host_sim/sweep/sweep_page.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "host_sim/report/report.hpp"
#include "model/components/channel.hpp"

namespace host_sim::sweep {
namespace {

using nlohmann::ordered_json;
using report::figure_text;

constexpr std::size_t most_values = 24;  ///< of a setting that becomes an axis of the matrix
constexpr std::size_t most_histograms = 4;
constexpr std::size_t columns_of_histogram = 24;

/// The cases, a row each.
std::vector<ordered_json> rows_of(const std::filesystem::path& file) {
  std::vector<ordered_json> rows;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    if (line.empty()) continue;
    ordered_json row = ordered_json::parse(line);
    if (!row.contains("failed")) rows.push_back(std::move(row));
  }
  return rows;
}

bool is_result(const std::string& key) {
  return key.starts_with("rms_") || key.starts_with("lowest_") || key.starts_with("highest_");
}

std::string unit_of(const std::string& key) {
  const auto channel = model::find_channel(key.substr(key.find('_') + 1));
  return channel ? std::string(model::unit(*channel)) : "1";
}

/// Of a setting; what is no quantity that everybody has is in SI units, as the plan.
std::string unit_of_setting(const std::string& name) {
  if (name == "speed") return "m/s";
  if (name == "duration") return "s";
  if (name == "open_ducts") return "1";
  if (name.ends_with("stiffness")) return "N/m";
  if (name.ends_with("damping")) return "N s/m";
  if (name.ends_with("mass")) return "kg";
  return "SI";
}

/// The rms values that a suspension is judged by, else the first ones.
std::vector<std::string> judged(const Merged& merged) {
  std::vector<std::string> list;
  const auto add = [&](const std::string& name) {
    const bool there =
        std::any_of(merged.numbers.begin(), merged.numbers.end(), [&](const Spread& s) { return s.name == name; });
    if (there && list.size() < most_histograms && std::find(list.begin(), list.end(), name) == list.end()) {
      list.push_back(name);
    }
  };
  for (const char* const name : {"rms_F_w", "rms_zdd_b", "rms_dz_b", "rms_F", "rms_x_act"}) add(name);
  for (const Spread& s : merged.numbers) {
    if (list.empty() && s.name.starts_with("rms_")) add(s.name);
  }
  return list;
}

void add_histograms(report::Report& page, const std::vector<ordered_json>& rows,
                    const std::vector<std::string>& names) {
  page.add_section("Histograms");
  for (const std::string& name : names) {
    std::vector<double> values;
    for (const ordered_json& row : rows) {
      if (row.contains(name) && row[name].is_number()) values.push_back(row[name].get<double>());
    }
    if (values.empty()) continue;
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double from = *low, width = (*high - *low) / static_cast<double>(columns_of_histogram);
    std::vector<double> counts(columns_of_histogram, 0.0);
    for (const double v : values) {
      const std::size_t at = width > 0.0 ? static_cast<std::size_t>((v - from) / width) : 0;
      counts[std::min(at, columns_of_histogram - 1)] += 1.0;
    }
    report::Curve outline{name, {from}, {0.0}, 0, report::Dash::solid};
    for (std::size_t i = 0; i < counts.size(); ++i) {
      for (const std::size_t edge : {i, i + 1}) {
        outline.x.push_back(from + static_cast<double>(edge) * width);
        outline.y.push_back(counts[i]);
      }
    }
    outline.x.push_back(*high);
    outline.y.push_back(0.0);
    report::Figure figure;
    figure.title = name + " over all cases";
    figure.x = {name, unit_of(name)};
    report::Panel panel;
    panel.y = {"cases", "1"};
    panel.curves.push_back(std::move(outline));
    figure.panels.push_back(std::move(panel));
    figure.height = 260;
    page.add_figure(figure);
  }
}

/// Settings with several values, those with most first.
std::vector<std::string> varied(const std::vector<ordered_json>& rows) {
  std::map<std::string, std::set<double>> values;
  for (const ordered_json& row : rows) {
    for (const auto& [key, value] : row.items()) {
      if (key == "id" || key == "seed" || is_result(key) || !value.is_number()) continue;
      std::set<double>& seen = values[key];
      if (seen.size() <= most_values) seen.insert(value.get<double>());
    }
  }
  std::vector<std::string> names;
  for (const auto& [name, seen] : values) {
    if (seen.size() >= 2 && seen.size() <= most_values) names.push_back(name);
  }
  std::stable_sort(names.begin(), names.end(),
                   [&](const auto& a, const auto& b) { return values[a].size() > values[b].size(); });
  return names;
}

/// Mean of one number over two settings, relative to its mean over all.
void add_matrix(report::Report& page, const std::vector<ordered_json>& rows, const std::vector<std::string>& names) {
  const std::vector<std::string> settings = varied(rows);
  if (settings.size() < 2 || names.empty()) return;
  const std::string &across = settings[0], &up = settings[1];
  page.add_section("Two settings");
  for (const std::string& name : names) {
    std::map<std::pair<double, double>, std::pair<double, double>> sums;  // (up, across) → Σ, n
    std::set<double> x, y;
    double sum = 0.0, count = 0.0;
    for (const ordered_json& row : rows) {
      if (!row.contains(name) || !row.contains(across) || !row.contains(up) || !row[name].is_number()) continue;
      const double value = row[name].get<double>(), a = row[across].get<double>(), b = row[up].get<double>();
      x.insert(a);
      y.insert(b);
      auto& cell = sums[{b, a}];
      cell.first += value;
      cell.second += 1.0;
      sum += value;
      count += 1.0;
    }
    if (x.size() < 2 || y.size() < 2 || !(sum != 0.0)) continue;
    report::HeatMap map;
    map.quantity = "change of " + name;
    map.unit = "%";
    map.x.assign(x.begin(), x.end());
    map.y.assign(y.begin(), y.end());
    for (const double b : y) {
      for (const double a : x) {
        const auto cell = sums.find({b, a});
        map.values.push_back(cell == sums.end()
                                 ? std::nan("")
                                 : 100.0 * (cell->second.first / cell->second.second / (sum / count) - 1.0));
      }
    }
    report::Figure figure;
    figure.title = name + " over " + across + " and " + up;
    figure.note = "Mean of the cases of a cell, against the mean of all cases, " + figure_text(sum / count, 4) + " " +
                  unit_of(name) + ". White: the mean.";
    figure.x = {across, unit_of_setting(across)};
    report::Panel panel;
    panel.y = {up, unit_of_setting(up)};
    panel.heat_map.push_back(std::move(map));
    figure.panels.push_back(std::move(panel));
    page.add_figure(figure);
  }
}

}  // namespace

std::string sentence(const Merged& merged) {
  std::string text = std::to_string(merged.cases.count) + (merged.cases.count == 1 ? " case" : " cases") + ", " +
                     (merged.failed == 0 ? "none failed" : std::to_string(merged.failed) + " failed");
  for (const std::string& name : judged(merged)) {
    const auto s =
        std::find_if(merged.numbers.begin(), merged.numbers.end(), [&](const Spread& n) { return n.name == name; });
    text +=
        "; " + name + " from " + figure_text(s->lowest, 3) + " to " + figure_text(s->highest, 3) + " " + unit_of(name);
  }
  return text + ".";
}

std::string sweep_page(const Merged& merged) {
  report::Report page("Sweep " + merged.json.parent_path().filename().string());
  page.add_verdict(merged.failed == 0 ? report::Verdict::remark : report::Verdict::bad, sentence(merged));
  if (merged.failed > 0) page.add_text("The first that failed: " + merged.first_failure + ".");
  const std::vector<ordered_json> rows = rows_of(merged.json);
  const std::vector<std::string> names = judged(merged);
  add_matrix(page, rows, names);
  add_histograms(page, rows, names);
  page.add_section("Numbers");
  report::Table table{"", {"number", "unit", "mean", "standard deviation", "lowest", "highest"}, {}, 2};
  for (const Spread& s : merged.numbers) {
    table.rows.push_back({s.name, is_result(s.name) ? unit_of(s.name) : unit_of_setting(s.name), figure_text(s.mean, 4),
                          figure_text(s.standard_deviation(), 3), figure_text(s.lowest, 4), figure_text(s.highest, 4)});
  }
  page.add_table(table);
  return page.html();
}

}  // namespace host_sim::sweep
