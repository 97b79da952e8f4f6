#include "host_sim/plan/plan_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "host_sim/identification/common/wording.hpp"
#include "host_sim/plan/thresholds.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::plan {
namespace {

using report::figure_text;

/// The effects whose leading parameter decides, once each.
struct Count {
  std::size_t all = 0, show = 0, named = 0;
};
Count count_of(const Plan& plan) {
  std::set<std::string> all, show, named;
  for (const PlannedEffect& effect : plan.effects) {
    const std::string name = words(effect.subject);
    all.insert(name);
    if (effect.why.empty()) show.insert(name);
    if (effect.named_at) named.insert(name);
  }
  return {all.size(), show.size(), named.size()};
}

void add_advice(report::Report& page, const Plan& plan) {
  page.add_section("What would help most");
  const std::vector<Advice> list = helpful(plan);
  for (const Advice& advice : list) page.add_text(sentence(advice));
  if (list.empty()) page.add_text(nothing_helps);
  if (plan.advice.empty()) return;
  report::Figure figure;
  figure.title = "How many times smaller effects may be";
  figure.note =
      "Mean over the effects of what is left beside the nearest rival, with the change ÷ without. Below 1 the change "
      "makes it worse.";
  figure.x = {"gain", "1"};
  report::Panel panel;
  panel.y.quantity = "change";
  panel.y.of_names = true;
  report::Bars bars{"gain", {}, {}, 0};
  for (const Advice& advice : plan.advice) {
    bars.names.push_back(advice.what);
    bars.values.push_back(advice.gain);
  }
  panel.bars.push_back(bars);
  panel.guides.push_back({report::Guide::Along::x, 1.0, "as planned"});
  figure.panels.push_back(panel);
  figure.height = 140 + 26 * static_cast<int>(plan.advice.size());
  page.add_figure(figure);
}

/// A size in units of the one at which a fit would start: comparable between effects. "–" where there is none.
std::string relative(const PlannedEffect& effect, std::optional<double> size) {
  const double neutral =
      effect.subject.values.empty() ? 0.0 : effect.subject.entry->parameters[effect.parameter].neutral;
  const double typical = effect.at_default.value - neutral;
  if (!size || typical == 0.0) return "–";
  return figure_text(std::abs((*size - neutral) / typical), 2);
}

/// The leading row of each effect: the first that has a size.
std::vector<const PlannedEffect*> leading_rows(const Plan& plan) {
  std::vector<const PlannedEffect*> rows;
  std::set<std::string> seen;
  for (const PlannedEffect& effect : plan.effects) {
    if (effect.why.empty() && seen.insert(words(effect.subject)).second) rows.push_back(&effect);
  }
  return rows;
}

std::string listed(const std::vector<std::string>& names, std::size_t most) {
  std::vector<std::string> some(names.begin(),
                                names.begin() + static_cast<std::ptrdiff_t>(std::min(most, names.size())));
  if (names.size() <= most) return identification::joined(some);
  std::string text;
  for (const std::string& name : some) text += (text.empty() ? "" : ", ") + name;
  return text + " and " + std::to_string(names.size() - most) + " more";
}

/// The one picture: how strongly each effect of a usual size shows, the strongest first.
void add_picture(report::Report& page, const Plan& plan) {
  report::Figure figure;
  figure.title = "How strongly an effect of a typical size would show";
  figure.note =
      "In standard deviations of the noise, with the tolerances refitted; typical: where a fit of the effect would "
      "start. "
      "At 3 an effect shows, at 10 it can be named.";
  figure.x = {"strength", "σ", true};
  report::Panel panel;
  panel.y.quantity = "effect";
  panel.y.of_names = true;
  report::Bars bars{"strength", {}, {}, 0};
  for (const PlannedEffect* effect : leading_rows(plan)) {
    const double strength = effect->at_default.significance;
    if (!(strength > 0.0) || !std::isfinite(strength)) continue;
    bars.names.push_back(words(effect->subject));
    bars.values.push_back(strength);
  }
  if (bars.names.empty()) return;
  figure.height = 130 + 20 * static_cast<int>(bars.names.size());
  panel.bars.push_back(std::move(bars));
  panel.guides.push_back({report::Guide::Along::x, thresholds::shows, "shows"});
  panel.guides.push_back({report::Guide::Along::x, thresholds::told_apart, "named"});
  figure.panels.push_back(std::move(panel));
  page.add_figure(figure);
}

void add_effects(report::Report& page, const Plan& plan) {
  page.add_section("From which size effects show");
  page.add_text(
      "An effect shows at three standard deviations, with the tolerances refitted. It is named at ten beside its "
      "nearest rival. Sizes stand in their own unit and, to compare them, in units of a typical size of the effect: "
      "below "
      "1 a typical effect is seen.");
  report::Table table{"All sizes, the strongest effect first",
                      {"effect", "parameter", "nearest rival", "left beside it [σ of 10]", "shows at", "÷ typical",
                       "named at", "÷ typical", "typical size", "strength there [σ]"},
                      {},
                      3};
  report::Table silent{"Effects without a size here", {"effect", "parameter", "why"}, {}, 3};
  for (const PlannedEffect& effect : plan.effects) {
    const bool has_parameter = !effect.subject.values.empty();
    const std::string parameter =
        has_parameter ? std::string(effect.subject.entry->parameters[effect.parameter].name) : "";
    if (!effect.why.empty()) {
      silent.rows.push_back({words(effect.subject), parameter, effect.why});
      continue;
    }
    std::string nearest, left;
    if (!effect.taken_for.empty()) {
      nearest = effect.taken_for.front().name;
      left = figure_text(effect.taken_for.front().left, 2);
    }
    table.rows.push_back(
        {words(effect.subject), parameter, nearest, left, effect.shows_at ? value_text(effect, *effect.shows_at) : "–",
         relative(effect, effect.shows_at), effect.named_at ? value_text(effect, *effect.named_at) : "–",
         relative(effect, effect.named_at), has_parameter ? value_text(effect, effect.at_default.value) : "–",
         figure_text(effect.at_default.significance, 3)});
  }
  page.add_folded_table(table);
  if (!silent.rows.empty()) page.add_folded_table(silent);
}

void add_matrix(report::Report& page, const Plan& plan) {
  const SeparationMatrix& matrix = plan.separations;
  if (matrix.rows.empty() || matrix.columns.empty()) return;
  page.add_section("What would be taken for what");
  report::Figure figure;
  figure.title = "What is left of an effect of ten standard deviations with another refitted in its place";
  figure.note =
      "Rows: the effect that is there. Columns: the effect or parameter that is refitted instead. White: nothing is "
      "left, "
      "this experiment does not tell them apart. The numbers of rows and columns are listed below.";
  figure.x = {"refitted instead", "number"};
  report::HeatMap map;
  map.quantity = "left";
  map.unit = "σ";
  map.limit = thresholds::told_apart;
  for (std::size_t c = 0; c < matrix.columns.size(); ++c) map.x.push_back(static_cast<double>(c + 1));
  report::Table numbers{"Numbers of rows and columns", {"name", "row", "column"}, {}, 1};
  for (const std::string& row : matrix.rows) {
    const auto column = std::find(matrix.columns.begin(), matrix.columns.end(), row);
    map.y.push_back(static_cast<double>(column - matrix.columns.begin() + 1));
  }
  map.values = matrix.left;
  report::Panel panel;
  panel.y = {"effect that is there", "number"};
  panel.heat_map.push_back(map);
  figure.panels.push_back(panel);
  figure.height = 620;
  page.add_figure(figure);
  for (std::size_t c = 0; c < matrix.columns.size(); ++c) {
    const bool row = std::find(matrix.rows.begin(), matrix.rows.end(), matrix.columns[c]) != matrix.rows.end();
    const std::string number = std::to_string(c + 1);
    numbers.rows.push_back({matrix.columns[c], row ? number : "–", number});
  }
  page.add_folded_table(numbers);
}

void add_parameters(report::Report& page, const Plan& plan) {
  page.add_section("How well parameters are determined");
  page.add_text(
      "Half widths of relative 95 % intervals: with nothing else known of the rig, and with the others as described "
      "within their tolerances.");
  report::Table table{
      "All parameters",
      {"parameter", "remark", "described", "tolerance [%]", "nothing else known [± %]", "beside tolerances [± %]"},
      {},
      2};
  for (const PlannedParameter& p : plan.parameters) {
    table.rows.push_back({p.path,
                          !p.why.empty() ? p.why
                          : p.open()     ? "open"
                                         : "",
                          figure_text(p.described, 5), p.tolerance > 0.0 ? figure_text(100.0 * p.tolerance, 3) : "–",
                          figure_text(100.0 * p.determined_to, 2), figure_text(100.0 * p.beside_tolerances, 2)});
  }
  page.add_folded_table(table);
  for (const OpenCombination& open : plan.open) {
    page.add_text("Undetermined: " + open.combination + " (" + open.why + ").");
  }
}

}  // namespace

