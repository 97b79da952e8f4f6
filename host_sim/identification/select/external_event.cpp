#include "host_sim/identification/select/external_event.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host_sim/identification/estimate/residual_over_time.hpp"
#include "host_sim/identification/parity/disturbed_span.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/identification/select/thresholds.hpp"

namespace host_sim::identification {
namespace {

/// Stretches of one recording whose residuals stand out.
struct LoudStretches {
  std::size_t recording = 0;
  double from = 0.0, to = 0.0;  ///< [s]
  double peak_to = 0.0;         ///< [s] end of the loudest
  double ratio = 0.0;           ///< power of the loudest ÷ that of three quarters of all others
};

/// In one series of powers: the run around the loudest stretch, until the power is that of the others again.
std::optional<LoudStretches> loudest(const std::vector<StretchPower>& stretches, const std::vector<double>& powers) {
  if (powers.size() < 8) return std::nullopt;
  std::vector<double> sorted = powers;
  std::sort(sorted.begin(), sorted.end());
  const double usual = std::max(sorted[sorted.size() * 3 / 4], 1.0), middle = std::max(sorted[sorted.size() / 2], 1.0);
  const auto peak = static_cast<std::size_t>(std::max_element(powers.begin(), powers.end()) - powers.begin());
  const bool noise_else = usual < thresholds::only_noise_else;
  if (powers[peak] < usual * (noise_else ? thresholds::loud_in_noise : thresholds::loud_in_rest)) return std::nullopt;
  const double quiet = thresholds::quiet_again * (noise_else ? usual : middle);
  std::size_t first = peak, last = peak;
  const auto same = [&](std::size_t k) { return stretches[k].recording == stretches[peak].recording; };
  while (first > 0 && same(first - 1) && powers[first - 1] > quiet) --first;
  while (last + 1 < powers.size() && same(last + 1) && powers[last + 1] > quiet) ++last;
  if (static_cast<double>(last - first + 1) > thresholds::most_left_out * static_cast<double>(powers.size())) {
    return std::nullopt;
  }
  return LoudStretches{stretches[peak].recording, stretches[first].from, stretches[last].to, stretches[peak].to,
                       powers[peak] / usual};
}

std::optional<LoudStretches> loud_stretches(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  const auto stretches = stretch_powers(problem, read_all(problem, hypothesis), thresholds::event_stretch);
  const std::size_t channels = problem.channels().size();
  std::optional<LoudStretches> best;
  for (std::size_t c = 0; c <= channels; ++c) {  // the last: all together
    std::vector<double> powers;
    for (const StretchPower& stretch : stretches) {
      Power sum;
      for (std::size_t i = 0; i < channels; ++i) {
        if (c < channels && i != c) continue;
        const Power power = stretch.of_channel(i);
        sum.squares += power.squares;
        sum.count += power.count;
      }
      powers.push_back(sum.ratio());
    }
    const auto loud = loudest(stretches, powers);
    if (loud && (!best || loud->ratio > best->ratio)) best = loud;
  }
  return best;
}

/// The samples of a stretch [s].
Window samples_of_stretch(const PreparedRecording& recording, double from, double to) {
  const std::vector<double>& time = recording.recording.time;
  const auto first = std::lower_bound(time.begin(), time.end(), from), last = std::upper_bound(first, time.end(), to);
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(last - time.begin())};
}

/// Residuals of the fitted windows in these samples.
double residuals_in(const IdentificationProblem& problem, std::size_t recording, Window samples) {
  const ProblemRecording& r = problem.recordings()[recording];
  if (!r.is_fitted()) return 0.0;
  const Window window = r.fit_whitening->window();
  const std::size_t from = std::max(samples.from, window.from), to = std::min(samples.to, window.to);
  if (to <= from) return 0.0;
  return static_cast<double>(r.fit_whitening->count()) * static_cast<double>(to - from) /
         static_cast<double>(window.size());
}

bool leaves_rest(const IdentificationProblem& problem, const SearchResult& found) {
  return find_rest(problem, found.best.fit.hypothesis).found();
}

}  // namespace

void leave_out_events(const firmware::RigDescription& description, IdentificationProblem& problem,
                      const SearchSpace& space, const ProgressCallback& progress, SearchResult& found) {
  const SelectionCriterion criterion;
  for (std::size_t n = 0; n < thresholds::most_events && leaves_rest(problem, found); ++n) {
    // Without effects first: they may have been bent to explain the event.
    std::optional<LoudStretches> loud = loud_stretches(problem, found.nothing.fit.hypothesis);
    if (!loud) loud = loud_stretches(problem, found.best.fit.hypothesis);
    if (!loud) return;
    const PreparedRecording& recording = problem.samples()[loud->recording];
    const Window samples = samples_of_stretch(recording, loud->from, loud->to);
    TimeSpan span{loud->from, loud->peak_to};
    const TimeSpan within{loud->from - thresholds::event_stretch, loud->to};
    if (const auto sharp = disturbed_span(description, recording, within)) span = *sharp;

    const double left_out = residuals_in(problem, loud->recording, samples);
    IdentificationProblem without = problem;
    without.leave_out(loud->recording, samples);
    SearchResult again = select_model(without, space, progress);
    const double price =
        criterion.effect + criterion.parameter * (2.0 + 2.0 * thresholds::event_bandwidth * (span.to - span.from));
    const double gain =
        found.best.penalised_chi_squared(criterion) - again.best.penalised_chi_squared(criterion) - left_out - price;
    // What is held out has no part in (1): the event is believed where the rest goes away with it.
    const bool held_out = samples.to > problem.recordings()[loud->recording].fitted.to;
    const bool better = gain > 0.0 || (held_out && !leaves_rest(without, again));
    if (!better) return;
    again.simulations += found.simulations;
    again.candidates += found.candidates;
    again.events = std::move(found.events);
    again.events.push_back({loud->recording, span.from, span.to, std::max(gain, 0.0)});
    found = std::move(again);
    problem = std::move(without);
  }
}

}  // namespace host_sim::identification
