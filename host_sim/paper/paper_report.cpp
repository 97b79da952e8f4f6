#include "host_sim/paper/paper_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host_sim/report/embedded_files.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "host_sim/stability/report/figures.hpp"

namespace host_sim::paper {
namespace {

using report::Curve;
using report::Dash;
using report::Figure;
using report::figure_text;
using report::Guide;
using report::Marker;
using report::Panel;
using report::Report;
using report::Table;
using report::Verdict;

constexpr int black = 6;

const Statement& find(const std::vector<Statement>& list, std::string_view id) {
  return *std::find_if(list.begin(), list.end(), [id](const Statement& s) { return s.id == id; });
}

void say(Report& page, const Statement& s) {
  page.add_verdict(
      s.agrees ? Verdict::good : Verdict::bad,
      (s.agrees ? "Agrees. " : "Does not agree. ") + std::string("The paper: ") + s.paper + " Here: " + s.finding);
}

std::vector<double> magnitudes(const std::vector<Complex>& values) {
  std::vector<double> result;
  result.reserve(values.size());
  for (const Complex v : values) result.push_back(std::abs(v));
  return result;
}

const std::vector<double>& magnitude(const stability::BodeData& data, std::string_view channel) {
  return std::find_if(data.outputs.begin(), data.outputs.end(), [&](const auto& c) { return c.name == channel; })
      ->magnitude;
}

Curve points(std::string name, const TransferEstimate& estimate, int colour, Marker marker) {
  Curve curve{std::move(name), estimate.frequency, magnitudes(estimate.response), colour, Dash::none, marker};
  curve.along = estimate.coherence;
  curve.along_quantity = "coherence";
  curve.along_unit = "1";
  return curve;
}

const report::Axis road_frequency{"frequency", "Hz", true, false, {{0.5, 30.0}}};

Figure figure_2(const Experiments& e) {
  Figure f{
      "Fig. 2 — hardware in the loop: wheel load and body acceleration against road, delay and no delay",
      "Lines: linear loop. Points: the nonlinear loop, simulated with the firmware over two minutes of class B road at "
      "100 km/h, estimated from its recording (H₁, coherence in the read-out). From 6 to 11 Hz, "
      "where the absorber moves most, the two differ: only the simulation contains the square losses of the ducts.",
      road_frequency};
  Panel load{{"wheel load ÷ road", "N/m", true, false, {{1e3, 3e6}}}},
      body{{"body acceleration ÷ road", "1/s²", true, false, {{5.0, 5e3}}}};
  const auto fill = [&](Panel& panel, std::string_view channel, const TransferEstimate& late,
                        const TransferEstimate& ideal) {
    panel.curves.push_back({"10 ms, linear", e.frequency_hz, magnitude(e.late, channel), 1, Dash::solid});
    panel.curves.push_back({"no delay, linear", e.frequency_hz, magnitude(e.ideal, channel), 0, Dash::dashed});
    panel.curves.push_back(points("10 ms, nonlinear run", late, 1, Marker::circle));
    panel.curves.push_back(points("no delay, nonlinear run", ideal, 0, Marker::open_circle));
    panel.guides.push_back({Guide::Along::x, e.growth.peak_hz, figure_text(e.growth.peak_hz, 3) + " Hz"});
  };
  fill(load, "F_w", e.late_run.wheel_load, e.ideal_run.wheel_load);
  fill(body, "zdd_b", e.late_run.second, e.ideal_run.second);
  for (Curve& curve : body.curves) curve.in_legend = false;
  f.panels = {std::move(load), std::move(body)};
  f.height = 680;
  return f;
}

/// The wheel's roots in the plane, and their real part over the variable.
std::array<Figure, 2> figure_3(std::string part, const std::vector<WheelRootPath>& paths,
                               const stability::ShownVariable& v,
                               const std::vector<std::pair<double, std::string>>& marks) {
  Figure plane{"Fig. 3" + part + " — the wheel's root over " + v.quantity, {}, {"real part", "1/s"}};
  Figure real{"Fig. 3" + part + " — its real part: below zero it decays", {}, {v.quantity, v.unit}};
  Panel in_plane{{"frequency of the root", "Hz"}}, over{{"real part of the wheel's root", "1/s"}};
  int colour = 0;
  for (const WheelRootPath& path : paths) {
    Curve locus{path.name, {}, {}, colour}, growth{path.name, {}, {}, colour};
    Curve ends{path.name + ", begins", {}, {}, colour, Dash::none, Marker::circle};
    for (std::size_t i = 0; i < path.roots.size(); ++i) {
      if (std::isnan(path.roots[i].real())) continue;
      const double value = v.scale * path.axis.value(i);
      locus.x.push_back(path.roots[i].real());
      locus.y.push_back(path.roots[i].imag() / full_turn);
      locus.along.push_back(value);
      growth.x.push_back(value);
      growth.y.push_back(path.roots[i].real());
      growth.along.push_back(path.roots[i].imag() / full_turn);
    }
    locus.along_quantity = v.quantity;
    locus.along_unit = v.unit;
    growth.along_quantity = "frequency";
    growth.along_unit = "Hz";
    ends.x = {locus.x.front()};
    ends.y = {locus.y.front()};
    ends.along = {locus.along.front()};
    ends.along_quantity = v.quantity;
    ends.along_unit = v.unit;
    ends.in_legend = false;
    in_plane.curves.push_back(std::move(locus));
    in_plane.curves.push_back(std::move(ends));
    over.curves.push_back(std::move(growth));
    ++colour;
  }
  plane.note =
      "Dots mark where the paths begin, at " + figure_text(v.scale * paths.front().axis.from) + " " + v.unit + ".";
  in_plane.guides = {{Guide::Along::x, 0.0, "border"}};
  over.guides = {{Guide::Along::y, 0.0, "border"}};
  for (const auto& [value, label] : marks) over.guides.push_back({Guide::Along::x, v.scale * value, label});
  plane.panels = {std::move(in_plane)};
  real.panels = {std::move(over)};
  return {std::move(plane), std::move(real)};
}

Figure kick_figure(const Experiments& e) {
  Figure f{"Free response of the nonlinear loops after a road bump of half a millimetre at 0.2 s",
           "Deflection of the component in the test machine; each panel has its own scale.",
           {"time", "s"}};
  int colour = 0;
  for (const KickedRun& run : e.kicks) {
    Panel panel{{"deflection", "mm"}};
    Curve curve{run.name, run.time, run.deflection, colour++, Dash::solid};
    for (double& v : curve.y) v *= 1e3;
    panel.curves = {std::move(curve)};
    f.panels.push_back(std::move(panel));
  }
  f.height = 640;
  return f;
}

void add_figure_4(Report& page, const Experiments& e) {
  const std::array loops{&e.linear, &e.absorber, &e.absorber_at_700};
  std::array<stability::BodeData, 3> data;
  std::vector<stability::NamedResponse> responses;
  std::vector<stability::NamedLoop> planes;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    const auto& a = loops[i]->analysis;
    data[i] = stability::bode(a.rig, a.delay, a.machine_delay, e.frequency_hz);
    responses.push_back({loops[i]->name, &data[i].loop, static_cast<int>(i), static_cast<Dash>(1 + i)});
    planes.push_back({loops[i]->name, &loops[i]->nyquist});
  }
  Figure bode =
      stability::bode_figure("Fig. 4 — Bode diagram of the loop at 10 ms", "magnitude of L", e.frequency_hz, responses);
  bode.panels[0].guides.push_back({Guide::Along::y, 1.0, "1"});
  bode.note = "L is the loop broken at the component's force; the border is L = −1.";
  page.add_figure(bode);
  Figure nyquist = stability::nyquist_figure("Fig. 4 — Nyquist diagram of the loop at 10 ms", planes);
  nyquist.note = "Double-click shows the whole curves.";
  page.add_figure(nyquist);
  Table counts{"Encirclements of −1, counter-clockwise; unstable roots = unstable poles of L − encirclements",
               {"loop", "encirclements", "unstable poles of L", "unstable roots"},
               {}};
  for (const Loop* loop : loops) {
    counts.rows.push_back({loop->name, figure_text(loop->nyquist.encirclements),
                           figure_text(loop->nyquist.open_loop_unstable),
                           figure_text(loop->nyquist.closed_loop_unstable)});
  }
  page.add_table(counts);
}

Figure figure_6(const Experiments& e) {
  const double mass = e.quarter_car.rig.effects.get<model::ForceSensorInertia>().effect.mass;
  Figure f{
      "Fig. 6 — quarter-car rig: wheel load against road by force sensor, soft sensor and simulation",
      "The force sensor reads F_w + m z̈_r with m = " + figure_text(mass) +
          " kg, as the rig description says (the paper gives no number). All three from two minutes of class B road at "
          "100 km/h, the first two with the noise of the rig's sensors.",
      road_frequency};
  Panel load{{"wheel load ÷ road", "N/m", true, false, {{1e3, 1e6}}}};
  load.curves = {{"simulation", e.simulated_run.wheel_load.frequency, magnitudes(e.simulated_run.wheel_load.response),
                  0, Dash::solid},
                 points("force sensor", e.rig_run.wheel_load, 1, Marker::circle),
                 points("soft sensor k_t dz_w", e.rig_run.second, 2, Marker::diamond)};
  Panel ratio{{"measured ÷ simulated", "1"}};
  const auto over_simulation = [&](std::string name, const TransferEstimate& measured, int colour, Marker marker) {
    Curve curve = points(std::move(name), measured, colour, marker);
    for (std::size_t i = 0; i < curve.y.size(); ++i) curve.y[i] /= std::abs(e.simulated_run.wheel_load.response[i]);
    curve.in_legend = false;
    return curve;
  };
  // |F_w + m z̈_r| ÷ |F_w| of the linear rig
  Curve expected{"expected of the force sensor: |1 − mω² z_r/F_w|", {}, {}, black, Dash::dotted};
  const auto response = std::find_if(e.quarter_car_true.outputs.begin(), e.quarter_car_true.outputs.end(),
                                     [](const auto& c) { return c.name == "F_w"; });
  for (std::size_t i = 0; i < e.frequency_hz.size(); ++i) {
    const double omega = full_turn * e.frequency_hz[i];
    const Complex load_over_road = std::polar(response->magnitude[i], response->phase[i]);
    expected.x.push_back(e.frequency_hz[i]);
    expected.y.push_back(std::abs(1.0 - mass * omega * omega / load_over_road));
  }
  ratio.curves = {over_simulation("force sensor", e.rig_run.wheel_load, 1, Marker::circle),
                  over_simulation("soft sensor k_t dz_w", e.rig_run.second, 2, Marker::diamond), std::move(expected)};
  ratio.y.range = {{0.3, 1.3}};
  ratio.guides = {{Guide::Along::y, 1.0, ""}};
  f.panels = {std::move(load), std::move(ratio)};
  f.height = 640;
  return f;
}

void add_summary(Report& page, const std::vector<Statement>& list) {
  const auto agreeing = std::count_if(list.begin(), list.end(), [](const Statement& s) { return s.agrees; });
  page.add_verdict(Verdict::good, std::to_string(agreeing) + " of the " + std::to_string(list.size()) +
                                      " checked statements of the paper agree with this model.");
  for (const Statement& s : list) {
    if (!s.agrees) page.add_verdict(Verdict::bad, "Does not agree. The paper: " + s.paper + " Here: " + s.finding);
  }
  const Statement& linear = find(list, "table_1_unstable");
  const Statement& at_700 = find(list, "absorber_unstable_at_700");
  if (!linear.agrees && at_700.agrees) {
    page.add_text(
        "The observed instability does not follow from the paper's equations (1)–(3). It comes from the absorber: "
        "above "
        "its own frequency the absorber acts almost as its stiff coil spring, and a spring k whose force is late by τ "
        "acts like a damping of −k τ. The virtual damping compensates for it, and the stability border lies between "
        "the two values that the paper tried.");
  }
}

}  // namespace

