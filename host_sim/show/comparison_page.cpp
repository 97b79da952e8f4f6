#include "host_sim/show/comparison_page.hpp"

#include <algorithm>
#include <cmath>

namespace host_sim::show {
namespace {

using report::Curve;
using report::Dash;
using report::figure_text;

const BandError* worst_band(const ChannelComparison& channel) {
  const auto worst = std::max_element(channel.bands.begin(), channel.bands.end(),
                                      [](const auto& a, const auto& b) { return a.error_rms < b.error_rms; });
  return worst == channel.bands.end() ? nullptr : &*worst;
}

std::string per_cent(double share) { return figure_text(100.0 * share, 3) + " %"; }

void add_error_by_band(report::Report& page, const std::vector<ChannelComparison>& pooled) {
  report::Figure figure;
  figure.title = "Error by third-octave band";
  figure.note =
      "rms of simulated − measured in a band ÷ rms of the whole channel: the squares of a curve add up to the "
      "square of the channel's error.";
  figure.x = {"frequency", "Hz", true};
  report::Panel panel;
  panel.y = {"error ÷ rms of the channel", "%", true};
  for (const ChannelComparison& channel : pooled) {
    if (!(channel.data_rms > 0.0)) continue;
    Curve curve;
    curve.name = std::string(model::name(channel.channel));
    for (const BandError& band : channel.bands) {
      curve.x.push_back(band.band.centre);
      const double share = 100.0 * band.error_rms / channel.data_rms;
      curve.y.push_back(share > 0.0 ? share : std::nan(""));
    }
    if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
  }
  if (panel.curves.empty()) return;
  figure.panels.push_back(std::move(panel));
  page.add_section("Where the error is");
  page.add_figure(figure);
}

/// Simulated over measured, in units of the channel's rms: a model that is right lies on the diagonal.
void add_scatter(report::Report& page, const std::vector<Shown>& shown, const std::vector<ChannelComparison>& pooled) {
  constexpr std::size_t most_points = 1500;  // of a channel and recording
  report::Figure figure;
  figure.title = "Simulated over measured";
  figure.note =
      "Each ÷ rms of the channel. A right model lies on the diagonal; another slope is a gain, a loop a delay, "
      "a bend a nonlinear force.";
  figure.x = {"measured ÷ rms", "1"};
  figure.equal_axes = true;
  figure.height = 560;
  report::Panel panel;
  panel.y = {"simulated ÷ rms", "1"};
  double far = 0.0;
  for (const ChannelComparison& channel : pooled) {
    if (!(channel.data_rms > 0.0)) continue;
    Curve curve;
    curve.name = std::string(model::name(channel.channel));
    curve.dash = Dash::none;
    curve.marker = report::Marker::circle;
    for (const Shown& one : shown) {
      if (one.models.empty() || !one.recording.has(channel.channel)) continue;
      const auto& measured = one.recording[channel.channel];
      const auto& simulated = one.models.front().channels[index(channel.channel)];
      if (simulated.size() != measured.size()) continue;
      const std::size_t step = std::max<std::size_t>(1, measured.size() / most_points);
      for (std::size_t k = 0; k < measured.size(); k += step) {
        if (k < one.recording.filled.size() && one.recording.filled[k]) continue;
        curve.x.push_back(measured[k] / channel.data_rms);
        curve.y.push_back(simulated[k] / channel.data_rms);
        far = std::max({far, std::abs(curve.x.back()), std::abs(curve.y.back())});
      }
    }
    if (!curve.x.empty()) panel.curves.push_back(std::move(curve));
  }
  if (panel.curves.empty() || !std::isfinite(far)) return;
  Curve diagonal{"equal", {-far, far}, {-far, far}, 6, Dash::dashed};
  panel.curves.push_back(std::move(diagonal));
  figure.panels.push_back(std::move(panel));
  page.add_figure(figure);
}

}  // namespace

std::string sentence(const std::vector<ChannelComparison>& pooled, const std::string& rig) {
  std::vector<const ChannelComparison*> sorted;
  for (const ChannelComparison& channel : pooled) {
    if (std::isfinite(channel.nrmse)) sorted.push_back(&channel);
  }
  if (sorted.empty()) return "Nothing of the recording moves.";
  std::sort(sorted.begin(), sorted.end(), [](const auto* a, const auto* b) { return a->nrmse > b->nrmse; });
  const ChannelComparison& most = *sorted.front();
  std::string text =
      "The model of " + rig + " leaves " + per_cent(most.nrmse) + " of " + std::string(model::name(most.channel));
  if (const BandError* worst = worst_band(most); worst != nullptr && most.error_rms > 0.0) {
    text += ", most of it at " + nominal_name(worst->band) + " Hz";
  }
  if (sorted.size() > 1) {
    text += ", and " + per_cent(sorted.back()->nrmse) + " of " + std::string(model::name(sorted.back()->channel)) +
            ", the least of " + std::to_string(sorted.size()) + " channels";
  }
  return text + ".";
}

std::string comparison_page(const std::vector<Shown>& shown, const std::vector<RecordingComparison>& comparisons,
                            const std::vector<ChannelComparison>& pooled, const std::string& rig) {
  std::string title;
  for (const Shown& one : shown) title += (title.empty() ? "" : ", ") + one.name;
  report::Report page("Comparison of " + title + " with " + rig);
  page.add_verdict(report::Verdict::remark, sentence(pooled, rig));
  for (const RecordingComparison& comparison : comparisons) {
    for (const StaticValue& value : comparison.tared) page.add_text(comparison.source + ": " + words(value) + ".");
  }
  add_traces(page, shown);
  add_error_by_band(page, pooled);
  add_scatter(page, shown, pooled);
  page.add_section("Numbers");
  report::Table table{
      "", {"recording", "channel", "unit", "error [%]", "rms error", "rms about the mean", "clipped samples"}, {}, 3};
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    for (const ChannelComparison& c : comparisons[i].channels) {
      table.rows.push_back({i < shown.size() ? shown[i].name : comparisons[i].source,
                            std::string(model::name(c.channel)), std::string(model::unit(c.channel)),
                            std::isfinite(c.nrmse) ? figure_text(100.0 * c.nrmse, 3) : "–", figure_text(c.error_rms, 4),
                            figure_text(c.data_rms, 4), std::to_string(c.clipped)});
    }
  }
  page.add_table(table);
  add_spectra(page, shown);
  return page.html();
}

}  // namespace host_sim::show
