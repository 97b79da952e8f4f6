#include "host_sim/identification/noise/identification_problem.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

/// [s] A truncated window is no shorter: two periods of 1 Hz.
constexpr double shortest_truncated = 2.0;

/// Whether a channel's noise is known as an upper bound only: white noise that nobody has declared was read off the
/// samples' highest third of the frequencies, and motion that reaches there passes for noise.
bool is_bound(const PreparedRecording& r, Channel channel) {
  const ChannelNoise& noise = r.channel_noise[index(channel)];
  return !r.declared_noise[index(channel)] && noise.is_known() && noise.colour.is_white();
}

/// True if the residual of a hypothesis may be a better estimate of a channel's noise than the channel itself.
bool is_open(const PreparedRecording& r, Channel channel) {
  const ChannelNoise& noise = r.channel_noise[index(channel)];
  return !r.renewals[index(channel)] && (!noise.is_known() || !noise.colour.is_white() || is_bound(r, channel));
}

/// The colour of noise behind the filter that a hypothesis has for this channel. Its signal says the corner a hundred
/// times as exactly as noise does.
std::optional<NoiseColour> filter_in(const Hypothesis& hypothesis, Channel channel) {
  for (const PlacedFault& fault : hypothesis.faults) {
    if (fault.kind != FaultKind::common_filter || !fault.is_of(channel)) continue;
    return NoiseColour{fault.values.front(), fault.order,
                       fault.digital ? NoiseColour::Filter::digital : NoiseColour::Filter::analogue};
  }
  return std::nullopt;
}

/// The highest level of noise of that colour that the channel's own spectrum holds; 0: not known.
double highest_level_of(const PreparedRecording& r, Channel channel, const NoiseColour& colour) {
  const ChannelNoise& own = r.channel_noise[index(channel)];
  if (own.highest_level == 0.0 || own.colour == colour) return own.highest_level;
  const ChannelNoise again = noise_in(r.recording[channel], r.recording.sample_period, channel, colour);
  return again.colour == colour ? again.highest_level : own.highest_level;
}

/// Measured minus read, samples that are not to be used left out.
std::vector<double> left_of(const PreparedRecording& r, Channel channel, const Response& read) {
  const auto c = index(channel);
  const Window window = r.comparable(channel, r.fitted.size() > 0 ? r.fitted : r.held_out);
  std::vector<double> left;
  for (std::size_t k = r.compared_from(window.from); k < window.to; k += r.step) {
    const bool clipped = !r.clipped[c].empty() && r.clipped[c][k];
    left.push_back(clipped ? 0.0 : r.recording[channel][k] - read[c][k]);
  }
  return left;
}

}  // namespace

double ProblemRecording::noise_variance(Channel channel) const {
  return std::pow(noise[index(channel)].rms(samples->compared_period()), 2) + input_noise.variance[index(channel)];
}

namespace {

/// Variance of a channel where it is compared and not clipped.
double variance_of(const PreparedRecording& r, Channel channel, const Window& window) {
  const std::vector<bool>& clipped = r.clipped[index(channel)];
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (std::size_t k = r.compared_from(window.from); k < window.to; k += r.step) {
    if (!clipped.empty() && clipped[k]) continue;
    const double value = r.recording[channel][k];
    sum += value;
    squares += value * value;
    count += 1.0;
  }
  return count > 0.0 ? squares / count - std::pow(sum / count, 2) : 0.0;
}

}  // namespace

bool ProblemRecording::holds_motion() const {
  const double period = samples->compared_period();
  const auto moves = [&](Channel channel, double noise_power) {
    const Window window = samples->comparable(channel, is_fitted() ? fitted : held_out);
    return variance_of(*samples, channel, window) > thresholds::least_motion * noise_power;
  };
  const auto own_noise = [&](Channel channel) { return std::pow(noise[index(channel)].rms(period), 2); };
  const Channel input = samples->input.channel;
  const bool driven = samples->recording.has(input) && moves(input, own_noise(input));
  return std::any_of(samples->channels.begin(), samples->channels.end(), [&](Channel channel) {
    return moves(channel, driven ? own_noise(channel) : noise_variance(channel));
  });
}

