#include "host_sim/campaign/campaign_result.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::campaign {
namespace {

using nlohmann::ordered_json;
using report::figure_text;

/// {"value": …, "ci95": [a, b]}
std::optional<Estimate> estimate_in(const ordered_json& json, std::size_t record) {
  if (!json.contains("value") || !json.contains("ci95") || !json["ci95"].is_array()) return std::nullopt;
  return Estimate{record, json["value"].get<double>(), json["ci95"].at(0).get<double>(),
                  json["ci95"].at(1).get<double>()};
}

/// The object or list under a key, or an empty one.
const ordered_json& part(const ordered_json& json, const char* key) {
  static const ordered_json none = ordered_json::object();
  return json.contains(key) ? json[key] : none;
}

void add_effects(const ordered_json& verdict, std::size_t record, Row& row) {
  for (const ordered_json& effect : part(verdict, "effects")) {
    std::string name = effect.value("name", "");
    if (effect.contains("channel")) name += " of " + effect["channel"].get<std::string>();
    char confidence[32];
    std::snprintf(confidence, sizeof confidence, " (%.2f)", effect.value("confidence", 0.0));
    row.effects += (row.effects.empty() ? "" : ", ") + name + confidence;
    for (const auto& [parameter, value] : part(effect, "parameters").items()) {
      if (const auto e = estimate_in(value, record)) row.values[name + ": " + parameter] = *e;
    }
  }
}

}  // namespace

Row row_of(const ordered_json& verdict, const ordered_json& state, std::size_t record, std::string name) {
  Row row;
  row.name = std::move(name);
  row.verdict = verdict.value("verdict", "");
  row.failure = state.value("failure", "");
  if (row.verdict.empty() && row.failure.empty()) row.failure = "its verdict.json holds no verdict";
  row.duration = state.value("seconds", 0.0);
  row.unexplained = verdict.value("unexplained", false);
  add_effects(verdict, record, row);
  for (const auto& [path, value] : part(verdict, "parameters").items()) {
    if (const auto e = estimate_in(value, record)) row.values[path] = *e;
  }
  for (const auto& [channel, gap] : part(verdict, "gap").items()) {
    if (gap.value("before", 0.0) < row.before) continue;
    row.before = gap.value("before", 0.0);
    row.after = gap.value("after", 0.0);
  }
  return row;
}

ordered_json to_json(const Campaign& campaign) {
  ordered_json json{
      {"records", ordered_json::array()}, {"quantities", ordered_json::object()}, {"outliers", ordered_json::array()}};
  for (const Row& row : campaign.rows) {
    ordered_json one{{"name", row.name},       {"verdict", row.verdict}, {"effects", row.effects},
                     {"before", row.before},   {"after", row.after},     {"unexplained", row.unexplained},
                     {"seconds", row.duration}};
    if (!row.failure.empty()) one["failure"] = row.failure;
    one["values"] = ordered_json::object();
    for (const auto& [name, e] : row.values) one["values"][name] = {{"value", e.value}, {"ci95", {e.lower, e.upper}}};
    json["records"].push_back(std::move(one));
  }
  for (const auto& [name, q] : campaign.quantities) {
    ordered_json shrunk = ordered_json::array();
    for (std::size_t i = 0; i < q.estimates.size(); ++i) {
      shrunk.push_back({{"record", campaign.rows[q.estimates[i].record].name},
                        {"value", q.shrunk[i]},
                        {"deviation", q.shrunk_deviation[i]}});
    }
    json["quantities"][name] = {{"mean", q.mean},
                                {"mean_deviation", q.mean_deviation},
                                {"spread", q.spread},
                                {"drift_by_record", q.slope},
                                {"drift_deviation", q.slope_deviation},
                                {"drifts", q.drifts()},
                                {"shrunk", std::move(shrunk)}};
  }
  for (std::size_t i = 0; i < campaign.outliers.size(); ++i) {
    json["outliers"].push_back({{"record", campaign.rows[campaign.outliers[i]].name}, {"why", campaign.why[i]}});
  }
  return json;
}

