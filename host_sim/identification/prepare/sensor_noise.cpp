#include "host_sim/identification/prepare/sensor_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/identification/prepare/sample_faults.hpp"
#include "host_sim/identification/prepare/sample_hold.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"

namespace host_sim::identification {

NoiseEstimate noise_estimate(const std::vector<double>& samples) {
  constexpr std::array<double, 7> weights{1, -6, 15, -20, 15, -6, 1};
  double gain = 0.0;  // Σ weights²: of the variance of white noise
  for (const double w : weights) gain += w * w;
  constexpr std::size_t stretch = 64;
  std::vector<double> variances;
  for (std::size_t from = 0; from + stretch + weights.size() <= samples.size(); from += stretch) {
    double squares = 0.0;
    for (std::size_t k = from; k < from + stretch; ++k) {
      double difference = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i) difference += weights[i] * samples[k + i];
      squares += difference * difference;
    }
    constexpr double median_of_mean = 0.967;  // (2)
    variances.push_back(squares / (stretch * gain * median_of_mean));
  }
  if (variances.empty()) return {};
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  // The standard error of a median from the middle half of the values: 1.253 σ, σ = quartile distance / 1.349; half of
  // it for the root.
  const double median = *middle;
  const auto quarter = static_cast<std::ptrdiff_t>(variances.size() / 4);
  std::nth_element(variances.begin(), variances.begin() + quarter, variances.end());
  const double low = variances[static_cast<std::size_t>(quarter)];
  std::nth_element(variances.begin(), variances.end() - 1 - quarter, variances.end());
  const double high = *(variances.end() - 1 - quarter);
  const double error = 0.5 * 1.253 / 1.349 * (high - low) / std::sqrt(static_cast<double>(variances.size()));
  return {std::sqrt(median), median > 0.0 ? error / median : 0.0};
}

double estimated_noise(const std::vector<double>& samples) { return noise_estimate(samples).rms; }

namespace {

std::vector<double> renewed_values(const std::vector<double>& samples, const Renewals& renewals) {
  std::vector<double> renewed;
  for (const std::size_t k : renewals.at) renewed.push_back(samples[k]);
  return renewed;
}

bool is_position(model::Channel channel) { return model::unit(channel) == "m"; }

ChannelNoise white(const NoiseEstimate& estimate, double relative_error) {
  return {estimate.rms, {}, relative_error, 0.0, 0.0};
}

/// Whether rounding makes a channel's noise louder than it is declared, or most of it where nothing is declared.
bool rounding_is_said(double step, const std::optional<double>& declared, const ChannelNoise& found, double period) {
  const double power = std::pow(rounding_noise(step), 2), measured = std::pow(found.rms(period), 2);
  if (!declared) return power >= 0.5 * measured;
  const double expected = std::pow(*declared, 2);
  if (power < thresholds::rounding_said * (expected + power)) return false;
  return !found.is_known() || measured - expected > 0.5 * power;
}

}  // namespace

ChannelNoise noise_in(const std::vector<double>& samples, double period, model::Channel channel,
                      const std::optional<NoiseColour>& expected) {
  constexpr double unknown = 1.0;
  const NoiseEstimate whole = noise_estimate(samples);
  std::vector<double> half;
  half.reserve(samples.size() / 2 + 1);
  for (std::size_t k = 0; k < samples.size(); k += 2) half.push_back(samples[k]);
  const NoiseEstimate octave_below = noise_estimate(half);
  if (!(whole.rms > 0.0) || !(octave_below.rms > 0.0)) return white(whole, unknown);
  if (std::abs(std::log(octave_below.rms / whole.rms)) <= thresholds::white_noise) {
    return white(whole, whole.relative_error);
  }
  const bool is_foot_point = channel == model::Channel::z_r || channel == model::Channel::zdd_r;
  const auto fit = fit_noise_spectrum(samples, period, is_position(channel), expected, is_foot_point);
  return fit && fit->noise.level > 0.0 ? fit->noise : white(whole, unknown);
}

SensorNoise with_declared(ChannelNoise found, std::optional<double> declared, double period,
                          const std::optional<NoiseColour>& expected) {
  if (!declared) return {found, std::nullopt};
  if (!found.is_known() || !(*declared > 0.0)) {
    const NoiseColour colour = expected.value_or(NoiseColour{});
    return {{*declared / std::sqrt(colour.mean_power(period)), colour, 1.0, 0.0, found.highest_level}, std::nullopt};
  }
  const double rms = found.rms(period), factor = rms / *declared;
  constexpr double usual = thresholds::usual_noise_factor;
  double believed = std::clamp(factor, 1.0 / usual, usual);
  // At a low sample rate a motion may reach up to the Nyquist frequency, a multisine to its last line; coloured noise
  // may be the tail of a motion.
  const bool above_motion = thresholds::noise_begins_share >= thresholds::noise_begins * period;
  if (found.colour.is_white() && above_motion && !found.ends) {
    believed = std::pow(factor, 1.0 / (1.0 + std::pow(found.relative_error / std::log(usual), 2)));
  }
  if (std::abs(std::log(factor)) <= thresholds::noise_as_declared) believed = 1.0;
  found.level = found.colour.is_white() ? believed * *declared : found.level * (believed * *declared / rms);
  return {found, NoiseFactor{factor, 1.96 * factor * found.relative_error}};
}

double exactness_of_model(const std::vector<double>& samples, const std::vector<bool>& filled) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  const double near = samples.empty() ? 0.0 : samples.front();  // a constant loses no digits
  for (std::size_t k = 0; k < samples.size(); ++k) {
    if (k < filled.size() && filled[k]) continue;
    sum += samples[k] - near;
    squares += (samples[k] - near) * (samples[k] - near);
    count += 1.0;
  }
  if (!(count > 0.0)) return 0.0;
  return thresholds::model_exactness * std::sqrt(std::max(squares / count - std::pow(sum / count, 2), 0.0));
}

SensorNoise find_sensor_noise(const firmware::RigDescription& description, const firmware::Recording& recording,
                              model::Channel channel, const std::optional<NoiseColour>& expected, double step) {
  const auto& declared = description.noise[index(channel)];
  const double rounding = rounding_noise(step);
  const auto& samples = recording[channel];
  if (const auto renewals = renewals_of(samples, step, recording.filled)) {
    if (declared) return {{std::hypot(*declared, rounding)}, std::nullopt};
    const NoiseEstimate estimate = noise_estimate(renewed_values(samples, *renewals));
    return {white(estimate, estimate.relative_error), std::nullopt};
  }
  const double period = recording.sample_period;
  ChannelNoise found = noise_in(samples, period, channel, expected);
  const bool said = step > 0.0 && rounding_is_said(step, declared, found, period);
  if (!said) return with_declared(found, declared, period, expected);
  // Where a slow signal stays on one step, samples show less noise than rounding makes.
  const double least = std::hypot(declared.value_or(0.0), rounding);
  if (found.level < least) found = white({least, 0.0}, thresholds::grid_error);
  if (!declared) return {found, std::nullopt, true};
  SensorNoise noise = with_declared(found, least, period, expected);
  noise.rounded = true;
  return noise;
}

std::optional<NoiseFactor> noise_factor(const firmware::RigDescription& description,
                                        const firmware::Recording& recording, model::Channel channel) {
  return find_sensor_noise(description, recording, channel).factor;
}

double sensor_noise(const firmware::RigDescription& description, const firmware::Recording& recording,
                    model::Channel channel) {
  return find_sensor_noise(description, recording, channel).noise.level;
}

}  // namespace host_sim::identification
