#include "host_sim/identification/estimate/residual_over_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "host_sim/identification/common/parallel.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/identification/noise/thresholds.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"

namespace host_sim::identification {
namespace {

using BandPowers = std::array<Power, noise_bands>;

void add(Power& sum, const Power& power) {
  sum.squares += power.squares;
  sum.count += power.count;
}

/// A part of a recording that is whitened by itself.
struct Part {
  std::size_t recording;
  bool held_out;
  Window window;
};

/// A stretch of so many seconds, or as long as it takes to hold what is whitened by itself.
double at_least(double seconds, const ProblemRecording& r) {
  return std::max(seconds, static_cast<double>(thresholds::shortest_whitened) * r.samples->compared_period());
}

std::vector<Part> parts_of(const IdentificationProblem& problem, double seconds) {
  std::vector<Part> parts;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    for (const Window* each : {&r.fitted, &r.held_out}) {
      const Window& window = *each;
      const auto samples = static_cast<double>(window.size());
      if (window.size() == 0) continue;
      const auto count =
          static_cast<std::size_t>(std::max(1.0, std::round(samples * r.samples->input.period / at_least(seconds, r))));
      for (std::size_t p = 0; p < count; ++p) {
        const auto edge = [&](std::size_t k) { return window.from + window.size() * k / count; };
        parts.push_back({i, &window == &r.held_out, {edge(p), edge(p + 1)}});
      }
    }
  }
  return parts;
}

StretchPower power_of(const IdentificationProblem& problem, const Response& response, const Part& part) {
  const ProblemRecording& r = problem.recordings()[part.recording];
  const std::size_t channels = r.samples->channels.size();
  const Whitening whitening = problem.whitening(part.recording, part.window);
  const Spectra simulated = whitening.spectra(*r.samples, response);
  const std::vector<double> each_alone = whitening.by_channel(simulated);
  std::vector<double> independent(whitening.count());
  whitening.whiten(simulated, independent.data());
  StretchPower stretch{part.recording,
                       part.held_out,
                       r.samples->recording.time[whitening.window().from],
                       r.samples->recording.time[whitening.window().to - 1],
                       std::vector<BandPowers>(channels),
                       {},
                       whitening.spread()};
  for (std::size_t k = 0; k < whitening.bins(); ++k) {
    const std::size_t b = std::min(noise_bands - 1, noise_band_of(whitening.frequency(k)));
    for (std::size_t c = 0; c < channels; ++c) {
      const std::size_t at = 2 * (k * channels + c);
      for (std::size_t part_of = 0; part_of < 2; ++part_of) {
        if (k == 0 && part_of == 1) continue;     // the sum of the samples is real
        const double share = k == 0 ? 0.5 : 1.0;  // and has twice the variance
        add(stretch.powers[c][b], {share * std::pow(each_alone[at + part_of], 2), 1.0});
        add(stretch.together[b], {share * std::pow(independent[at + part_of], 2), 1.0});
      }
    }
  }
  return stretch;
}

/// (2)
double deviations(const Power& power, double spread) {
  if (!(power.count > 0.0)) return 0.0;
  const double variance = 2.0 * spread / (9.0 * power.count);
  return (std::cbrt(power.ratio()) - 1.0 + variance) / std::sqrt(variance);
}

/// The z that a normal number exceeds with this small probability. Source: (26.2.23) of M. Abramowitz and I. Stegun,
/// Handbook of Mathematical Functions, 1964; its error is below 5e-4.
double exceeded_with(double probability) {
  const double t = std::sqrt(-2.0 * std::log(probability));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

/// δ of (3) of one channel.
double level_error(const IdentificationProblem& problem, std::size_t channel, bool corners) {
  double least = corners ? thresholds::corner_power_error : thresholds::noise_variance_error;
  for (const ProblemRecording& r : problem.recordings()) {
    const auto& factor = r.samples->noise_factor[index(r.samples->channels[channel])];
    if (factor) least = std::max(least, factor->half_width / std::max(factor->value, 1e-9));  // 2 · half/1.96
  }
  return least;
}

/// Keeps the surest of all tests, and counts them.
class Tests {
 public:
  Tests(const IdentificationProblem& problem, bool corners) : channels_(problem.channels()), corners_(corners) {
    for (std::size_t c = 0; c < channels_.size(); ++c) errors_.push_back(level_error(problem, c, corners));
  }

  /// Every channel and all together, in every band and over all bands, of one stretch or of the whole record.
  void add(const std::vector<BandPowers>& powers, const BandPowers& together, double spread,
           const StretchPower* stretch) {
    double error = 0.0;
    Power all;
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      Power whole;
      for (std::size_t b = 0; b < noise_bands; ++b) {
        test(powers[c][b], spread, errors_[c], &channels_[c], b, b + 1, stretch);
        identification::add(whole, powers[c][b]);
      }
      test(whole, spread, errors_[c], &channels_[c], 0, noise_bands, stretch);
      error += std::pow(errors_[c], 2) / static_cast<double>(channels_.size());
    }
    // Those of levels are independent; a corner's instant is wrong in every channel.
    if (!corners_) error /= static_cast<double>(channels_.size());
    for (std::size_t b = 0; b < noise_bands; ++b) {
      test(together[b], spread, std::sqrt(error), nullptr, b, b + 1, stretch);
      identification::add(all, together[b]);
    }
    test(all, spread, std::sqrt(error), nullptr, 0, noise_bands, stretch);
  }

  [[nodiscard]] Rest surest() const {
    Rest rest = surest_;
    if (count_ > 0.0) rest.threshold = exceeded_with(thresholds::family_error / count_);
    return rest;
  }

 private:
  void test(const Power& power, double spread, double error, const model::Channel* channel, std::size_t first,
            std::size_t last, const StretchPower* stretch) {
    if (power.count < thresholds::fewest_tested) return;
    count_ += 1.0;
    const double z = deviations(power, spread) / std::sqrt(1.0 + 0.5 * error * error * power.count / spread);
    if (!(z > surest_.z)) return;
    surest_.z = z;
    surest_.ratio = power.ratio();
    surest_.all_channels = channel == nullptr;
    if (channel != nullptr) surest_.channel = *channel;
    surest_.lowest = noise_band_edges[first];
    surest_.highest = noise_band_edges[last];
    surest_.all_time = stretch == nullptr;
    if (stretch == nullptr) return;
    surest_.recording = stretch->recording;
    surest_.from = stretch->from;
    surest_.to = stretch->to;
  }

  std::vector<model::Channel> channels_;
  bool corners_;
  std::vector<double> errors_;
  Rest surest_;
  double count_ = 0.0;
};

/// [s] of all fitted and held-out windows.
double tested_seconds(const IdentificationProblem& problem) {
  double sum = 0.0;
  for (const ProblemRecording& r : problem.recordings()) {
    sum += static_cast<double>(r.fitted.size() + r.held_out.size()) * r.samples->input.period;
  }
  return sum;
}

}  // namespace

