#include "host_sim/identification/report/law_figure.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "host_sim/identification/report/confidence_text.hpp"

namespace host_sim::identification {
namespace {

using report::Curve;
using report::Dash;
using report::Figure;
using report::figure_text;
using report::Panel;

/// Where a law does most of its change within a twentieth of what is drawn – friction that sets in over 3 mm/s of
/// 1.2 m/s – it is drawn once more, that part alone, over its own axis.
std::optional<double> middle_of(const DescribedLaw& law) {
  if (law.at.size() < 3) return std::nullopt;
  const double far = std::max(std::abs(law.at.front()), std::abs(law.at.back()));
  const double most = std::max(std::abs(law.force.front()), std::abs(law.force.back()));
  for (std::size_t i = 0; i < law.at.size(); ++i) {
    constexpr double narrow = 0.05, half = 0.5;
    if (law.at[i] > 0.0 && std::abs(law.force[i]) >= half * most) {
      if (law.at[i] <= narrow * far) return 10.0 * law.at[i];
      return std::nullopt;
    }
  }
  return std::nullopt;
}

/// Force over the motion: what the rig did as points, curves, and where the recordings excited it.
Figure figure_of(const DescribedLaw& law, std::string title, std::string note, std::vector<Curve> curves) {
  Figure figure;
  figure.title = std::move(title) + " at the " + std::string(name(law.law.place));
  figure.note = std::move(note);
  figure.x = {std::string(name(law.law.over == CurveOver::velocity ? CurveOver::velocity : CurveOver::deflection)),
              law.law.over == CurveOver::velocity ? "m/s" : "m"};
  Panel panel;
  panel.y = {"force", "N"};
  if (!law.seen_at.empty()) {
    panel.curves.push_back({"measured", law.seen_at, law.seen_force, 6, Dash::none});
    panel.curves.back().marker = report::Marker::circle;
  }
  panel.curves.insert(panel.curves.end(), curves.begin(), curves.end());
  panel.guides.push_back({report::Guide::Along::x, law.lowest, "excited"});
  panel.guides.push_back({report::Guide::Along::x, law.highest, ""});
  figure.panels.push_back(std::move(panel));
  return figure;
}

/// The figure of a law, and the middle of it alone where the law is steep there.
void add_figure_of(report::Report& page, const DescribedLaw& law, Figure figure) {
  page.add_figure(figure);
  const auto middle = middle_of(law);
  if (!middle) return;
  figure.title += ", near zero";
  figure.note = "The same over ± " + figure_text(*middle, 2) + " " + figure.x.unit + ".";
  figure.x.range = std::pair(-*middle, *middle);
  page.add_figure(figure);
}

Figure figure_of_learned(const DescribedLaw& law) {
  const bool loops = !law.loop_at.empty();
  std::vector<Curve> curves;
  if (loops) curves.push_back({"law along the motion", law.loop_at, law.loop_force, 0, Dash::solid});
  curves.push_back({loops ? "from rest" : "law", law.at, law.force, loops ? 2 : 0, loops ? Dash::dashed : Dash::solid});
  curves.push_back({"95 % band", law.at, law.lower, 0, Dash::dotted});
  curves.push_back({"95 % band", law.at, law.upper, 0, Dash::dotted});
  curves.back().in_legend = false;
  const std::string at_velocity = is_surface(law.law.family)
                                      ? " The line is a section of a surface: the force at " +
                                            figure_text(law.law.rms_velocity, 3) + " m/s, the rms of the velocity."
                                      : "";
  curves.push_back({"rig as described", {law.at.front(), law.at.back()}, {0.0, 0.0}, 1, Dash::dashed});
  return figure_of(law, "Learned law",
                   "Force that the law adds to the rig as described, with its 95 % band. Points: the law at the "
                   "simulated motion plus the force that the residual stands for, of data that were not fitted where "
                   "there are any. Between the two lines the recordings excited it; beyond them it is continued "
                   "straight." +
                       at_velocity,
                   std::move(curves));
}

Figure figure_of_sections(const DescribedLaw& law) {
  Figure figure;
  figure.title = "The same law over the velocity";
  figure.note =
      "Sections of the surface at three deflections, with their 95 % bands: where they differ, the damping depends on "
      "the stroke. A band grows where the rig was seldom.";
  figure.x = {"velocity", "m/s"};
  Panel panel;
  panel.y = {"force", "N"};
  int colour = 0;
  for (const LawSection& section : law.sections) {
    panel.curves.push_back(
        {"at " + figure_text(1e3 * section.deflection, 3) + " mm", section.at, section.force, colour, Dash::solid});
    for (const std::vector<double>* end : {&section.lower, &section.upper}) {
      panel.curves.push_back({"95 % band", section.at, *end, colour, Dash::dotted});
      panel.curves.back().in_legend = false;
    }
    ++colour;
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

Figure figure_of_described(const DescribedLaw& law) {
  return figure_of(
      law, "[laws." + law.words + "]",
      "The curve of the rig description, and what the rig did: the curve's force at the simulated motion "
      "plus the force that the residual stands for, with only tolerances refitted. Points beside the curve "
      "are a disagreement, whichever part of the rig causes it.",
      {{"as described", law.at, law.force, 1, Dash::solid}});
}

}  // namespace

std::string words(const DescribedLaw& law) {
  return std::string(name(law.law.place)) + ": " + law.words + " (" + law.shape + " over " +
         std::string(name(law.law.over)) + ")";
}

/// Of a law's number, by its name and by what the law goes over.
std::string unit_of(const DescribedLaw& law, const LawNumber& number) {
  const bool velocity = law.law.over == CurveOver::velocity;
  const std::string &name = number.name, slope = velocity ? "N s/m" : "N/m";
  if (name == "exponent" || name == "share_of_load" || name == "lost_motion") return "1";
  if (name == "rebound_harder_by_per_cent") return "%";
  if (name == "force" || name == "break_away" || name == "sliding") return "N";
  if (name == "velocity") return "m/s";
  if (name == "half_travel") return "m";
  if (name == "time_constant") return "s";
  if (name == "stiffness") return "N/m";
  if (name == "from" || name == "half_at") return velocity ? "m/s" : "m";
  if (name.starts_with("damping")) return "N s/m";
  const bool powers = std::any_of(law.numbers.begin(), law.numbers.end(),
                                  [](const LawNumber& other) { return other.name == "exponent"; });
  if (!powers) return slope;
  return name == "coefficient" || name == "compression" || name == "rebound"
             ? std::string("N/(") + (velocity ? "m/s" : "m") + ")^exponent"
             : slope;
}

std::string words(const NextStep& next, model::RigKind rig) {
  return "to tell " + next.one + " from " + next.other + ", run " + figure_text(next.test.frequency, 3) + " Hz at ± " +
         figure_text(1e3 * next.test.amplitude, 3) + " mm" +
         (rig == model::RigKind::component_bench ? "" : " with the component alone on a bench") +
         " (a second of it separates them " + figure_text(next.test.separates, 2) +
         " times as well as one recorded here)";
}

void add_described_curves(report::Report& page, const std::vector<DescribedLaw>& curves) {
  if (curves.empty()) return;
  page.add_section("Laws of the rig description");
  for (const DescribedLaw& curve : curves) add_figure_of(page, curve, figure_of_described(curve));
}

void add_laws(report::Report& page, const std::vector<DescribedLaw>& laws) {
  if (laws.empty()) return;
  page.add_section("Laws that the catalogue does not hold");
  report::Table table{"", {"law", "number", "unit", "value", "95 % from", "to", "confidence"}, {}, 3};
  for (const DescribedLaw& law : laws) {
    bool first = true;
    for (const LawNumber& number : law.numbers) {
      table.rows.push_back({first ? words(law) : "", number.name, unit_of(law, number), figure_text(number.value, 4),
                            figure_text(number.lower, 4), figure_text(number.upper, 4),
                            first ? confidence_text(law.confidence) : ""});
      first = false;
    }
    if (law.numbers.empty()) table.rows.push_back({words(law), "–", "", "", "", "", confidence_text(law.confidence)});
  }
  page.add_table(table);
  for (const DescribedLaw& law : laws) {
    add_figure_of(page, law, figure_of_learned(law));
    if (!law.sections.empty()) page.add_figure(figure_of_sections(law));
  }
}

}  // namespace host_sim::identification
