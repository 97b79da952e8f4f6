#include "host_sim/diagnose/overlay.hpp"

#include <algorithm>
#include <utility>

#include "host_sim/diagnose/readings.hpp"
#include "host_sim/spectrum.hpp"

namespace host_sim::diagnose {

using model::Channel;

std::vector<Overlay> overlays_of(const Case& all, const Hypothesis& given, const Hypothesis& refit,
                                 const Hypothesis& after) {
  const std::size_t r = all.judged.empty() ? all.fitted.front() : all.judged.front();
  const Evidence& e = all.evidence[r];
  const Window window = e.judge.size() > 0 ? e.judge : e.fit;
  const auto respond_with = [&](const Hypothesis& h) { return read_channels(h, e, e.drive, h.starts[r], window.to); };
  const Response before_response = respond_with(given), refit_response = respond_with(refit),
                 after_response = respond_with(after);
  const double rate = 1.0 / e.drive.period;
  const auto segment = static_cast<std::size_t>(2.0 * rate), shown = static_cast<std::size_t>(1.5 * rate);
  std::vector<Overlay> overlays;
  for (const Channel channel : e.channels) {
    const auto c = index(channel);
    const auto& data = e.recording[channel];
    Overlay overlay;
    overlay.channel = channel;
    const auto cut = [&](const std::vector<double>& values) {
      return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(window.from),
                                 values.begin() + static_cast<std::ptrdiff_t>(window.to));
    };
    const auto density = [&](std::vector<double> values) {
      const PowerSpectrum spectrum = welch(values, rate, segment);
      overlay.frequency = spectrum.frequency;
      return spectrum.density;
    };
    const auto error = [&](const Response& response) {
      std::vector<double> values = cut(data);
      for (std::size_t k = 0; k < values.size(); ++k) values[k] -= response[c][window.from + k];
      return density(std::move(values));
    };
    overlay.data = density(cut(data));
    overlay.error_before = error(before_response);
    overlay.error_refit = error(refit_response);
    overlay.error_after = error(after_response);
    std::size_t count = 0;
    while (count < overlay.frequency.size() && overlay.frequency[count] <= Whitening::highest) ++count;
    for (auto* values :
         {&overlay.frequency, &overlay.data, &overlay.error_before, &overlay.error_refit, &overlay.error_after}) {
      values->resize(count);
      if (!values->empty()) values->erase(values->begin());  // no place for 0 Hz on a logarithmic axis
    }
    overlay.noise = 2.0 * e.noise[c] * e.noise[c] / rate;
    const std::size_t from = window.from + (window.size() - std::min(shown, window.size())) / 2;
    for (std::size_t k = from; k < std::min(from + shown, window.to); ++k) {
      overlay.time.push_back(e.recording.time[k]);
      overlay.measured.push_back(data[k]);
      overlay.refit.push_back(refit_response[c][k]);
      overlay.after.push_back(after_response[c][k]);
    }
    overlays.push_back(std::move(overlay));
  }
  return overlays;
}

}  // namespace host_sim::diagnose