Power StretchPower::of_channel(std::size_t channel) const {
  Power sum;
  for (const Power& power : powers[channel]) add(sum, power);
  return sum;
}

double shown_stretch(const IdentificationProblem& problem) {
  return std::max(1.0, tested_seconds(problem) / thresholds::most_seconds_shown);
}

std::vector<StretchPower> stretch_powers(const IdentificationProblem& problem, const std::vector<Response>& responses,
                                         double seconds) {
  const std::vector<Part> parts = parts_of(problem, seconds);
  std::vector<StretchPower> stretches(parts.size());
  for_all(parts.size(),
          [&](std::size_t p) { stretches[p] = power_of(problem, responses[parts[p].recording], parts[p]); });
  return stretches;
}

namespace {

/// The tests of all windows, or of those that are fitted.
Rest surest_test(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                 const std::vector<StretchPower>& windows, const std::vector<StretchPower>& stretches, bool held_out) {
  Tests tests(problem, corners_are_blurred(problem, hypothesis));
  std::vector<BandPowers> whole(problem.channels().size());
  BandPowers together{};
  double spread = 0.0, count = 0.0;
  for (const StretchPower& window : windows) {
    if (window.held_out && !held_out) continue;
    for (std::size_t b = 0; b < noise_bands; ++b) add(together[b], window.together[b]);
    for (std::size_t c = 0; c < whole.size(); ++c) {
      for (std::size_t b = 0; b < noise_bands; ++b) add(whole[c][b], window.powers[c][b]);
    }
    spread += window.spread;
    count += 1.0;
  }
  if (!(count > 0.0)) return {};
  tests.add(whole, together, spread / count, nullptr);
  for (const StretchPower& stretch : stretches) {
    if (!stretch.held_out || held_out) tests.add(stretch.powers, stretch.together, stretch.spread, &stretch);
  }
  return tests.surest();
}

}  // namespace

Rest find_rest(const IdentificationProblem& problem, const Hypothesis& hypothesis,
               const std::vector<Response>& responses) {
  const double seconds = tested_seconds(problem);
  // The whole record: its windows as they are, since a longer window loses less at its ends.
  const auto windows = stretch_powers(problem, responses, seconds);
  const double each = std::max(seconds / thresholds::stretches, thresholds::shortest_stretch);
  const auto stretches = stretch_powers(problem, responses, each);
  Rest rest = surest_test(problem, hypothesis, windows, stretches, true);
  rest.is_fitted = rest.found() && surest_test(problem, hypothesis, windows, stretches, false).found();
  return rest;
}

std::string Rest::words() const {
  char band[64], time[80] = "";
  std::snprintf(band, sizeof band, ", %.3g to %.3g Hz", lowest, highest);
  if (!all_time) std::snprintf(time, sizeof time, ", %.4g to %.4g s", from, to);
  char power[64];
  std::snprintf(power, sizeof power, ": %.2f times the power of its noise", ratio);
  return std::string(all_channels ? "all channels together" : std::string(model::name(channel))) + band + time + power;
}

}  // namespace host_sim::identification