IdentificationProblem::IdentificationProblem(std::vector<PreparedRecording> recordings) {
  for (PreparedRecording& r : recordings) r.work = recordings.front().work;
  samples_ = std::make_shared<const std::vector<PreparedRecording>>(std::move(recordings));
  for (const PreparedRecording& r : *samples_) {
    recordings_.push_back({&r, r.fitted, r.held_out, r.substeps, r.channel_noise, {}, std::nullopt, std::nullopt});
  }
  whiten();
}

IdentificationProblem::IdentificationProblem(std::vector<PreparedRecording> recordings, const Hypothesis& hypothesis)
    : IdentificationProblem(std::move(recordings)) {
  update_input_noise(hypothesis);
}

std::size_t IdentificationProblem::residual_count() const {
  std::size_t count = 0;
  for (const ProblemRecording& r : recordings_) count += r.is_fitted() ? r.fit_whitening->count() : 0;
  return count;
}

std::size_t IdentificationProblem::fitted_count() const {
  return static_cast<std::size_t>(
      std::count_if(recordings_.begin(), recordings_.end(), [](const ProblemRecording& r) { return r.is_fitted(); }));
}

bool IdentificationProblem::has_held_out() const {
  return std::any_of(recordings_.begin(), recordings_.end(), [](const ProblemRecording& r) { return r.is_held_out(); });
}

bool IdentificationProblem::update_input_noise(const Hypothesis& hypothesis) {
  const bool knocks = update_knocks(hypothesis);
  const bool channels = update_channel_noise(hypothesis);
  const bool input = samples_->front().input_noise.any();
  if (input) {
    for_all(recordings_.size(), [&](std::size_t i) {
      // Over the whole window, not a truncated one: the covariance is the same, and better known.
      const PreparedRecording& r = *recordings_[i].samples;
      recordings_[i].input_noise =
          input_noise_covariance(r, hypothesis, hypothesis.starts[i], r.fitted.size() > 0 ? r.fitted : r.held_out);
    });
  }
  if (!knocks && !channels && !input) return false;
  whiten();
  return true;
}

void IdentificationProblem::take_input_noise(const IdentificationProblem& other) {
  for (std::size_t i = 0; i < recordings_.size(); ++i) {
    recordings_[i].noise = other.recordings_[i].noise;
    recordings_[i].input_noise = other.recordings_[i].input_noise;
  }
  whiten();
}

void IdentificationProblem::allow_model_error(double relative) {
  model_error_ = relative;
  whiten();
}

bool IdentificationProblem::update_channel_noise(const Hypothesis& hypothesis) {
  std::atomic<bool> changed = false;
  for_all(recordings_.size(), [&](std::size_t i) {
    ProblemRecording& problem = recordings_[i];
    const PreparedRecording& r = *problem.samples;
    if (std::none_of(r.channels.begin(), r.channels.end(), [&](Channel c) { return is_open(r, c); })) return;
    const Response read = read_channels(hypothesis, r, r.input, hypothesis.starts[i], 0, problem.resolution());
    for (const Channel channel : r.channels) {
      if (!is_open(r, channel)) continue;
      const auto c = index(channel);
      const double period = r.compared_period();
      const std::optional<NoiseColour> filter = filter_in(hypothesis, channel);
      const std::vector<double> left = left_of(r, channel, read);
      if (is_bound(r, channel)) {
        const double level =
            std::max(std::min(noise_estimate(left).rms, r.channel_noise[c].level), r.rounding[c] / std::sqrt(12.0));
        if (!(level < thresholds::quieter * problem.noise[c].level)) continue;
        problem.noise[c].level = level;
        changed = true;
        continue;
      }
      ChannelNoise found = noise_in(left, period, channel, filter ? filter : r.expected_colour);
      problem.noise[c].on_signal = false;
      if (!found.is_known()) continue;
      // A corner that is a guess is what the model leaves of the motion.
      const bool is_guess = !found.colour.is_white() && !found.shows_a_filter();
      if (is_guess && r.channel_noise[c].shows_a_filter()) found = r.channel_noise[c];
      const double highest = highest_level_of(r, channel, found.colour);
      if (highest > 0.0) found.level = std::min(found.level, highest);
      // Behind a low-pass, what corners leave of the channel was filtered, and the simulation is not: no noise.
      if (r.expected_colour && r.declared_noise[c]) found.level = std::min(found.level, r.channel_noise[c].level);
      found.on_signal = filter && found.colour == *filter;
      problem.noise[c] = with_declared(found, r.declared_noise[c], period).noise;
      changed = true;
    }
  });
  return changed;
}