std::string in_words(const KickedRun& run) {
  std::string words = run.measured < 0.0 ? "decays with " : "grows with ";
  words += figure_text(std::abs(run.measured), 3) + " 1/s";
  if (firmware::is_fault(run.trip.reason)) {
    words += ", until the firmware stops it " + figure_text(run.trip.time.seconds(), 3) + " s after the start (" +
             std::string(firmware::name(run.trip.reason)) + " beyond its limit of " + figure_text(run.trip.limit) +
             (run.trip.reason == firmware::Reason::speed    ? " m/s"
              : run.trip.reason == firmware::Reason::stroke ? " m"
              : run.trip.reason == firmware::Reason::force  ? " N"
                                                            : "") +
             ")";
  }
  return words;
}

Report paper_report(const Experiments& e, const std::vector<Statement>& list) {
  Report page(
      "Reproduction of the paper",
      "Hardware-in-the-loop and quarter-car rig of a fluid dynamic vibration absorber (FDVA), TU Darmstadt: the "
      "counterparts of Figs. 2, 3, 4 and 6, computed from the rig descriptions below. The paper gives no numbers of "
      "its absorber; the parameters used here were fitted to its text.");
  add_summary(page, list);

  page.add_section("All statements");
  Table table{
      "Statements of the paper and results of this model", {"the paper", "here", "unit", "agrees if", "agrees"}, {}};
  for (const Statement& s : list) {
    table.rows.push_back(
        {s.paper, figure_text(s.computed, 5), s.unit == "1" ? "–" : s.unit, s.expected, s.agrees ? "✓ yes" : "✗ no"});
  }
  page.add_table(table);

  page.add_section("Fig. 2: hardware in the loop with delay");
  for (const char* id : {"wheel_load_400_percent", "at_13_hz", "two_ducts_8_hz"}) say(page, find(list, id));
  page.add_figure(figure_2(e));

  page.add_section("Fig. 3: poles over virtual damping and delay");
  for (const char* id :
       {"table_1_unstable", "absorber_stable_at_1140", "absorber_unstable_at_700", "critical_damping_between"}) {
    say(page, find(list, id));
  }
  std::vector<std::pair<double, std::string>> dampings{
      {reported_unstable_damping, "700, unstable in the paper"},
      {e.absorber.description.rig.machine.virtual_damping, "1140, stable in the paper"}};
  if (e.absorber.analysis.critical_damping) {
    dampings.emplace_back(e.absorber.analysis.critical_damping->value,
                          "FDVA: critical " + figure_text(e.absorber.analysis.critical_damping->value, 5));
  }
  std::vector<std::pair<double, std::string>> delays{{e.linear.analysis.delay, "the rig's delay"}};
  if (e.linear.analysis.margins.critical_delay) {
    delays.emplace_back(*e.linear.analysis.margins.critical_delay,
                        "Eqs. (1)–(3): critical " + figure_text(1e3 * *e.linear.analysis.margins.critical_delay, 6));
  }
  for (const Figure& f : figure_3("a", e.over_damping, {"virtual damping", "N s/m", 1.0}, dampings)) page.add_figure(f);
  for (const Figure& f : figure_3("b", e.over_delay, {"loop delay τ", "ms", 1e3}, delays)) page.add_figure(f);
  Figure map = stability::map_figure(e.map, e.absorber.description, e.absorber.analysis.delay);
  map.title = "Both at once, FDVA: the rightmost of all roots over delay and virtual damping";
  report::Panel& plane = map.panels.front();
  plane.curves.back().name = e.absorber.name;
  plane.curves.push_back({e.absorber_at_700.name,
                          {1e3 * e.absorber_at_700.analysis.delay},
                          {reported_unstable_damping},
                          black,
                          Dash::none,
                          Marker::cross});
  map.note = "Blue is stable, orange unstable. The border is computed exactly, from roots on the imaginary axis.";
  page.add_figure(map);

  page.add_section("Time simulation of both verdicts");
  for (std::size_t i = 0; i < e.kicks.size(); ++i) {
    const KickedRun& run = e.kicks[i];
    const bool same = (run.predicted < 0.0) == (run.measured < 0.0);
    page.add_verdict(same ? Verdict::good : Verdict::bad,
                     run.name + ": the nonlinear loop, simulated through the firmware, " + in_words(run) +
                         ". The wheel root of the sampled loop predicts " + figure_text(run.predicted, 3) +
                         " 1/s; without sampling and hold (half a step less delay) it is " +
                         figure_text(std::array{&e.linear, &e.absorber, &e.absorber_at_700}[i]->wheel_root.real(), 3) +
                         " 1/s.");
  }
  page.add_figure(kick_figure(e));

  page.add_section("Fig. 4: Bode and Nyquist");
  add_figure_4(page, e);

  page.add_section("Fig. 6: the quarter-car rig");
  for (const char* id : {"force_sensor_wrong", "soft_sensor_right"}) say(page, find(list, id));
  page.add_figure(figure_6(e));

  for (const char* name : {"paper_linear.toml", "paper_hil_fdva.toml", "paper_rig_fdva.toml"}) {
    page.add_appendix("Rig description " + std::string(name), embedded_file(name));
  }
  return page;
}

nlohmann::ordered_json paper_json(const Experiments& e, const std::vector<Statement>& list) {
  nlohmann::ordered_json json;
  json["agreeing"] = std::count_if(list.begin(), list.end(), [](const Statement& s) { return s.agrees; });
  json["statements"] = nlohmann::ordered_json::array();
  for (const Statement& s : list) {
    json["statements"].push_back({{"id", s.id},
                                  {"paper", s.paper},
                                  {"here", s.finding},
                                  {"computed", s.computed},
                                  {"unit", s.unit},
                                  {"expected", s.expected},
                                  {"agrees", s.agrees}});
  }
  json["kicks"] = nlohmann::ordered_json::array();
  for (const KickedRun& run : e.kicks) {
    json["kicks"].push_back({{"name", run.name},
                             {"growth_predicted", run.predicted},
                             {"growth_measured", run.measured},
                             {"ended", std::string(firmware::name(run.trip.reason))},
                             {"seconds", run.time.empty() ? 0.0 : run.time.back()}});
  }
  return json;
}

}  // namespace host_sim::paper
