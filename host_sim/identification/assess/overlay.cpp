#include "host_sim/identification/assess/overlay.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {

using model::Channel;

namespace {

/// The recording that is shown: the first that is held out, else the first that is fitted.
std::size_t shown_recording(const IdentificationProblem& problem) {
  const auto& recordings = problem.recordings();
  const auto held_out =
      std::find_if(recordings.begin(), recordings.end(), [](const ProblemRecording& r) { return r.is_held_out(); });
  const auto fitted =
      std::find_if(recordings.begin(), recordings.end(), [](const ProblemRecording& r) { return r.is_fitted(); });
  return static_cast<std::size_t>((held_out != recordings.end() ? held_out : fitted) - recordings.begin());
}

/// Densities of a window, without 0 Hz, which has no place on a logarithmic axis, up to where residuals are compared.
class Densities {
 public:
  Densities(Window window, double rate) : window_(window), rate_(rate) {}

  [[nodiscard]] std::vector<double> of(const std::vector<double>& values) { return cut(spectrum(values).density); }
  [[nodiscard]] std::vector<double> of_error(const std::vector<double>& measured,
                                             const std::vector<double>& simulated) {
    std::vector<double> error(measured.size());
    for (std::size_t k = window_.from; k < window_.to; ++k) error[k] = measured[k] - simulated[k];
    return of(error);
  }
  [[nodiscard]] const std::vector<double>& frequency() const { return frequency_; }

 private:
  [[nodiscard]] PowerSpectrum spectrum(const std::vector<double>& values) {
    constexpr double segment = 2.0;  // [s]: lines of 0.5 Hz
    PowerSpectrum found = welch(std::span(values).subspan(window_.from, window_.size()), rate_,
                                static_cast<std::size_t>(segment * rate_));
    count_ = 0;
    while (count_ < found.frequency.size() && found.frequency[count_] <= thresholds::highest_frequency) ++count_;
    frequency_ = cut(found.frequency);
    return found;
  }
  [[nodiscard]] std::vector<double> cut(std::vector<double> values) const {
    values.resize(count_);
    if (!values.empty()) values.erase(values.begin());
    return values;
  }

  Window window_;
  double rate_;
  std::size_t count_ = 0;
  std::vector<double> frequency_;
};

}  // namespace

std::vector<Overlay> overlays_of(const IdentificationProblem& problem, const Hypothesis& given, const Hypothesis& refit,
                                 const Hypothesis& after) {
  const std::size_t i = shown_recording(problem);
  const ProblemRecording& shown = problem.recordings()[i];
  const PreparedRecording& samples = *shown.samples;
  const Window window = shown.is_held_out() ? shown.held_out : shown.fitted;
  const auto simulated = [&](const Hypothesis& h) {
    return read_channels(h, samples, samples.input, h.starts[i], window.to, shown.resolution());
  };
  const Response by_given = simulated(given), by_refit = simulated(refit), by_after = simulated(after);
  const double rate = 1.0 / samples.input.period;
  constexpr double seconds = 1.5;  // that are shown over time
  const auto length = std::min(static_cast<std::size_t>(seconds * rate), window.size());
  const std::size_t from = window.from + (window.size() - length) / 2;
  std::vector<Overlay> overlays;
  for (const Channel channel : samples.channels) {
    const auto c = index(channel);
    const auto& data = samples.recording[channel];
    Densities densities(window, rate);
    Overlay overlay;
    overlay.channel = channel;
    overlay.data = densities.of(data);
    overlay.error_before = densities.of_error(data, by_given[c]);
    overlay.error_refit = densities.of_error(data, by_refit[c]);
    overlay.error_after = densities.of_error(data, by_after[c]);
    overlay.frequency = densities.frequency();
    overlay.noise = 2.0 * samples.noise[c] * samples.noise[c] * samples.compared_period();
    for (std::size_t k = from; k < from + length; ++k) {
      overlay.time.push_back(samples.recording.time[k]);
      overlay.measured.push_back(data[k]);
      overlay.refit.push_back(by_refit[c][k]);
      overlay.after.push_back(by_after[c][k]);
    }
    overlays.push_back(std::move(overlay));
  }
  return overlays;
}

}  // namespace host_sim::identification
