#include "host_sim/transfer/report/transfer_report.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/report/report.hpp"
#include "host_sim/transfer/common/thresholds.hpp"
#include "host_sim/transfer/posterior/component_part.hpp"
#include "host_sim/transfer/report/wording.hpp"

namespace host_sim::transfer {
namespace {

using report::figure_text;

constexpr std::array<std::string_view, 2> titles{"Wheel load ÷ road", "Body acceleration ÷ road"};
constexpr std::array<std::string_view, source_count> source_words{
    "component's parameters", "rival effects", "discrepancy", "second rig", "noise", "calibration"};

std::vector<double> part_of(const std::vector<Bands>& bands, double Bands::*part) {
  std::vector<double> values;
  for (const Bands& b : bands) values.push_back(b.*part);
  return values;
}

std::vector<double> magnitudes(const std::vector<std::complex<double>>& response) {
  std::vector<double> values;
  for (const auto& h : response) values.push_back(std::abs(h));
  return values;
}

report::Curve curve(std::string name, const std::vector<double>& x, std::vector<double> y, int colour,
                    report::Dash dash) {
  report::Curve c;
  c.name = std::move(name);
  c.x = x;
  c.y = std::move(y);
  c.colour = colour;
  c.dash = dash;
  return c;
}

/// Median, 50 and 95 % limits; the measurement above them.
void add_bands(const std::vector<double>& f, const std::vector<Bands>& bands, const std::vector<double>& measured,
               report::Panel& panel) {
  using report::Dash;
  panel.curves.push_back(curve("median", f, part_of(bands, &Bands::median), 0, Dash::solid));
  panel.curves.push_back(curve("50 % band", f, part_of(bands, &Bands::low50), 0, Dash::dashed));
  panel.curves.push_back(curve("50 % band, upper", f, part_of(bands, &Bands::high50), 0, Dash::dashed));
  panel.curves.back().in_legend = false;
  panel.curves.push_back(curve("95 % band", f, part_of(bands, &Bands::low95), 4, Dash::dotted));
  panel.curves.push_back(curve("95 % band, upper", f, part_of(bands, &Bands::high95), 4, Dash::dotted));
  panel.curves.back().in_legend = false;
  if (measured.empty()) return;
  report::Curve points = curve("measured", f, measured, 1, Dash::none);
  points.marker = report::Marker::circle;
  panel.curves.push_back(std::move(points));
}

/// The same relative to the median: a band of a per cent is a line in the response itself.
void add_relative(const std::vector<double>& f, const std::vector<Bands>& bands, const std::vector<double>& measured,
                  report::Panel& panel) {
  std::vector<Bands> relative;
  std::vector<double> points;
  for (std::size_t k = 0; k < bands.size(); ++k) {
    const double m = std::max(bands[k].median, 1e-300);
    const auto share = [m](double value) { return 100.0 * (value / m - 1.0); };
    relative.push_back(
        {0.0, share(bands[k].low50), share(bands[k].high50), share(bands[k].low95), share(bands[k].high95)});
    if (!measured.empty()) points.push_back(share(measured[k]));
  }
  add_bands(f, relative, points, panel);
  for (report::Curve& c : panel.curves) c.in_legend = false;
}

void add_responses(const Transfer& t, report::Report& page) {
  const std::vector<double>& f = t.second.analysis->frequencies();
  for (std::size_t r = 0; r < 2; ++r) {
    const std::vector<Bands> bands = t.prediction.response(r);
    if (bands.empty()) continue;
    const std::vector<double> measured =
        t.validation ? magnitudes(t.validation->measured.response[r]) : std::vector<double>{};
    report::Figure figure;
    figure.title = std::string(titles[r]) + ": predicted bands" + (measured.empty() ? "" : " and measurement");
    figure.x = {"frequency", "Hz", true};
    report::Panel response;
    response.y = {std::string(response_names[r]), std::string(response_units[r]), true};
    add_bands(f, bands, measured, response);
    report::Panel deviation;
    deviation.y = {"from the median", "%"};
    deviation.share = 0.7;
    add_relative(f, bands, measured, deviation);
    figure.panels = {std::move(response), std::move(deviation)};
    figure.height = 460;
    page.add_figure(figure);
  }
}

void add_budget(const Transfer& t, report::Report& page) {
  report::Figure figure;
  figure.title = "Budget of the uncertainty: share of the variance";
  figure.note =
      "Each source varied alone, all others at their centre; the shares of a quantity add up to 100 %. A source "
      "without "
      "a bar has no share.";
  figure.x = {"share of the variance", "%"};
  figure.x.range = std::pair{0.0, 112.0};  // room for the number beside a whole bar
  report::Panel panel;
  panel.y.quantity = "source";
  panel.y.of_names = true;
  const std::array<Quantity, 3> shown{Quantity::rms_F_w, Quantity::weighted_zdd_b, Quantity::rms_dz_b};
  int colour = 0;
  for (const Quantity q : shown) {
    report::Bars bars{std::string(quantity_names[static_cast<std::size_t>(q)]), {}, {}, colour++};
    for (std::size_t s = 0; s < source_count; ++s) {
      constexpr double nothing = 5e-4;
      const bool has_share = std::any_of(shown.begin(), shown.end(), [&](Quantity of) {
        return t.prediction.budget[static_cast<std::size_t>(of)][s] >= nothing;
      });
      if (!has_share) continue;
      bars.names.emplace_back(source_words[s]);
      bars.values.push_back(100.0 * t.prediction.budget[static_cast<std::size_t>(q)][s]);
    }
    if (!bars.names.empty()) panel.bars.push_back(std::move(bars));
  }
  if (panel.bars.empty()) return;
  figure.panels.push_back(std::move(panel));
  figure.height = 340;
  page.add_figure(figure);
}

void add_quantities(const Transfer& t, report::Report& page) {
  report::Table table{"", {"quantity", "unit", "median", "50 % band", "95 % band", "measured", "area metric"}, {}, 2};
  if (t.naive) table.headings.emplace_back("naive 95 % band");
  for (std::size_t q = 0; q < quantity_count; ++q) {
    const Bands b = t.prediction.quantity(static_cast<Quantity>(q));
    std::vector<std::string> row{std::string(quantity_names[q]),
                                 std::string(quantity_units[q]),
                                 figure_text(b.median),
                                 figure_text(b.low50) + " … " + figure_text(b.high50),
                                 figure_text(b.low95) + " … " + figure_text(b.high95),
                                 "–",
                                 "–"};
    if (t.validation && std::isfinite(t.validation->measured.quantity[q])) {
      row[5] = figure_text(t.validation->measured.quantity[q]);
      row[6] = figure_text(t.validation->quantity_area[q], 3);
    }
    if (t.naive) {
      const Bands n = t.naive->prediction.quantity(static_cast<Quantity>(q));
      row.push_back(figure_text(n.low95) + " … " + figure_text(n.high95));
    }
    table.rows.push_back(std::move(row));
  }
  page.add_table(table);
}

void add_validation(const Transfer& t, report::Report& page) {
  if (!t.validation) return;
  page.add_section("Validation");
  const Validation& v = *t.validation;
  page.add_text("Lines within the 50 % band: " + per_cent(v.coverage50) +
                ", within the 95 % band: " + per_cent(v.coverage95) + ". Log score " + figure_text(v.log_score, 3) +
                " (smaller is better). The area metric is the mean distance of the predicted distribution from the "
                "measured value (Ferson et al. 2008).");
  report::Table metric{"Area metric", {"response", "in its unit", "share of rms"}, {}, 1};
  for (std::size_t r = 0; r < 2; ++r) {
    if (v.measured.response[r].empty()) continue;
    metric.rows.push_back({std::string(response_names[r]),
                           figure_text(v.area[r], 3) + " " + std::string(response_units[r]),
                           per_cent(v.area_share[r])});
  }
  page.add_table(metric);
  report::Table table{
      "By band", {"response", "verdict", "band [Hz]", "p", "deviation", "band ±", "stiffness", "damping"}, {}, 2};
  for (const BandCheck& b : v.bands) {
    table.rows.push_back({std::string(response_names[b.response]), b.holds ? "holds" : "does not hold",
                          figure_text(b.lowest, 3) + " … " + figure_text(b.highest, 3), figure_text(b.p, 2),
                          per_cent(b.deviation), per_cent(b.half_width), per_cent(b.force.real()),
                          per_cent(b.force.imag())});
  }
  page.add_table(table);
  page.add_text(
      "p: probability of a deviation as large by chance (posterior predictive, χ² over the lines of the band). "
      "Stiffness and damping: the share of its force that the component lacks, in phase with its deflection and a "
      "quarter period before it.");
  if (t.with_own && t.with_own->validation) {
    page.add_verdict(t.with_own->validation->holds ? report::Verdict::good : report::Verdict::bad,
                     "With the second rig's own effects as its recordings show them, " +
                         per_cent(t.with_own->validation->coverage95) + " of the lines lie in the 95 % band.");
  }
}

void add_effects(const Transfer& t, report::Report& page) {
  page.add_section("What travels and what stays");
  const auto list = [&](const char* title, const std::vector<OwnedEffect>& effects) {
    for (const OwnedEffect& effect : effects) page.add_text(std::string(title) + words(effect));
  };
  list("Travels: ", t.both.travels);
  list("Stays on the first rig: ", t.both.stays);
  list("On the second rig alone: ", t.both.second_only);
  list("Of the component, seen on the second rig only: ", t.both.component_on_second_only);
  for (const std::string& name : t.both.not_seen_on_second) {
    page.add_text("Carried over, and not named by the second rig's own diagnosis: " + name);
  }
  report::Table table{
      "Parameters after the first rig", {"parameter", "unit", "used for", "value", "95 % interval"}, {}, 3};
  for (const LearnedValue& v : t.posterior.learned) {
    table.rows.push_back({v.path, v.unit, v.travels ? "the second rig" : "the first rig alone", figure_text(v.value, 5),
                          figure_text(v.lower, 5) + " … " + figure_text(v.upper, 5)});
  }
  page.add_table(table);
  if (t.both.shared.empty()) return;
  report::Table both{"The same value on both rigs",
                     {"parameter", "verdict", "first rig", "second rig", "distance [σ]", "pooled"},
                     {},
                     2};
  for (const SharedValue& s : t.both.shared) {
    both.rows.push_back({s.path, s.equal ? "equal" : "not equal", figure_text(s.first.value, 5),
                         figure_text(s.second.value, 5), figure_text(std::abs(s.z), 2),
                         s.equal ? figure_text(s.pooled.value, 5) : "–"});
  }
  page.add_table(both);
}

void add_posterior(const Transfer& t, report::Report& page) {
  page.add_section("Posterior");
  const Posterior& p = t.posterior;
  page.add_text(std::to_string(p.draws) + " draws, R-hat " + figure_text(p.largest_rhat) + ", " +
                figure_text(p.fewest_effective, 3) + " effective draws of the slowest parameter, " +
                per_cent(p.accepted) + " of the proposals accepted.");
  for (const std::string& warning : p.warnings) page.add_verdict(report::Verdict::remark, warning);
  report::Table table{"Models that the first rig's recordings leave open", {"model", "probability"}, {}, 1};
  for (const ComponentModel& model : p.models) {
    table.rows.push_back({model.name, figure_text(model.probability, 3)});
  }
  page.add_table(table);
  page.add_text(discrepancy_text(p));
}

void add_naive(const Transfer& t, report::Report& page) {
  if (!t.naive) return;
  page.add_section("The naive way beside it");
  std::string text =
      "The component fitted with the first rig's own effects ignored, carried over with the intervals of that fit.";
  if (t.naive->validation) {
    text += " " + per_cent(t.naive->validation->coverage95) +
            " of the measured lines lie in its 95 % band; with the "
            "first rig's own effects told apart " +
            per_cent(t.validation->coverage95) + ".";
  }
  page.add_text(text);
  const std::vector<double>& f = t.second.analysis->frequencies();
  report::Figure figure;
  figure.title = "Wheel load ÷ road, relative to the prediction's median";
  figure.x = {"frequency", "Hz", true};
  report::Panel panel;
  panel.y = {"from the median", "%"};
  const std::vector<Bands> ours = t.prediction.response(0), naive = t.naive->prediction.response(0);
  const auto relative = [&](const std::vector<Bands>& bands, double Bands::*part) {
    std::vector<double> values;
    for (std::size_t k = 0; k < bands.size(); ++k) {
      values.push_back(100.0 * (bands[k].*part / std::max(ours[k].median, 1e-300) - 1.0));
    }
    return values;
  };
  using report::Dash;
  panel.curves.push_back(curve("naive 95 % band", f, relative(naive, &Bands::low95), 3, Dash::solid));
  panel.curves.push_back(curve("naive, upper", f, relative(naive, &Bands::high95), 3, Dash::solid));
  panel.curves.back().in_legend = false;
  panel.curves.push_back(curve("95 % band", f, relative(ours, &Bands::low95), 0, Dash::dotted));
  panel.curves.push_back(curve("upper", f, relative(ours, &Bands::high95), 0, Dash::dotted));
  panel.curves.back().in_legend = false;
  if (t.validation && !t.validation->measured.response[0].empty()) {
    std::vector<double> points = magnitudes(t.validation->measured.response[0]);
    for (std::size_t k = 0; k < points.size(); ++k) {
      points[k] = 100.0 * (points[k] / std::max(ours[k].median, 1e-300) - 1.0);
    }
    report::Curve measured = curve("measured", f, std::move(points), 1, Dash::none);
    measured.marker = report::Marker::circle;
    panel.curves.push_back(std::move(measured));
  }
  figure.panels.push_back(std::move(panel));
  page.add_figure(figure);
}

void add_spectra(const Transfer& t, report::Report& page) {
  page.add_section("Spectra");
  const std::vector<double>& f = t.second.analysis->frequencies();
  constexpr std::array<std::string_view, 2> names{"wheel load", "body acceleration"}, units{"N²/Hz", "(m/s²)²/Hz"};
  report::Figure figure;
  figure.title = "Spectra of wheel load and body acceleration";
  figure.x = {"frequency", "Hz", true};
  for (std::size_t r = 0; r < 2; ++r) {
    report::Panel panel;
    panel.y = {std::string(names[r]), std::string(units[r]), true};
    add_bands(f, t.prediction.density(r), t.validation ? t.validation->measured.density[r] : std::vector<double>{},
              panel);
    if (r > 0) {
      for (report::Curve& c : panel.curves) c.in_legend = false;
    }
    figure.panels.push_back(std::move(panel));
  }
  figure.height = 520;
  page.add_figure(figure);
}

void add_next(const Transfer& t, report::Report& page) {
  if (t.next.list.empty()) return;
  page.add_section("The next measurement on the first rig");
  page.add_text("Expected, for one more minute: " + words(t.next.list.front()) + ".");
  report::Figure figure;
  figure.title = "The component's part of the bands, with the measurement ÷ without";
  figure.x = {"remaining width", "%"};
  report::Panel panel;
  panel.y.quantity = "measurement";
  panel.y.of_names = true;
  report::Bars bars{"remaining", {}, {}, 2};
  for (const NextMeasurement& next : t.next.list) {
    bars.names.push_back(next.what);
    bars.values.push_back(100.0 * next.remaining);
  }
  panel.bars.push_back(std::move(bars));
  figure.panels.push_back(std::move(panel));
  figure.height = 140 + 24 * static_cast<int>(t.next.list.size());
  page.add_figure(figure);
}

/// Ten seconds from the middle of the first run.
void add_traces(const Transfer& t, const firmware::RigDescription& from, report::Report& page) {
  page.add_section("Traces");
  const auto& drive = t.second.drives.front();
  const auto rig = with_component(t.second.description.rig, from.rig, t.posterior.diagnosed().hypothesis);
  const std::vector<Response> run = t.second.run({rig}).front();
  const std::size_t count = drive.size();
  const auto length = std::min(count, static_cast<std::size_t>(10.0 / drive.input.period));
  const std::size_t first = (count - length) / 2, every = std::max<std::size_t>(1, length / 2500);
  report::Figure figure;
  figure.title = "Predicted" + std::string(t.validation ? " and measured" : "") + " motion";
  figure.note = "The prediction is that of the diagnosed model, at the middle of its posterior.";
  figure.x = {"time", "s"};
  for (const model::Channel channel : outcome_channels) {
    report::Panel panel;
    panel.y = {std::string(model::name(channel)), std::string(model::unit(channel))};
    const auto add = [&](const std::vector<double>& values, const char* name, int colour) {
      if (values.size() != count) return;
      report::Curve c;
      c.name = name;
      c.colour = colour;
      c.dash = report::Dash::solid;
      c.in_legend = channel == outcome_channels[0];
      for (std::size_t k = first; k < first + length; k += every) {
        c.x.push_back(drive.recording.time[k]);
        c.y.push_back(values[k]);
      }
      panel.curves.push_back(std::move(c));
    };
    if (t.validation) add(t.second.measured.front()[index(channel)], "measured", 1);
    add(run.front()[index(channel)], "predicted", 0);
    figure.panels.push_back(std::move(panel));
  }
  figure.height = 560;
  page.add_figure(figure);
}

}  // namespace

std::string report_html(const Transfer& t, const firmware::RigDescription& from, const firmware::RigDescription& to) {
  report::Report page("From one rig to the other",
                      "The component of " + from.source + ", learned from its recordings, predicts " + to.source + ".");
  const report::Verdict verdict = !t.validation || t.overlap.least() < thresholds::least_overlap
                                      ? report::Verdict::remark
                                  : t.holds() ? report::Verdict::good
                                              : report::Verdict::bad;
  page.add_verdict(verdict, verdict_text(t));
  add_responses(t, page);
  add_budget(t, page);
  page.add_section("Quantities");
  add_quantities(t, page);
  add_validation(t, page);
  add_effects(t, page);
  add_naive(t, page);
  add_posterior(t, page);
  add_next(t, page);
  add_spectra(t, page);
  add_traces(t, from, page);
  page.add_section("Remarks");
  page.add_text("First rig: " + t.component_verdict);
  for (const std::string& remark : t.remarks) page.add_text(remark);
  page.add_appendix(from.source, from.text);
  page.add_appendix(to.source, to.text);
  return page.html();
}

}  // namespace host_sim::transfer