namespace {

/// Behind a lag or a filter a jump is a slope over several samples, which says when it began. A channel that is held
/// and has no hold yet jumps whenever it is renewed.
bool shows_knocks(const PreparedRecording& r, const Hypothesis& hypothesis, Channel channel) {
  const auto path = hypothesis.rig.effects.sensor_paths()[index(channel)];
  if (path.lag > 0.0 || (path.hold > 0.0) != r.renewals[index(channel)].has_value()) return false;
  return !filter_in(hypothesis, channel);
}

/// Samples on both sides of the steps (1) of what is read, `step` apart. `least`: knock · σ.
std::vector<std::size_t> knocks_in(const std::vector<double>& read, std::size_t step, double least) {
  const std::size_t count = read.size() / step;
  if (count < 4) return {};
  const auto rise = [&](std::size_t k) { return read[(k + 1) * step] - read[k * step]; };
  std::vector<double> steps;
  for (std::size_t k = 1; k + 2 < count; ++k) steps.push_back(std::abs(rise(k) - 0.5 * (rise(k - 1) + rise(k + 1))));
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  constexpr double deviations_of_median = 1.4826;  // of a normal distribution
  const double limit = std::max(least, thresholds::knock * deviations_of_median * *middle);
  std::vector<std::size_t> knocks;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] <= limit) continue;
    const std::size_t k = (i + 1) * step;
    if (knocks.empty() || knocks.back() != k) knocks.push_back(k);
    knocks.push_back(k + step);
  }
  return knocks;
}

/// The samples of a held channel whose values were taken beside one of the samples `knocks`, `step` apart: between two
/// samples the jump is anywhere, and what is taken there is on either side of it.
std::vector<std::size_t> taken_at_knocks(const std::vector<std::size_t>& knocks, const Renewals& renewals,
                                         const HoldClock& clock, std::size_t step, std::size_t samples) {
  std::vector<std::size_t> held;
  for (std::size_t n = 0; n < renewals.at.size(); ++n) {
    const double at = taken_at(renewals, n, clock), reach = clock.own ? static_cast<double>(step) : 0.5;
    const auto next = std::lower_bound(knocks.begin(), knocks.end(), at - reach,
                                       [](std::size_t k, double least) { return static_cast<double>(k) < least; });
    if (next == knocks.end() || static_cast<double>(*next) > at + reach) continue;
    const std::size_t end = n + 1 < renewals.at.size() ? renewals.at[n + 1] : samples;
    for (std::size_t k = renewals.at[n]; k < end; ++k) held.push_back(k);
  }
  return held;
}

}  // namespace

bool IdentificationProblem::update_knocks(const Hypothesis& hypothesis) {
  const auto marked = [](const PreparedRecording& r) {
    return std::any_of(r.knocks.begin(), r.knocks.end(), [](const auto& knocks) { return !knocks.empty(); });
  };
  const bool had = std::any_of(samples_->begin(), samples_->end(), marked), has = has_free_play(hypothesis.rig);
  if (!had && !has) return false;
  std::vector<PreparedRecording> samples = *samples_;
  for_all(samples.size(), [&](std::size_t i) {
    PreparedRecording& r = samples[i];
    Response truth;
    if (has) truth = true_channels(hypothesis, r, r.input, hypothesis.starts[i], 0, recordings_[i].resolution());
    for (const Channel channel : r.channels) {
      const auto c = index(channel);
      for (const std::size_t k : r.knocks[c]) r.clipped[c][k] = false;
      r.knocks[c].clear();
      const double limit = thresholds::knock * recordings_[i].noise[c].level;
      if (!has || !(limit > 0.0) || !shows_knocks(r, hypothesis, channel)) continue;
      r.clipped[c].resize(r.size(), false);
      std::vector<std::size_t> knocks =
          knocks_in(readings_before_hold(hypothesis, r, channel, truth[c]), r.step, limit);
      if (r.renewals[c]) {
        knocks = taken_at_knocks(knocks, *r.renewals[c], hypothesis.clocks[c], r.step, r.size());
      }
      for (const std::size_t k : knocks) {
        if (r.clipped[c][k]) continue;
        r.clipped[c][k] = true;
        r.knocks[c].push_back(k);
      }
    }
  });
  set_samples(std::move(samples));
  return true;
}

