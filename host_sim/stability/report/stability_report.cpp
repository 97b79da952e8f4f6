#include "host_sim/stability/report/stability_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/margins/frequency_response.hpp"
#include "host_sim/stability/report/figures.hpp"
#include "host_sim/stability/report/verdict.hpp"

namespace host_sim::stability {
namespace {

using report::Dash;
using report::Figure;
using report::figure_text;
using report::Guide;
using report::Panel;
using report::Report;
using report::Table;
using report::Verdict;

std::string in_ms(double seconds, int digits = 6) { return figure_text(1e3 * seconds, digits) + " ms"; }
std::string in_hz(double omega) { return figure_text(omega / full_turn) + " Hz"; }

std::string joined(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  return list;
}

void add_verdict(Report& page, const StabilityFindings& f) {
  const StabilityAnalysis& a = f.analysis;
  const auto& m = a.margins;
  if (f.compensated.empty()) {
    const bool good = a.stable_as_run() && a.stable_over_delays();
    page.add_verdict(good ? Verdict::good : Verdict::bad, "The loop is " + verdict(a) + ".");
  } else {
    page.add_verdict(f.compensated_stable ? Verdict::good : Verdict::bad, f.compensated);
    page.add_verdict(Verdict::remark,
                     "Without compensation the loop is " + verdict(a) + ". All sections but the last are about it.");
  }
  std::string border = "Loop delay " + in_ms(a.delay) + "; ";
  if (a.sampled && a.sampled->critical_delay) {
    border += "critical delay of the sampled loop " + in_ms(*a.sampled->critical_delay + a.rig.sensor_delay) + "; ";
  }
  if (a.sampled_damping) {
    border += "its critical virtual damping " + figure_text(a.sampled_damping->value, 6) + " N s/m. ";
  }
  border += "Without sampling and hold: ";
  border += m.critical_delay ? "critical delay " + in_ms(*m.critical_delay) + " at " + in_hz(m.critical_omega)
                             : "no critical delay up to 1 s";
  const double damping = f.description.rig.machine.virtual_damping;
  border += ". Virtual damping " + figure_text(damping, 6) + " N s/m; ";
  border += a.critical_damping ? "critical virtual damping " + figure_text(a.critical_damping->value, 6) +
                                     " N s/m at " + in_hz(a.critical_damping->omega)
                               : "no critical virtual damping from 0 to 10 000 N s/m";
  page.add_verdict(Verdict::remark, border + ".");
  if (a.sampled && a.sampled->stable() != a.stable) {
    page.add_verdict(Verdict::bad,
                     std::string("The sampled loop is ") + (a.sampled->stable() ? "stable" : "unstable") +
                         ", unlike the continuous loop: sampling and hold change the result. See Sampled loop.");
  }
  if (!a.rig.left_out.empty()) {
    page.add_verdict(Verdict::remark,
                     "Not in the linear analysis, because they have no linear part: " + joined(a.rig.left_out) + ".");
  }
  if (!a.rig.outside_loop.empty()) {
    page.add_verdict(Verdict::remark, "Not part of the loop: " + joined(a.rig.outside_loop) + ".");
  }
}

void add_roots(Report& page, const StabilityAnalysis& a) {
  page.add_section("Roots");
  page.add_text("In continuous time, without sampling and hold. All roots right of " + figure_text(a.roots.line) +
                " 1/s: " + std::to_string(a.roots.count) + " with their conjugates, proven by the argument principle.");
  page.add_figure(root_figure("Roots of the loop with its delay", a.roots));
  Table table{"", {"real part [1/s]", "frequency [Hz]", "damping ratio [%]", "amplitude"}, {}, 0};
  for (const Complex s : a.roots.roots) {
    const double time = std::numbers::ln2 / std::max(std::abs(s.real()), 1e-300);
    table.rows.push_back({figure_text(s.real(), 7), figure_text(s.imag() / full_turn, 6),
                          std::abs(s) > 0.0 ? figure_text(-100.0 * s.real() / std::abs(s), 3) : "–",
                          (s.real() < 0.0 ? "halves in " : "doubles in ") + figure_text(time, 3) + " s"});
  }
  table.title = "Roots, rightmost first";
  page.add_table(table);
}

void add_margins(Report& page, const StabilityAnalysis& a) {
  page.add_section("Margins");
  const auto& m = a.margins;
  if (a.sampled && a.sampled_margins) {
    Table runs{"Distance to the stability border, sampled as it runs", {"", "value", "at"}, {}, 1};
    const auto& s = *a.sampled_margins;
    if (a.delay_left) runs.rows.push_back({"delay", in_ms(*a.delay_left), ""});
    for (const auto& [name, gain] :
         {std::pair("gain, upwards", s.upper_gain), std::pair("gain, downwards", s.lower_gain)}) {
      if (!gain) continue;
      runs.rows.push_back(
          {name, "× " + figure_text(gain->factor) + " (" + figure_text(20.0 * std::log10(gain->factor), 3) + " dB)",
           in_hz(gain->omega)});
    }
    if (s.phase_margin) {
      runs.rows.push_back(
          {"phase", figure_text(*s.phase_margin * 360.0 / full_turn) + "°", in_hz(s.phase_margin_omega)});
    }
    runs.rows.push_back({"sensitivity peak", figure_text(s.sensitivity.value), in_hz(s.sensitivity.omega)});
    page.add_table(runs);
  }
  Table table{"Distance to the stability border, without sampling and hold", {"", "value", "at"}, {}, 1};
  if (m.delay_margin) table.rows.push_back({"delay", in_ms(*m.delay_margin), in_hz(m.delay_margin_omega)});
  for (const auto& [name, gain] :
       {std::pair("gain, upwards", m.upper_gain), std::pair("gain, downwards", m.lower_gain)}) {
    if (!gain) continue;
    table.rows.push_back(
        {name, "× " + figure_text(gain->factor) + " (" + figure_text(20.0 * std::log10(gain->factor), 3) + " dB)",
         in_hz(gain->omega)});
  }
  if (m.phase_margin) {
    table.rows.push_back(
        {"phase", figure_text(*m.phase_margin * 360.0 / full_turn) + "°", in_hz(m.phase_margin_omega)});
  }
  table.rows.push_back({"sensitivity peak", figure_text(a.sensitivity.value), in_hz(a.sensitivity.omega)});
  page.add_table(table);
  if (!m.stable_delays.empty()) {
    std::string ranges;
    for (const StableRange& r : m.stable_delays) {
      ranges += (ranges.empty() ? "" : ", ") + figure_text(1e3 * r.from, 6) + " to " + in_ms(r.to);
    }
    page.add_text("Stable delays, up to 1 s: " + ranges + ".");
  }
}

void add_budget(Report& page, const StabilityAnalysis& a) {
  page.add_section("Delay budget");
  Figure figure{"Parts of the loop delay and the critical delay", {}, {"delay", "ms"}};
  Panel panel{{"part", "", false, true}};
  report::Bars parts{"part", {}, {}, 4}, sums{"total", {}, {}, 0}, border{"border", {}, {}, 1};
  for (const DelayPart& part : a.balance.parts) {
    const bool lag = part.name.starts_with("lag");
    parts.names.push_back(part.name + (lag ? " (not added)" : ""));
    parts.values.push_back(1e3 * part.seconds);
  }
  sums.names = {"total"};
  sums.values = {1e3 * a.balance.total};
  panel.bars = {parts, sums};
  if (a.margins.critical_delay) {
    border.names = {"critical delay"};
    border.values = {1e3 * *a.margins.critical_delay};
    panel.bars.push_back(border);
    panel.guides.push_back({Guide::Along::x, 1e3 * *a.margins.critical_delay, ""});
    figure.x.range = {{0.0, 1.15e3 * std::max(*a.margins.critical_delay, a.balance.total)}};
  }
  figure.height = static_cast<int>(150 + 34 * (a.balance.parts.size() + 2));
  figure.panels = {std::move(panel)};
  if (a.balance.left) {
    figure.note =
        in_ms(std::abs(*a.balance.left), 4) + (*a.balance.left >= 0.0 ? " below" : " above") +
        " the critical delay, half a step of hold included. Lags are part of the equations and so of the critical "
        "delay; they are shown, not added.";
  }
  page.add_figure(figure);
}

void add_pade(Report& page, const StabilityAnalysis& a) {
  if (!a.margins.critical_delay) return;
  Table table{"Critical delay with a Padé approximation in place of the delay",
              {"order", "critical delay [ms]", "error [%]", "side"},
              {},
              0};
  for (const PadeResult& p : a.pade) {
    table.rows.push_back({std::to_string(p.order), p.critical_delay ? figure_text(1e3 * *p.critical_delay, 6) : "none",
                          p.error ? figure_text(100.0 * *p.error, 2) : "–", p.unsafe ? "unsafe" : "safe"});
  }
  table.rows.push_back({"exact", figure_text(1e3 * *a.margins.critical_delay, 6), "0", ""});
  page.add_table(table);
}

void add_sampled(Report& page, const StabilityAnalysis& a) {
  page.add_section("Sampled loop");
  if (!a.sampled) {
    page.add_text("Not analysed: the delay exceeds the model's delay line at this sample rate.");
    return;
  }
  const SampledLoop& s = *a.sampled;
  std::string words = "Sampled at " + figure_text(1.0 / s.period, 6) +
                      " Hz with the force held for a step, the loop is " + (s.stable() ? "stable" : "unstable") +
                      ": spectral radius " + figure_text(s.spectral_radius, 8) + " of " + std::to_string(s.states) +
                      " states.";
  if (s.added_delay) {
    words += " Sampling and hold add " + in_ms(*s.added_delay, 4) + " of delay (" +
             figure_text(*s.added_delay / s.period, 3) + " steps); critical delay " + in_ms(*s.critical_delay) + ".";
  }
  page.add_verdict(s.stable() ? Verdict::good : Verdict::bad, words);
  Figure figure{"Eigenvalues of one step",
                "Stable inside the unit circle. The angle of an eigenvalue is its frequency.",
                {"real part", "1"}};
  figure.equal_axes = true;
  figure.height = 420;
  figure.x.range = {{-1.15, 1.15}};
  Panel panel{{"imaginary part, upper half", "1"}};
  panel.y.range = {{-0.1, 1.15}};
  report::Curve circle{"unit circle", {}, {}, 6, Dash::dotted},
      points{"eigenvalue", {}, {}, 0, Dash::none, report::Marker::circle};
  for (int i = 0; i <= 90; ++i) {
    circle.x.push_back(std::cos(full_turn * i / 180.0));
    circle.y.push_back(std::sin(full_turn * i / 180.0));
  }
  for (const Complex z : s.eigenvalues) {
    points.x.push_back(z.real());
    points.y.push_back(z.imag());
    points.along.push_back(std::arg(z) / (full_turn * s.period));
  }
  points.along_quantity = "frequency";
  points.along_unit = "Hz";
  panel.curves = {std::move(circle), std::move(points)};
  figure.panels = {std::move(panel)};
  page.add_figure(figure);
}

void add_sensitivities(Report& page, const StabilityAnalysis& a) {
  page.add_section("Sensitivity to the parameters");
  constexpr std::size_t most = 12;
  report::Bars root{"", {}, {}, 0}, delay{"", {}, {}, 2};
  for (std::size_t i = 0; i < std::min(most, a.parameters.size()); ++i) {
    const ParameterSensitivity& s = a.parameters[i];
    root.names.push_back(s.path);
    root.values.push_back(0.01 * s.root_change.real());
    delay.names.push_back(s.path);
    delay.values.push_back(10.0 * s.critical_delay_change);
  }
  if (root.names.empty()) return;
  const auto figure = [&](std::string title, std::string note, report::Axis x, report::Bars bars) {
    Figure f{std::move(title), std::move(note), std::move(x)};
    Panel panel{{"parameter", "", false, true}};
    f.height = static_cast<int>(110 + 28 * bars.names.size());
    panel.bars = {std::move(bars)};
    f.panels = {std::move(panel)};
    return f;
  };
  page.add_figure(figure("Rightmost root: change for +1 % of a parameter", "Positive: less stable.",
                         {"change of the real part for +1 %", "1/s"}, root));
  if (a.margins.critical_delay) {
    page.add_figure(figure("Critical delay: change for +1 % of a parameter", "Positive: the loop tolerates more delay.",
                           {"change of the critical delay for +1 %", "ms"}, delay));
  }
}

void add_amplitudes(Report& page, const OverAmplitude& over) {
  page.add_section("Over the amplitude");
  page.add_text(
      "The loop that oscillates with one amplitude of the suspension deflection dz_b, its nonlinear forces replaced by "
      "their first harmonic. Where the real part of the rightmost root is below zero, an oscillation of that size "
      "decays.");
  if (!over.left_out.empty()) page.add_text("Not counted: " + joined(over.left_out) + ".");
  for (const LimitCycle& cycle : over.limit_cycles) page.add_verdict(Verdict::bad, in_words(cycle) + ".");
  report::Curve root{"rightmost root", {}, {}, 0}, stiffness{"suspension, added stiffness", {}, {}, 1},
      damping{"suspension, added damping", {}, {}, 2}, frequency{"frequency", {}, {}, 3};
  root.marker = stiffness.marker = damping.marker = frequency.marker = report::Marker::circle;
  for (const AtAmplitude& at : over.rows) {
    for (report::Curve* curve : {&root, &stiffness, &damping, &frequency}) curve->x.push_back(1e3 * at.amplitude);
    root.y.push_back(at.root.real());
    frequency.y.push_back(at.omega / full_turn);
    stiffness.y.push_back(1e-3 * at.suspension.stiffness);
    damping.y.push_back(at.suspension.damping);
  }
  Figure figure{"Rightmost root, and what the nonlinear forces are at each amplitude",
                "Of all oscillations the one is shown that decays slowest; where the frequency jumps another one does. "
                "Stiffness and "
                "damping are added to spring and damper of the description.",
                {"amplitude of dz_b", "mm", true}};
  Panel roots{{"real part", "1/s"}}, hertz{{"frequency", "Hz"}}, stiff{{"stiffness", "kN/m"}},
      damp{{"damping", "N s/m"}};
  roots.curves = {std::move(root)};
  roots.guides.push_back({Guide::Along::y, 0.0, "border"});
  stiff.curves = {std::move(stiffness)};
  damp.curves = {std::move(damping)};
  hertz.curves = {std::move(frequency)};
  figure.panels = {std::move(roots), std::move(hertz), std::move(stiff), std::move(damp)};
  figure.height = 680;
  page.add_figure(figure);
}

void add_loop(Report& page, const StabilityAnalysis& a, const BodeData& data) {
  page.add_section("The open loop");
  page.add_text("L = (Q/P) e^(−sτ) is the loop opened at the component's force; on the stability border 1 + L = 0.");
  Figure bode = bode_figure("Bode diagram of the loop, phase unwrapped", "magnitude of L", data.frequency_hz,
                            std::array{NamedResponse{"L", &data.loop, 0}});
  bode.panels[0].guides.push_back({Guide::Along::y, 1.0, "1"});
  page.add_figure(bode);
  const NyquistData plane = nyquist(a.equation(), a.roots.roots);
  Figure figure = nyquist_figure("Nyquist diagram of the loop", std::array{NamedLoop{"L(jω)", &plane}});
  figure.note = encirclements_in_words(plane) + " Double-click shows the whole curve.";
  page.add_figure(figure);
}

void add_responses(Report& page, const StabilityFindings& f, const BodeData& late) {
  const StabilityAnalysis& a = f.analysis;
  page.add_section("Responses to the road");
  page.add_text(a.stable
                    ? "Closed-loop responses per metre of road, with the loop's delay and without any delay."
                    : "Transfer functions per metre of road, with the loop's delay and without any delay. The loop "
                      "with delay is unstable, so it has no steady response.");
  const BodeData ideal = bode(a.rig, 0.0, 0.0, late.frequency_hz);
  struct Group {
    const char *title, *quantity;
    std::vector<model::Channel> channels;
  };
  using model::Channel;
  const std::array<Group, 3> groups{
      {{"Forces from the road: F_w wheel load, F component", "force ÷ road", {Channel::F_w, Channel::F}},
       {"Accelerations from the road: wheel, body", "acceleration ÷ road", {Channel::zdd_w, Channel::zdd_b}},
       {"Displacements from the road: wheel, body, tyre deflection, suspension deflection",
        "displacement ÷ road",
        {Channel::z_w, Channel::z_b, Channel::dz_w, Channel::dz_b}}}};
  const auto curve = [](const BodeData& data, Channel channel) {
    return &*std::find_if(data.outputs.begin(), data.outputs.end(),
                          [&](const ResponseCurve& c) { return c.name == model::name(channel); });
  };
  for (const Group& group : groups) {
    std::vector<NamedResponse> responses;
    int colour = 0;
    for (const Channel channel : group.channels) {
      const std::string name(model::name(channel));
      responses.push_back({name + ", with delay", curve(late, channel), colour, Dash::solid});
      if (a.delay > 0.0) responses.push_back({name + ", no delay", curve(ideal, channel), colour, Dash::dotted});
      ++colour;
    }
    page.add_figure(bode_figure(group.title, group.quantity, late.frequency_hz, responses));
  }
  Table table{"Peaks from 0.1 to 100 Hz",
              {"output ÷ road", "unit", "peak with delay", "at [Hz]", "peak without", "at [Hz]", "ratio"},
              {},
              2};
  const RoadResponse with(a.rig, a.delay, a.machine_delay), without(a.rig, 0.0, 0.0);
  for (const Channel channel : RoadResponse::outputs()) {
    if (channel == Channel::x_cmd) continue;  // is dz_b
    const Peak p = peak(with, channel, 0.1, 100.0), q = peak(without, channel, 0.1, 100.0);
    std::string unit = curve(late, channel)->unit;
    if (unit == "m/s²/m") unit = "1/s²";
    table.rows.push_back({std::string(model::name(channel)), unit == "1" ? "–" : unit, figure_text(p.magnitude),
                          figure_text(p.frequency_hz), figure_text(q.magnitude), figure_text(q.frequency_hz),
                          figure_text(p.magnitude / q.magnitude, 3)});
  }
  page.add_table(table);
}

}  // namespace

Report stability_report(const StabilityFindings& f) {
  const StabilityAnalysis& a = f.analysis;
  Report page("Delay stability of " + f.description.source,
              "Linear stability analysis of a hil rig with its exact loop delay.");
  add_verdict(page, f);
  add_sampled(page, a);
  add_roots(page, a);
  add_margins(page, a);
  add_budget(page, a);
  add_pade(page, a);
  add_sensitivities(page, a);
  if (f.map || !f.sweeps.empty()) page.add_section("Map and sweeps over parameters");
  if (f.map) {
    Figure figure = map_figure(*f.map, f.description, a.delay + 0.5 * f.description.period());
    figure.note =
        "Blue is stable, orange unstable. The delay is the whole delay of the loop that runs, half a step of hold "
        "included. The border is computed exactly, from roots on the imaginary axis; it is not "
        "interpolated from the colours.";
    page.add_figure(figure);
  }
  for (const PoleSweep& sweep : f.sweeps) page.add_figure(locus_figure(sweep, f.description));
  if (f.over_amplitude) add_amplitudes(page, *f.over_amplitude);
  const BodeData data = bode(a.rig, a.delay, a.machine_delay, frequencies(0.1, 100.0, 600, a.roots.roots));
  add_loop(page, a, data);
  add_responses(page, f, data);
  if (!f.description.text.empty()) page.add_appendix("Rig description " + f.description.source, f.description.text);
  return page;
}

}  // namespace host_sim::stability