namespace {

std::string cell(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::vector<std::string> quantity_names(const Campaign& campaign) {
  std::map<std::string, bool> seen;
  for (const Row& row : campaign.rows) {
    for (const auto& [name, value] : row.values) seen[name] = true;
  }
  std::vector<std::string> names;
  names.reserve(seen.size());
  for (const auto& [name, there] : seen) names.push_back(name);
  return names;
}

}  // namespace

std::string to_csv(const Campaign& campaign) {
  const std::vector<std::string> names = quantity_names(campaign);
  std::string text = "record,verdict,effects,before,after,failure";
  for (const std::string& name : names)
    text += "," + cell(name) + "," + cell(name + " lower") + "," + cell(name + " upper");
  for (const Row& row : campaign.rows) {
    text += "\n" + cell(row.name) + "," + row.verdict + "," + cell(row.effects) + "," + firmware::shortest(row.before) +
            "," + firmware::shortest(row.after) + "," + cell(row.failure);
    for (const std::string& name : names) {
      const auto found = row.values.find(name);
      if (found == row.values.end()) {
        text += ",,,";
      } else {
        const Estimate& e = found->second;
        text +=
            "," + firmware::shortest(e.value) + "," + firmware::shortest(e.lower) + "," + firmware::shortest(e.upper);
      }
    }
  }
  return text + "\n";
}

std::string sentence(const Campaign& campaign) {
  std::map<std::string, std::size_t> verdicts;
  std::size_t failed = 0;
  for (const Row& row : campaign.rows) {
    if (row.failure.empty())
      ++verdicts[row.effects.empty() ? row.verdict : row.effects.substr(0, row.effects.find(" ("))];
    failed += row.failure.empty() ? 0 : 1;
  }
  std::vector<std::pair<std::size_t, std::string>> sorted;
  for (const auto& [name, count] : verdicts) sorted.emplace_back(count, name);
  std::sort(sorted.rbegin(), sorted.rend());
  std::string text = std::to_string(campaign.rows.size()) + " records: ";
  for (std::size_t i = 0; i < std::min<std::size_t>(3, sorted.size()); ++i) {
    text += (i > 0 ? ", " : "") + sorted[i].second + " in " + std::to_string(sorted[i].first);
  }
  if (failed > 0) text += ", " + std::to_string(failed) + " could not be diagnosed";
  text += campaign.outliers.empty() ? "; none stands out"
                                    : "; " + std::to_string(campaign.outliers.size()) +
                                          (campaign.outliers.size() == 1 ? " stands out" : " stand out");
  std::size_t drifting = 0;
  for (const auto& [name, q] : campaign.quantities) {
    if (q.drifts() && drifting++ < 2) {
      char change[96];
      std::snprintf(change, sizeof change, "; %s drifts by %+.2g in 100 records", name.c_str(), 100.0 * q.slope);
      text += change;
    }
  }
  return text + ".";
}

namespace {

/// "coulomb_friction: force", "sensor_lag of F: time_constant": the unit on the card. Others are in SI units.
std::string unit_of(const std::string& quantity) {
  const std::size_t colon = quantity.find(": ");
  if (colon == std::string::npos) return "SI";
  const firmware::CatalogueEntry* const entry =
      firmware::find_effect(quantity.substr(0, std::min(colon, quantity.find(" of "))));
  if (entry == nullptr) return "SI";
  for (const model::EffectParameter& p : entry->parameters) {
    if (p.name == quantity.substr(colon + 2) && !p.unit.empty()) return std::string(p.unit);
  }
  return "SI";
}

report::Curve points(const std::string& name, const Quantity& q, int colour) {
  report::Curve curve{name, {}, {}, colour, report::Dash::none, report::Marker::circle};
  for (const Estimate& e : q.estimates) {
    curve.x.push_back(static_cast<double>(e.record + 1));
    curve.y.push_back(e.value);
    curve.lower_error.push_back(e.value - e.lower);
    curve.upper_error.push_back(e.upper - e.value);
  }
  return curve;
}

void add_quantity(report::Report& page, const std::string& name, const Quantity& q, const Campaign* earlier) {
  report::Figure figure;
  figure.title = name;
  figure.note = "mean " + figure_text(q.mean, 5) + " ± " + figure_text(q.mean_deviation, 2) +
                ", from record to record " + figure_text(q.spread, 2) +
                (q.drifts() ? "; it drifts by " + figure_text(q.slope, 2) + " ± " + figure_text(q.slope_deviation, 2) +
                                  " a record"
                            : "");
  figure.x = {"record", "1"};
  report::Panel panel;
  panel.y = {name, unit_of(name)};
  panel.curves.push_back(points("by itself, 95 %", q, 0));
  report::Curve shrunk{"with what the others say", {}, {}, 1, report::Dash::none, report::Marker::diamond};
  for (std::size_t i = 0; i < q.estimates.size(); ++i) {
    shrunk.x.push_back(static_cast<double>(q.estimates[i].record + 1));
    shrunk.y.push_back(q.shrunk[i]);
  }
  panel.curves.push_back(std::move(shrunk));
  if (earlier != nullptr) {
    const auto before = earlier->quantities.find(name);
    if (before != earlier->quantities.end()) panel.curves.push_back(points("earlier campaign", before->second, 2));
  }
  panel.guides.push_back({report::Guide::Along::y, q.mean, "mean"});
  figure.panels.push_back(std::move(panel));
  figure.height = 300;
  page.add_figure(figure);
}

report::Table table_of(const Campaign& campaign) {
  report::Table table;
  table.title = "Records";
  table.headings = {"record", "verdict", "effects (confidence)", "error before [%]", "after [%]"};
  table.text_columns = 3;
  for (const Row& row : campaign.rows) {
    table.rows.push_back({row.name, row.failure.empty() ? row.verdict : row.failure, row.effects,
                          figure_text(100.0 * row.before, 3), figure_text(100.0 * row.after, 3)});
  }
  return table;
}

report::Table change_of(const Campaign& now, const Campaign& earlier) {
  report::Table table;
  table.title = "Before and after";
  table.headings = {"quantity", "before", "after", "change", "in its deviations"};
  for (const auto& [name, q] : now.quantities) {
    const auto before = earlier.quantities.find(name);
    if (before == earlier.quantities.end()) continue;
    const double change = q.mean - before->second.mean;
    table.rows.push_back({name, figure_text(before->second.mean, 5), figure_text(q.mean, 5), figure_text(change, 3),
                          figure_text(change / std::hypot(q.mean_deviation, before->second.mean_deviation), 2)});
  }
  return table;
}

}  // namespace

std::string campaign_page(const Campaign& campaign, const std::optional<Campaign>& earlier) {
  report::Report page("A campaign", sentence(campaign));
  if (!campaign.outliers.empty()) {
    report::Table table;
    table.title = "What stands out, worst first";
    table.headings = {"record", "why"};
    table.text_columns = 2;
    for (std::size_t i = 0; i < campaign.outliers.size(); ++i) {
      table.rows.push_back({campaign.rows[campaign.outliers[i]].name, campaign.why[i]});
    }
    page.add_table(table);
  }
  if (earlier) page.add_table(change_of(campaign, *earlier));
  page.add_section("Quantities over the campaign");
  for (const auto& [name, q] : campaign.quantities) add_quantity(page, name, q, earlier ? &*earlier : nullptr);
  page.add_section("Records");
  page.add_table(table_of(campaign));
  return page.html();
}

Campaign read_campaign(const std::string& text, const std::string& source) {
  const ordered_json json = ordered_json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.contains("records")) {
    throw firmware::InputError(source, 0, "is no campaign.json", "the result of rigtwin diagnose --campaign");
  }
  std::vector<Row> rows;
  try {
    for (const ordered_json& one : json["records"]) {
      Row row;
      row.name = one.value("name", "");
      row.verdict = one.value("verdict", "");
      row.failure = one.value("failure", "");
      row.effects = one.value("effects", "");
      for (const auto& [name, value] : part(one, "values").items()) {
        if (const auto e = estimate_in(value, rows.size())) row.values[name] = *e;
      }
      rows.push_back(std::move(row));
    }
  } catch (const nlohmann::json::exception&) {
    throw firmware::InputError(source, 0, "is no campaign.json", "the result of rigtwin diagnose --campaign");
  }
  return campaign_of(std::move(rows));
}

}  // namespace host_sim::campaign
