#include "host_sim/compensation/record_page.hpp"

#include <algorithm>

#include "host_sim/report/report.hpp"

namespace host_sim::compensation {
namespace {

using model::Channel;
using report::figure_text;

constexpr double seconds_shown = 20.0;      ///< of the traces
constexpr std::size_t points_shown = 8000;  ///< of a trace: at most

}  // namespace

std::string sentence(const MachineRecord& record) {
  const auto best = std::min_element(record.methods.begin(), record.methods.end(),
                                     [](const auto& a, const auto& b) { return a.error < b.error; });
  std::string text =
      "The machine missed its command by " + figure_text(100.0 * record.uncompensated, 3) + " % of the command's rms";
  if (best != record.methods.end()) {
    text += "; led by the " + best->name + " it would have missed it by " + figure_text(100.0 * best->error, 3) + " %";
  }
  return text + ".";
}

std::string record_page(const MachineRecord& record, const firmware::Recording& recording) {
  report::Report page("Compensation of the machine in " + recording.source);
  page.add_verdict(report::Verdict::remark, sentence(record));
  page.add_section("Error with each compensation");
  report::Figure errors;
  errors.title = "rms(x_act − x_cmd) ÷ rms(x_cmd)";
  errors.note = "Predicted from this run: the command led by each compensation, the machine as it was. From " +
                figure_text(record.lowest_hz, 3) + " to " + figure_text(record.highest_hz, 3) +
                " Hz, where the command moved.";
  errors.x = {"error", "%"};
  report::Panel bars;
  bars.y.quantity = "compensation";
  bars.y.of_names = true;
  report::Bars heights{"error", {"none, as recorded"}, {100.0 * record.uncompensated}, 0};
  for (const MachineRecord::Method& method : record.methods) {
    heights.names.push_back(method.name);
    heights.values.push_back(100.0 * method.error);
  }
  errors.height = 140 + 34 * static_cast<int>(heights.names.size());
  bars.bars.push_back(std::move(heights));
  errors.panels.push_back(std::move(bars));
  page.add_figure(errors);

  page.add_section("Over time");
  report::Figure traces;
  traces.title = "Commanded and reached";
  traces.note =
      "Below: what is left of the command. The reached position with the exact inverse is computed from the run.";
  traces.x = {"time", "s"};
  report::Panel position, missed;
  position.y = {"deflection", "m"};
  missed.y = {"reached − commanded", "m"};
  const auto last = std::min(recording.size(), static_cast<std::size_t>(seconds_shown / recording.sample_period));
  const std::size_t step = std::max<std::size_t>(1, last / points_shown);
  const auto curve = [&](const char* name, const std::vector<double>& values, const std::vector<double>* from,
                         int colour, report::Dash dash, bool in_legend) {
    report::Curve c;
    c.name = name;
    c.colour = colour;
    c.dash = dash;
    c.in_legend = in_legend;
    for (std::size_t k = 0; k < std::min(last, values.size()); k += step) {
      c.x.push_back(recording.time[k] - recording.time.front());
      c.y.push_back(values[k] - (from != nullptr ? (*from)[k] : 0.0));
    }
    return c;
  };
  const std::vector<double>&wanted = recording[Channel::x_cmd], &reached = recording[Channel::x_act];
  position.curves = {curve("x_cmd", wanted, nullptr, 6, report::Dash::solid, true),
                     curve("x_act as recorded", reached, nullptr, 1, report::Dash::dashed, true),
                     curve("x_act with the exact inverse", record.reached, nullptr, 0, report::Dash::dotted, true)};
  missed.curves = {curve("x_act as recorded", reached, &wanted, 1, report::Dash::dashed, false),
                   curve("x_act with the exact inverse", record.reached, &wanted, 0, report::Dash::dotted, false)};
  traces.panels = {std::move(position), std::move(missed)};
  traces.height = 560;
  page.add_figure(traces);

  page.add_section("The machine as assumed");
  report::Table table{"", {"quantity", "unit", "value"}, {}, 2};
  table.rows = {{"delay", "ms", figure_text(1e3 * record.machine.delay, 4)},
                {"lag", "ms", figure_text(1e3 * record.machine.lag, 4)},
                {"best pure delay of this run", "ms", figure_text(1e3 * record.pure_delay, 4)}};
  if (record.machine.resonance_frequency > 0.0) {
    table.rows.push_back({"resonance", "Hz", figure_text(record.machine.resonance_frequency, 4)});
    table.rows.push_back({"its damping ratio", "1", figure_text(record.machine.resonance_damping, 3)});
  }
  page.add_table(table);
  return page.html();
}

}  // namespace host_sim::compensation
