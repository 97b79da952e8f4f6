#include "host_sim/show/recording_page.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/frf/response_estimate.hpp"
#include "host_sim/report/channel_glossary.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::show {
namespace {

using model::Channel;
using report::Curve;
using report::Dash;
using report::figure_text;

/// [points] of a trace: at 1100 pixels seven a pixel, so that a zoom to a seventh loses nothing.
constexpr std::size_t points_of_trace = 8000;
/// [lines] of a spectrum.
constexpr std::size_t lines_of_spectrum = 4000;

std::vector<Channel> channels_of(const std::vector<Shown>& shown) {
  std::vector<Channel> list;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const Channel channel = model::channel_at(c);
    if (std::any_of(shown.begin(), shown.end(), [&](const Shown& s) { return s.recording.has(channel); })) {
      list.push_back(channel);
    }
  }
  return list;
}

std::string name_of(const Shown& one, const std::vector<Shown>& shown) {
  return shown.size() == 1 && one.models.empty() ? "recorded" : one.name;
}

/// Curves of a recording and of its models, the recording solid, the models dashed.
template <class Make>
void add_curves(report::Panel& panel, const std::vector<Shown>& shown, Channel channel,
                std::set<std::string>& in_legend, const Make& make) {
  constexpr Dash of_models[] = {Dash::dashed, Dash::dotted, Dash::dash_dotted};
  int colour = 0;
  for (const Shown& one : shown) {
    const bool has = one.recording.has(channel);
    const auto add = [&](const std::string& name, const std::vector<double>& values, Dash dash, int hue) {
      Curve curve = make(one.recording, values);
      if (curve.x.empty()) return;
      curve.name = name;
      curve.colour = hue;
      curve.dash = dash;
      curve.in_legend = in_legend.insert(name).second;  // in the first panel that has it
      panel.curves.push_back(std::move(curve));
    };
    if (has) add(name_of(one, shown), one.recording[channel], Dash::solid, colour);
    ++colour;
    for (std::size_t m = 0; m < one.models.size(); ++m) {
      const std::vector<double>& values = one.models[m].channels[index(channel)];
      const std::string of = shown.size() == 1 ? "" : " of " + one.name;
      if (has && values.size() == one.recording.size()) {
        add("model " + one.models[m].name + of, values, of_models[m % 3], colour);
      }
      ++colour;
    }
  }
}

report::Axis axis_of(Channel channel) { return {std::string(model::name(channel)), std::string(model::unit(channel))}; }

Curve spectrum_of(const firmware::Recording& recording, const std::vector<double>& values) {
  const double rate = 1.0 / recording.sample_period;
  // Blocks of four seconds resolve a body mode of 1.5 Hz; a short recording is one of its quarters.
  const auto block = static_cast<std::size_t>(std::min(4.0 * rate, 0.25 * static_cast<double>(values.size())));
  if (block < 8) return {};
  const PowerSpectrum spectrum = welch(values, rate, block);
  Curve curve;
  const std::size_t step = std::max<std::size_t>(1, spectrum.frequency.size() / lines_of_spectrum);
  for (std::size_t k = 1; k < spectrum.frequency.size(); k += step) {
    curve.x.push_back(spectrum.frequency[k]);
    curve.y.push_back(spectrum.density[k] > 0.0 ? spectrum.density[k] : std::nan(""));
  }
  return curve;
}

std::vector<std::pair<std::size_t, std::size_t>> rows_left_out(const std::vector<bool>& filled) {
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  for (std::size_t k = 0; k < filled.size(); ++k) {
    if (!filled[k]) continue;
    if (!runs.empty() && runs.back().second == k) {
      ++runs.back().second;
    } else {
      runs.emplace_back(k, k + 1);
    }
  }
  return runs;
}

