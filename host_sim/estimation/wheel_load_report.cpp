#include "host_sim/estimation/wheel_load_report.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/kalman/innovation_monitor.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::estimation {
namespace {

using model::Channel;
using report::figure_text;

constexpr double settling = 1.0;          ///< [s] left out of the errors: the filter starts from nothing
constexpr std::size_t rows_shown = 4000;  ///< of the figure: 4 s at 1 kHz, a pixel each on a wide screen

std::vector<double> tyre_deflection(const firmware::Recording& recording) {
  if (recording.has(Channel::dz_w)) return recording[Channel::dz_w];
  if (!recording.has(Channel::z_r) || !recording.has(Channel::z_w)) return {};
  std::vector<double> result = recording[Channel::z_r];
  for (std::size_t k = 0; k < result.size(); ++k) result[k] -= recording[Channel::z_w][k];
  return result;
}

std::size_t first_row(const firmware::Recording& recording) {
  return std::min(recording.size(), static_cast<std::size_t>(settling / recording.sample_period));
}

void compare(WheelLoad& load, const firmware::Recording& recording, const std::vector<double>& truth) {
  double error = 0.0, signal = 0.0;
  const std::size_t first = first_row(recording);
  for (std::size_t k = first; k < truth.size(); ++k) {
    const double e = load.values[k] - truth[k];
    error += e * e;
    signal += truth[k] * truth[k];
  }
  const double rows = std::max<double>(1.0, static_cast<double>(truth.size() - first));
  load.error_rms = std::sqrt(error / rows);
  if (signal > 0.0) load.error_share = std::sqrt(error / signal);
}

report::Curve curve(const std::string& name, const std::vector<double>& time, const std::vector<double>& values,
                    std::size_t first, std::size_t last, int colour) {
  const auto cut = [first, last](const std::vector<double>& v) {
    return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(first),
                               v.begin() + static_cast<std::ptrdiff_t>(last));
  };
  report::Curve c;
  c.name = name;
  c.x = cut(time);
  c.y = cut(values);
  c.colour = colour;
  c.dash = report::Dash::solid;
  return c;
}

/// A policy opens other ducts where the readings have other noise: such a run is another one, not the truth of this
/// one.
void demand_same_ducts(const firmware::Recording& recording, const firmware::Recording& truth) {
  for (std::size_t j = 0; j < recording.ducts.size(); ++j) {
    const auto &a = recording.ducts[j], &b = truth.ducts[j];
    const auto first_difference = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
    if (a.empty() || b.empty() || first_difference.first == a.end() || first_difference.second == b.end()) continue;
    const auto row = static_cast<std::size_t>(first_difference.first - a.begin());
    throw firmware::InputError(
        truth.source, 0,
        "duct_" + std::to_string(j + 1) +
            " of the truth is not that of the recording from t = " + report::figure_text(recording.time[row]) + " s on",
        "a truth of the same run: the same openings, by [valves] plan in place of a policy");
  }
}

}  // namespace

std::vector<WheelLoad> wheel_loads(const firmware::RigDescription& description, const firmware::Recording& recording,
                                   const Estimate& estimate, const firmware::Recording* truth) {
  std::vector<WheelLoad> loads;
  if (std::vector<double> deflection = tyre_deflection(recording); !deflection.empty()) {
    for (double& value : deflection) value *= description.rig.tyre.stiffness;
    loads.push_back({"k_t dz_w", std::move(deflection), {}, {}});
  }
  if (recording.has(Channel::F_w)) loads.push_back({"sensor F_w", recording[Channel::F_w], {}, {}});
  loads.push_back({"filter", estimate.column("F_w_est"), {}, {}});
  if (truth == nullptr) return loads;
  demand_same_ducts(recording, *truth);
  const std::vector<double>& right = truth->required(Channel::F_w, "as the truth");
  for (WheelLoad& load : loads) {
    if (load.values.size() != right.size()) {
      throw firmware::InputError(truth->source, 0, "the truth has " + std::to_string(right.size()) + " rows",
                                 std::to_string(load.values.size()) + " as the recording");
    }
    compare(load, recording, right);
  }
  return loads;
}

