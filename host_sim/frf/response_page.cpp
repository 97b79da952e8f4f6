#include "host_sim/frf/response_page.hpp"

#include <cmath>
#include <numbers>

#include "host_sim/report/report.hpp"

namespace host_sim::frf {
namespace {

using report::Curve;
using report::Dash;
using report::figure_text;

constexpr double degree = std::numbers::pi / 180.0;

std::string ratio_of(const Responses& r, const OutputResponse& o) {
  return std::string(model::name(o.output)) + " ÷ " + std::string(model::name(r.request.input));
}

std::string unit_of(const Responses& r, const OutputResponse& o) {
  const std::string_view above = model::unit(o.output), below = model::unit(r.request.input);
  return above == below ? "1" : std::string(above) + "/(" + std::string(below) + ")";
}

/// The estimate and its bounds where it is determined, gaps elsewhere.
template <class Value>
void add_bounded(report::Panel& panel, const Responses& r, const OutputResponse& o, bool in_legend,
                 const Value& value) {
  Curve estimate, low, high;
  estimate.name = "estimate";
  estimate.colour = 0;
  estimate.dash = Dash::solid;
  low.name = high.name = "95 % bounds";
  low.colour = high.colour = 1;
  low.dash = high.dash = Dash::dotted;
  estimate.in_legend = low.in_legend = in_legend;
  high.in_legend = false;
  for (std::size_t k = 0; k < r.frequency.size(); ++k) {
    const auto [at, from, to] = value(k);
    const bool known = o.determined[k] && std::isfinite(at);
    for (auto [curve, y] : {std::pair(&estimate, at), std::pair(&low, from), std::pair(&high, to)}) {
      curve->x.push_back(r.frequency[k]);
      curve->y.push_back(known && std::isfinite(y) && !(panel.y.logarithmic && y <= 0.0) ? y : std::nan(""));
    }
  }
  panel.curves = {std::move(estimate), std::move(low), std::move(high)};
}

struct Bounded {
  double at, from, to;
};

void add_output(report::Report& page, const Responses& r, const OutputResponse& o) {
  report::Figure figure;
  figure.title = ratio_of(r, o);
  figure.note = "Gaps: not distinguishable from 0 in these data.";
  if (o.delay && o.compensated) {
    figure.note += " A delay of " + figure_text(1e3 * static_cast<double>(*o.delay) / r.sample_rate, 4) +
                   " ms was compensated in the blocks and is part of the phase.";
  }
  figure.x = {"frequency", "Hz", true};
  report::Panel magnitude, phase, coherence;
  magnitude.y = {"magnitude", unit_of(r, o), true};
  magnitude.share = 2.0;
  add_bounded(magnitude, r, o, true, [&](std::size_t k) {
    return Bounded{o.magnitude[k], o.magnitude_ci95[k].low, o.magnitude_ci95[k].high};
  });
  phase.y = {"phase", "°"};
  add_bounded(phase, r, o, false, [&](std::size_t k) {
    return Bounded{o.phase[k] / degree, o.phase_ci95[k].low / degree, o.phase_ci95[k].high / degree};
  });
  coherence.y = {"coherence", "1"};
  coherence.y.range = std::pair(0.0, 1.05);
  Curve gamma{"coherence", r.frequency, o.coherence, 2, Dash::solid};
  coherence.curves.push_back(std::move(gamma));
  figure.panels = {std::move(magnitude), std::move(phase), std::move(coherence)};
  figure.height = 620;
  page.add_section(ratio_of(r, o));
  page.add_figure(figure);
}

}  // namespace

std::string sentence(const Responses& r) {
  std::string text;
  for (const OutputResponse& o : r.outputs) {
    std::size_t best = r.frequency.size();
    for (std::size_t k = 0; k < r.frequency.size(); ++k) {
      if (!o.determined[k] || !std::isfinite(o.magnitude[k])) continue;
      if (best == r.frequency.size() || o.magnitude[k] > o.magnitude[best]) best = k;
    }
    text += text.empty() ? "" : " ";
    if (best == r.frequency.size()) {
      text += ratio_of(r, o) + " is not distinguishable from 0 at any frequency.";
      continue;
    }
    const std::string unit = unit_of(r, o);
    text += ratio_of(r, o) + " is largest at " + figure_text(r.frequency[best], 4) +
            " Hz: " + figure_text(o.magnitude[best], 4) + (unit == "1" ? "" : " " + unit) +
            " (95 %: " + figure_text(o.magnitude_ci95[best].low, 4) + " … " +
            figure_text(o.magnitude_ci95[best].high, 4) + "), coherence " + figure_text(o.coherence[best], 4) + ".";
  }
  return text;
}

std::string response_page(const Responses& r) {
  std::string files;
  for (const std::string& file : r.recordings) files += (files.empty() ? "" : ", ") + file;
  report::Report page("Frequency responses of " + files);
  page.add_verdict(report::Verdict::remark, sentence(r));
  for (const OutputResponse& output : r.outputs) add_output(page, r, output);
  page.add_section("How it was estimated");
  const BlockScheme& scheme = r.blocks.scheme;
  report::Table table{"", {"quantity", "unit", "value"}, {}, 2};
  table.rows = {{"estimator", "", std::string(name(r.request.estimator))},
                {"duration", "s", figure_text(r.duration, 5)},
                {"sample rate", "Hz", figure_text(r.sample_rate, 6)},
                {"block", "s", figure_text(static_cast<double>(scheme.length) / r.sample_rate, 4)},
                {"distance of lines", "Hz", figure_text(r.resolution(), 4)},
                {"overlap of blocks", "%",
                 figure_text(100.0 - 100.0 * static_cast<double>(scheme.hop) / static_cast<double>(scheme.length), 3)},
                {"window", "", std::string(name(scheme.window))},
                {"averages", "1", std::to_string(r.averages)},
                {"independent averages", "1", figure_text(r.effective_averages, 4)}};
  page.add_table(table);
  return page.html();
}

}  // namespace host_sim::frf