/// Said of each recording: its remark, rows that are missing, columns that were not understood.
void add_left_out(report::Report& page, const std::vector<Shown>& shown) {
  page.add_section("What was left out");
  bool any = false;
  const auto say = [&](const std::string& text) {
    page.add_text(text);
    any = true;
  };
  for (const Shown& one : shown) {
    const firmware::Recording& r = one.recording;
    if (!r.remark.empty()) say(r.remark + ".");
    const auto runs = rows_left_out(r.filled);
    if (!runs.empty()) {
      std::size_t rows = 0;
      for (const auto& [from, to] : runs) rows += to - from;
      say(one.name + ": " + std::to_string(rows) + " rows were not recorded completely, the first at t = " +
          figure_text(r.time[runs.front().first], 6) + " s; their samples are gaps in the figures.");
    }
    for (const firmware::Recording::Gap& gap : r.gaps) {
      say(one.name + ": nothing was recorded from " + figure_text(gap.from, 6) + " to " + figure_text(gap.to, 6) +
          " s.");
    }
    if (r.ignored_columns.empty()) continue;
    std::string names;
    for (const std::string& column : r.ignored_columns) names += (names.empty() ? "" : ", ") + column;
    say(one.name + ": columns that are no channel: " + names +
        ". One of them becomes a channel by a line under [channels] of the rig description, such as F = { column = \"" +
        r.ignored_columns.front() + "\" }; rigtwin channels lists the channels.");
  }
  if (!any) page.add_text("Nothing.");
}

/// |H| and phase of the channels that follow z_r, all recordings in one panel a channel.
void add_responses(report::Report& page, const std::vector<Shown>& shown) {
  std::vector<Channel> outputs;
  for (const Channel channel : {Channel::F_w, Channel::zdd_b, Channel::dz_b, Channel::zdd_w}) {
    const auto has = [&](const Shown& s) { return s.recording.has(channel) && s.recording.has(Channel::z_r); };
    if (std::all_of(shown.begin(), shown.end(), has)) outputs.push_back(channel);
  }
  if (outputs.empty()) return;
  report::Figure figure;
  figure.title = "Responses to z_r";
  figure.note =
      "Magnitude by cross spectra; a line is left out where it is not distinguishable from 0. "
      "rigtwin frf gives bounds, phase and coherence.";
  figure.x = {"frequency", "Hz", true};
  for (const Channel output : outputs) {
    report::Panel panel;
    panel.y = {std::string(model::name(output)) + " ÷ z_r", std::string(model::unit(output)) + "/m", true};
    if (model::unit(output) == "m") panel.y.unit = "1";
    int colour = 0;
    for (const Shown& one : shown) {
      frf::Request request;
      request.input = Channel::z_r;
      request.outputs = {output};
      Curve curve;
      try {
        const frf::Responses r = frf::estimate_responses({&one.recording, 1}, request);
        const frf::OutputResponse& o = r.outputs.front();
        for (std::size_t k = 0; k < r.frequency.size(); ++k) {
          curve.x.push_back(r.frequency[k]);
          curve.y.push_back(o.determined[k] ? o.magnitude[k] : std::nan(""));
        }
      } catch (const firmware::InputError&) {  // too short, or z_r does not move: its other figures stand
      }
      curve.colour = colour++;
      curve.dash = Dash::by_turns;
      curve.name = name_of(one, shown);
      curve.in_legend = figure.panels.empty();
      if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
    }
    if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
  }
  if (figure.panels.empty()) return;
  figure.height = 120 + 190 * static_cast<int>(figure.panels.size());
  page.add_section("Responses");
  page.add_figure(figure);
}

}  // namespace

Trace thinned(const firmware::Recording& recording, const std::vector<double>& values, std::size_t most) {
  Trace trace;
  const std::size_t n = values.size();
  const std::size_t stretch = std::max<std::size_t>(1, (2 * n + most - 1) / std::max<std::size_t>(most, 2));
  const auto& filled = recording.filled;
  const auto left_out = [&](std::size_t k) { return k < filled.size() && filled[k]; };
  const double first = recording.time.empty() ? 0.0 : recording.time.front();
  const auto put = [&](std::size_t k, double value) {
    trace.time.push_back(recording.time[k] - first);
    trace.values.push_back(value);
  };
  for (std::size_t from = 0; from < n; from += stretch) {
    const std::size_t to = std::min(n, from + stretch);
    std::size_t low = n, high = n;
    bool gap = false;
    for (std::size_t k = from; k < to; ++k) {
      if (left_out(k) || !std::isfinite(values[k])) {
        gap = true;
        continue;
      }
      if (low == n || values[k] < values[low]) low = k;
      if (high == n || values[k] > values[high]) high = k;
    }
    if (low != n) {
      put(std::min(low, high), values[std::min(low, high)]);
      if (low != high) put(std::max(low, high), values[std::max(low, high)]);
    }
    if (gap) put(to - 1, std::numeric_limits<double>::quiet_NaN());
  }
  return trace;
}