IdentificationProblem IdentificationProblem::with_all_fitted() const {
  IdentificationProblem whole = *this;
  for (ProblemRecording& r : whole.recordings_) {
    if (r.held_out.size() == 0) continue;
    r.fitted = {r.fitted.size() > 0 ? r.fitted.from : r.held_out.from, r.held_out.to};
    r.held_out = {};
  }
  whole.whiten();
  return whole;
}

IdentificationProblem IdentificationProblem::truncated(double share) const {
  IdentificationProblem part;
  part.samples_ = samples_;
  part.model_error_ = model_error_;
  for (const ProblemRecording& r : recordings_) {
    const auto least = static_cast<std::size_t>(shortest_truncated / r.samples->input.period);
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(r.fitted.size()));
    const Window begin{r.fitted.from, r.fitted.from + std::min(r.fitted.size(), std::max(wanted, least))};
    part.recordings_.push_back({r.samples, begin, {}, r.substeps, r.noise, r.input_noise, std::nullopt, std::nullopt});
  }
  part.whiten();
  return part;
}

IdentificationProblem IdentificationProblem::truncated_and_coarse(double share) const {
  IdentificationProblem part = truncated(share);
  for (ProblemRecording& r : part.recordings_) r.substeps = (r.substeps + 1) / 2;
  return part;
}

void IdentificationProblem::set_samples(std::vector<PreparedRecording> samples) {
  samples_ = std::make_shared<const std::vector<PreparedRecording>>(std::move(samples));
  for (std::size_t i = 0; i < recordings_.size(); ++i) recordings_[i].samples = &(*samples_)[i];
}

void IdentificationProblem::replace_samples(std::vector<PreparedRecording> samples) {
  set_samples(std::move(samples));
  whiten();
}

IdentificationProblem IdentificationProblem::of(std::vector<PreparedRecording> samples) const {
  IdentificationProblem other = *this;
  other.replace_samples(std::move(samples));
  return other;
}

IdentificationProblem IdentificationProblem::of_channels(const std::vector<Channel>& channels) const {
  std::vector<PreparedRecording> samples = *samples_;
  for (PreparedRecording& r : samples) r.channels = channels;
  return of(std::move(samples));
}

IdentificationProblem IdentificationProblem::apart(const std::vector<firmware::PlacedEffect>& machine) const {
  std::vector<PreparedRecording> samples = *samples_;
  for (PreparedRecording& r : samples) r.machine = machine;
  return of(std::move(samples));
}

IdentificationProblem IdentificationProblem::joined() const {
  std::vector<PreparedRecording> samples = *samples_;
  for (PreparedRecording& r : samples) r.machine.reset();
  return of(std::move(samples));
}

void IdentificationProblem::leave_out(std::size_t recording, Window left_out) {
  std::vector<PreparedRecording> samples = *samples_;
  PreparedRecording& r = samples[recording];
  for (const model::Channel channel : r.channels) {
    std::vector<bool>& clipped = r.clipped[index(channel)];
    clipped.resize(r.size(), false);
    std::fill(clipped.begin() + static_cast<std::ptrdiff_t>(left_out.from),
              clipped.begin() + static_cast<std::ptrdiff_t>(std::min(left_out.to, r.size())), true);
    std::erase_if(r.knocks[index(channel)], [&](std::size_t k) { return k >= left_out.from && k < left_out.to; });
  }
  replace_samples(std::move(samples));
}

Whitening IdentificationProblem::whitening(std::size_t recording, Window window) const {
  const ProblemRecording& r = recordings_[recording];
  return {*r.samples, window, r.noise, r.input_noise.spectrum, model_error_};
}

void IdentificationProblem::whiten() {
  for_all(recordings_.size(), [&](std::size_t i) {
    ProblemRecording& r = recordings_[i];
    r.fit_whitening.reset();
    r.held_out_whitening.reset();
    if (r.fitted.size() > 0) r.fit_whitening.emplace(whitening(i, r.fitted));
    if (r.held_out.size() > 0) r.held_out_whitening.emplace(whitening(i, r.held_out));
  });
}

}  // namespace host_sim::identification