std::string sentence(const Estimate& estimate) {
  const std::optional<bool> wrong = estimate.model_wrong();
  if (!wrong) {
    return "The model was not judged: the monitor of the innovations needs " +
           std::to_string(firmware::InnovationMonitor::block * (firmware::InnovationMonitor::settling + 1)) +
           " samples in a row, and the recording holds fewer. The mean NIS is " + report::figure_text(estimate.nis, 3) +
           ", of a right model 1.";
  }
  if (*wrong) return "The model is wrong for this recording: " + estimate.last_alarm + ".";
  return "The innovations do not contradict the model: " + std::to_string(estimate.blocks) +
         (estimate.blocks == 1 ? " block" : " blocks") + " judged." +
         (estimate.wide_rows == 0 ? ""
                                  : " In " + report::figure_text(100.0 * estimate.wide_share(), 2) +
                                        " % of the rows the road moved otherwise than described (a limited command, a "
                                        "step, a pothole, another shape); these are not judged.");
}

std::string report_page(const firmware::RigDescription& description, const firmware::Recording& recording,
                        const Estimate& estimate, const std::vector<WheelLoad>& loads,
                        const firmware::Recording* truth) {
  report::Report page("Wheel load and states by the Kalman filter", description.source + ", " + recording.source);
  const std::optional<bool> wrong = estimate.model_wrong();
  page.add_verdict(!wrong   ? report::Verdict::remark
                   : *wrong ? report::Verdict::bad
                            : report::Verdict::good,
                   sentence(estimate));
  page.add_section("Wheel load");
  const std::size_t first = first_row(recording), last = std::min(recording.size(), first + rows_shown);
  report::Figure figure;
  figure.title = "Dynamic wheel load";
  figure.note = truth != nullptr ? "Below: error against the truth." : "Below: sources against the filter.";
  figure.x = {"time", "s"};
  figure.height = 640;
  report::Panel above, below;
  above.y = {"wheel load", "N"};
  below.y = {truth != nullptr ? "error" : "difference from the filter", "N"};
  const std::vector<double>& reference = truth != nullptr ? (*truth)[Channel::F_w] : estimate.column("F_w_est");
  int colour = 0;
  for (const WheelLoad& load : loads) {
    above.curves.push_back(curve(load.name, recording.time, load.values, first, last, colour));
    std::vector<double> error = load.values;
    for (std::size_t k = 0; k < error.size(); ++k) error[k] -= reference[k];
    auto difference = curve(load.name, recording.time, error, first, last, colour++);
    difference.in_legend = false;
    if (truth != nullptr || load.name != "filter") below.curves.push_back(std::move(difference));
  }
  if (truth != nullptr) above.curves.push_back(curve("truth", recording.time, reference, first, last, 6));
  figure.panels = {above};
  if (!below.curves.empty()) figure.panels.push_back(below);
  page.add_figure(figure);
  if (truth != nullptr) {
    report::Table table{"Error of the wheel load, from 1 s on", {"source", "rms [N]", "of the truth's rms"}, {}, 1};
    for (const WheelLoad& load : loads) {
      table.rows.push_back(
          {load.name, figure_text(load.error_rms.value_or(0.0)), figure_text(load.error_share.value_or(0.0), 3)});
    }
    page.add_table(table);
  }
  page.add_text("The filter expects a standard deviation of " + figure_text(estimate.sigma_wheel_load, 3) +
                " N of its wheel load and of " + figure_text(estimate.sigma_velocity, 3) +
                " m/s of the deflection's velocity, if the model is right.");
  page.add_section("Innovations");
  report::Table table{"Normalised innovations; a right model has 1 and 0",
                      {"channel", "samples", "rms", "correlation of neighbours"},
                      {},
                      1};
  for (const ChannelInnovations& c : estimate.channels) {
    table.rows.push_back({std::string(model::name(c.channel)), std::to_string(c.count), figure_text(c.rms, 3),
                          figure_text(c.one_late, 2)});
  }
  page.add_table(table);
  page.add_appendix("Rig description", description.text);
  return page.html();
}

}  // namespace host_sim::estimation