void add_traces(report::Report& page, const std::vector<Shown>& shown) {
  report::Figure figure;
  figure.title = "Over time";
  figure.note = "Drag over one panel: all of them zoom to the same time.";
  figure.x = {"time from the first sample", "s"};
  std::set<std::string> in_legend;
  for (const Channel channel : channels_of(shown)) {
    report::Panel panel;
    panel.y = axis_of(channel);
    add_curves(panel, shown, channel, in_legend,
               [](const firmware::Recording& recording, const std::vector<double>& values) {
                 Trace trace = thinned(recording, values, points_of_trace);
                 Curve curve;
                 curve.x = std::move(trace.time);
                 curve.y = std::move(trace.values);
                 return curve;
               });
    if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
  }
  if (figure.panels.empty()) return;
  figure.height = 120 + 150 * static_cast<int>(figure.panels.size());
  page.add_section("Traces");
  page.add_figure(figure);
}

void add_spectra(report::Report& page, const std::vector<Shown>& shown) {
  report::Figure figure;
  std::set<std::string> in_legend;
  figure.title = "By frequency";
  figure.note = "Power spectral density by Welch's method, blocks of four seconds, each without its mean.";
  figure.x = {"frequency", "Hz", true};
  for (const Channel channel : channels_of(shown)) {
    report::Panel panel;
    panel.y = axis_of(channel);
    const bool compound = panel.y.unit.find('/') != std::string::npos;
    panel.y.unit = compound ? "(" + panel.y.unit + ")²/Hz" : panel.y.unit + "²/Hz";
    panel.y.logarithmic = true;
    add_curves(panel, shown, channel, in_legend, spectrum_of);
    if (!panel.curves.empty()) figure.panels.push_back(std::move(panel));
  }
  if (figure.panels.empty()) return;
  figure.height = 120 + 150 * static_cast<int>(figure.panels.size());
  page.add_section("Spectra");
  page.add_figure(figure);
}

void add_statistics(report::Report& page, const std::vector<Shown>& shown) {
  report::Table table{
      "", {"channel", "unit", "recording", "mean", "rms about the mean", "lowest", "highest", "samples"}, {}, 3};
  for (const Channel channel : channels_of(shown)) {
    for (const Shown& one : shown) {
      if (!one.recording.has(channel)) continue;
      double sum = 0.0, count = 0.0, low = INFINITY, high = -INFINITY;
      const std::vector<double>& values = one.recording[channel];
      const auto counts = [&](std::size_t k) {
        return (one.recording.filled.empty() || !one.recording.filled[k]) && std::isfinite(values[k]);
      };
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (!counts(k)) continue;
        sum += values[k];
        count += 1.0;
        low = std::min(low, values[k]);
        high = std::max(high, values[k]);
      }
      if (!(count > 0.0)) continue;
      const double mean = sum / count;
      double squares = 0.0;
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (counts(k)) squares += (values[k] - mean) * (values[k] - mean);
      }
      table.rows.push_back({std::string(model::name(channel)), std::string(model::unit(channel)), one.name,
                            figure_text(mean, 4), figure_text(std::sqrt(squares / count), 4), figure_text(low, 4),
                            figure_text(high, 4), figure_text(count, 7)});
    }
  }
  page.add_section("Statistics");
  page.add_table(table);
}

std::string sentence(const std::vector<Shown>& shown) {
  std::string text;
  for (const Shown& one : shown) {
    const firmware::Recording& r = one.recording;
    std::size_t channels = 0;
    for (const auto& column : r.channels) channels += column.empty() ? 0U : 1U;
    std::size_t filled = 0;
    for (const bool row : r.filled) filled += row ? 1U : 0U;
    text += (text.empty() ? "" : " ") + one.name + ": " +
            figure_text(static_cast<double>(r.size()) * r.sample_period, 4) + " s at " +
            figure_text(1.0 / r.sample_period, 6) + " Hz, " + std::to_string(channels) +
            (channels == 1 ? " channel" : " channels") +
            (filled > 0 ? ", " + std::to_string(filled) + " rows left out" : "") + ".";
  }
  return text;
}

std::string recordings_page(const std::vector<Shown>& shown) {
  std::string title;
  for (const Shown& one : shown) title += (title.empty() ? "" : ", ") + one.name;
  report::Report page(title);
  page.add_verdict(report::Verdict::remark, sentence(shown));
  add_traces(page, shown);
  add_spectra(page, shown);
  add_responses(page, shown);
  add_statistics(page, shown);
  add_left_out(page, shown);
  return page.html();
}

}  // namespace host_sim::show