std::string value_text(const PlannedEffect& effect, double value) {
  const double neutral = effect.subject.entry->parameters[effect.parameter].neutral;
  // Enough digits for three of the difference to the value without effect.
  const double size = std::abs(value - neutral);
  const int more = neutral != 0.0 && size > 0.0 ? static_cast<int>(std::ceil(std::log10(std::abs(value) / size))) : 0;
  const std::string unit = unit_of(effect.subject, effect.parameter);
  return figure_text(value, 3 + std::clamp(more, 0, 9)) + (unit.empty() ? "" : " " + unit);
}

std::vector<Advice> helpful(const Plan& plan) {
  std::vector<Advice> list;
  for (const Advice& advice : plan.advice) {
    if (advice.gain >= thresholds::worth_saying || !advice.determines.empty()) list.push_back(advice);
  }
  return list;
}

std::string sentence(const Advice& advice) {
  std::string text = advice.what;
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z')
    text.front() = static_cast<char>(text.front() - 'a' + 'A');
  text += advice.gain >= thresholds::worth_saying
              ? ": the smallest effect that shows is " + figure_text(advice.gain, 2) + " times smaller on average"
              : ": on average effects show at the same size";
  if (!advice.helps.empty() && advice.most > thresholds::worth_saying) {
    text += "; it helps most to see " + advice.helps + " (" +
            (advice.most >= thresholds::most_gain ? "more than 10" : figure_text(advice.most, 2)) + " times smaller)";
  }
  if (!advice.determines.empty()) text += "; it determines " + identification::joined(advice.determines);
  return text + ".";
}

