#include "host_sim/compensation/comparison_report.hpp"

#include <cstdio>

#include "host_sim/report/report.hpp"

namespace host_sim::compensation {
namespace {

nlohmann::ordered_json number(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

std::string percent(const std::optional<double>& value) {
  return value ? report::figure_text(100.0 * *value, 3) + " %" : "unstable";
}

std::string milliseconds(const std::optional<double>& value) {
  return value ? report::figure_text(1e3 * *value, 3) : "none found";
}

report::Figure responses(const MethodComparison& comparison) {
  report::Panel magnitude{.y = {.quantity = "wheel load ÷ road", .unit = "N/m", .logarithmic = true}};
  report::Panel phase{.y = {.quantity = "phase", .unit = "°"}, .share = 0.6};
  const auto degrees = [](std::vector<double> values) {
    for (double& value : values) value *= 57.29577951308232;
    return values;
  };
  magnitude.curves.push_back({.name = "undelayed", .x = comparison.frequency_hz, .y = comparison.truth, .colour = 6});
  phase.curves.push_back({.name = "undelayed",
                          .x = comparison.frequency_hz,
                          .y = degrees(comparison.truth_phase),
                          .colour = 6,
                          .in_legend = false});
  int colour = 0;
  for (const MethodResult& method : comparison.methods) {
    if (!method.over_changes[0].stable) continue;
    magnitude.curves.push_back(
        {.name = method.name, .x = comparison.frequency_hz, .y = method.magnitude, .colour = colour % 6});
    phase.curves.push_back({.name = method.name,
                            .x = comparison.frequency_hz,
                            .y = degrees(method.phase),
                            .colour = colour % 6,
                            .in_legend = false});
    ++colour;
  }
  return {
      .title = "Wheel load over the road",
      .note = "Sampled loop with each compensator, against the loop without delay. Unstable loops have no response.",
      .x = {.quantity = "frequency", .unit = "Hz", .logarithmic = true},
      .panels = {magnitude, phase},
      .height = 560};
}

report::Figure mismatch(const MethodComparison& comparison) {
  std::vector<double> error;
  for (const double value : comparison.delay_error) error.push_back(1e3 * value);
  report::Panel panel{.y = {.quantity = "spectral radius", .unit = "1"}};
  int colour = 0;
  for (const MethodResult& method : comparison.methods) {
    panel.curves.push_back({.name = method.name,
                            .x = error,
                            .y = method.radius_over_error,
                            .colour = colour++ % 7,
                            .marker = report::Marker::circle});
  }
  panel.guides.push_back({.along = report::Guide::Along::y, .value = 1.0, .label = "border"});
  return {.title = "How wrong may the assumed delay be?",
          .note =
              "The loop is stable below 1. The true delay of the machine changes, the assumed one stays; "
              "adaptive_time_series follows it.",
          .x = {.quantity = "true − assumed delay", .unit = "ms"},
          .panels = {panel}};
}

}  // namespace

nlohmann::ordered_json to_json(const MethodComparison& comparison) {
  nlohmann::ordered_json json;
  json["machine_delay"] = comparison.delay;
  json["peak"] = {{"frequency_hz", comparison.peak_hz}, {"magnitude", comparison.peak}};
  auto& methods = json["methods"];
  for (const MethodResult& method : comparison.methods) {
    const LoopResult& plain = method.over_changes[0];
    auto& entry = methods[method.name];
    entry["stable"] = plain.stable;
    entry["spectral_radius"] = plain.spectral_radius;
    entry["critical_delay_error"] = number(method.critical_error);
    entry["critical_later"] = number(method.critical_later);
    entry["critical_earlier"] = number(method.critical_earlier);
    entry["peak_error"] = number(plain.peak_error);
    entry["tracking_nrmse"] = number(plain.tracking);
    entry["needs_component_model"] = method.needs_component_model;
    entry["assumes"] = method.assumes;
    for (std::size_t i = 1; i < change_names.size(); ++i) {
      const LoopResult& loop = method.over_changes[i];
      entry["robustness"][change_names[i]] = {
          {"stable", loop.stable}, {"peak_error", number(loop.peak_error)}, {"tracking_nrmse", number(loop.tracking)}};
    }
    entry["over_delay_error"] = {{"delay_error", comparison.delay_error},
                                 {"spectral_radius", method.radius_over_error}};
    entry["F_w/z_r"] = {{"magnitude", method.magnitude}, {"phase_rad", method.phase}};
  }
  json["frequency_hz"] = comparison.frequency_hz;
  json["undelayed"] = {{"magnitude", comparison.truth}, {"phase_rad", comparison.truth_phase}};
  return json;
}

std::string comparison_page(const MethodComparison& comparison, const firmware::RigDescription& description) {
  report::Report page("Delay compensation: " + description.source,
                      "Seven compensators on the described loop, against the same loop without delay.");
  const MethodResult* best = nullptr;
  for (const MethodResult& method : comparison.methods) {
    const auto& error = method.over_changes[0].peak_error;
    if (error && !method.needs_component_model && (best == nullptr || *error < *best->over_changes[0].peak_error)) {
      best = &method;
    }
  }
  if (best == nullptr) {
    page.add_verdict(report::Verdict::bad, "No method without a model of the component makes this loop stable.");
  } else {
    page.add_verdict(report::Verdict::good,
                     "Without a model of the component " + best->name +
                         " comes nearest to the undelayed loop: its wheel-load peak differs by " +
                         percent(best->over_changes[0].peak_error) + ".");
  }
  page.add_section("Responses");
  page.add_figure(responses(comparison));
  page.add_section("Robustness");
  report::Table table{.title = "Error of the wheel-load peak, against the undelayed loop of the same rig",
                      .headings = {"method"},
                      .rows = {}};
  for (const char* name : change_names) table.headings.emplace_back(name);
  for (const char* name : {"tracking error", "delay may be wrong by [ms]"}) table.headings.emplace_back(name);
  for (const MethodResult& method : comparison.methods) {
    std::vector<std::string> row{method.name};
    for (const LoopResult& loop : method.over_changes) row.push_back(percent(loop.peak_error));
    row.push_back(percent(method.over_changes[0].tracking));
    row.push_back(milliseconds(method.critical_error));
    table.rows.push_back(std::move(row));
  }
  page.add_table(table);
  page.add_figure(mismatch(comparison));
  page.add_section("Assumptions");
  report::Table assumes{.title = "What each method assumes",
                        .headings = {"method", "assumes", "model of the component"},
                        .rows = {},
                        .text_columns = 3};
  for (const MethodResult& method : comparison.methods) {
    assumes.rows.push_back({method.name, method.assumes, method.needs_component_model ? "yes" : "no"});
  }
  page.add_table(assumes);
  page.add_text(
      "A method with a model of the component puts the answer into the loop that a test for model validation asks for. "
      "The others use the machine alone, x_cmd to x_act; virtual damping needs no model either, but stays in the "
      "result.");
  page.add_appendix("Rig description", description.text);
  return page.html();
}

}  // namespace host_sim::compensation