std::string summary(const Plan& plan) {
  const Count count = count_of(plan);
  std::string text = "Of " + std::to_string(count.all) + " effects " + std::to_string(count.show) +
                     " would show in this experiment, " + std::to_string(count.named) +
                     " of them large enough to be told from every other";
  if (!plan.open.empty()) {
    text += "; " + std::to_string(plan.open.size()) +
            (plan.open.size() == 1 ? " combination of parameters stays" : " combinations of parameters stay") + " open";
  }
  return text + ".";
}

std::vector<std::string> sentences(const Plan& plan) {
  std::vector<std::string> list{summary(plan)};
  std::vector<std::string> known, open;
  constexpr double well = 0.05;  // ± 5 %
  for (const PlannedParameter& p : plan.parameters) {
    if (!p.why.empty()) continue;
    if (p.beside_tolerances <= well)
      known.push_back(p.path + " to " + figure_text(100.0 * p.beside_tolerances, 2) + " %");
    if (p.open()) open.push_back(p.path);
  }
  list.push_back(known.empty() ? "No parameter would be known to 5 %."
                               : "It would determine " + listed(known, 4) + ".");
  std::vector<std::string> silent;
  std::set<std::string> shown, quiet;
  for (const PlannedEffect& effect : plan.effects) {
    if (effect.why.empty()) shown.insert(words(effect.subject));
  }
  for (const PlannedEffect& effect : plan.effects) {
    const std::string name = words(effect.subject);
    if (!effect.why.empty() && !shown.contains(name) && quiet.insert(name).second) silent.push_back(name);
  }
  std::string cannot;
  if (!silent.empty()) cannot = "It would not show " + listed(silent, 4);
  if (!plan.open.empty()) {
    cannot += (cannot.empty() ? "It leaves open " : ", and it leaves open ") + plan.open.front().combination + " (" +
              plan.open.front().why + ")";
  } else if (!open.empty()) {
    cannot += (cannot.empty() ? "It leaves open " : ", and it leaves open ") + listed(open, 4);
  }
  list.push_back(cannot.empty() ? "Every effect would show, and no parameter stays open." : cannot + ".");
  std::vector<std::string> confused;
  for (const PlannedEffect* effect : leading_rows(plan)) {
    if (effect->named_at || effect->taken_for.empty()) continue;
    confused.push_back(words(effect->subject) + " from " + effect->taken_for.front().name);
  }
  list.push_back(confused.empty() ? "Every effect that shows would be told from the others at some size."
                                  : "At no size that was tried would it tell " + listed(confused, 3) + ".");
  const std::vector<Advice> advice = helpful(plan);
  list.push_back(advice.empty() ? std::string(nothing_helps) : "To change: " + sentence(advice.front()));
  return list;
}

std::string report_html(const Plan& plan, const firmware::RigDescription& description, const std::string& road) {
  std::vector<std::string> channels;
  for (const model::Channel channel : plan.channels) channels.emplace_back(model::name(channel));
  report::Report page("Plan for " + description.source,
                      "A " + std::string(model::name(description.rig.kind)) + " rig, " + figure_text(plan.duration, 4) +
                          " s over " + road + ", compared in " + identification::joined(channels) + ".");
  const std::vector<std::string> first = sentences(plan);
  page.add_verdict(report::Verdict::remark, first.front());
  for (std::size_t i = 1; i < first.size(); ++i) page.add_text(first[i]);
  add_picture(page, plan);
  add_advice(page, plan);
  add_effects(page, plan);
  add_matrix(page, plan);
  add_parameters(page, plan);
  for (const std::string& remark : plan.remarks) page.add_text(remark + ".");
  page.add_appendix("Rig description", description.text);
  return page.html();
}

}  // namespace host_sim::plan
