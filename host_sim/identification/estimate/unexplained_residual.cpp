#include "host_sim/identification/estimate/unexplained_residual.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "host_sim/identification/estimate/thresholds.hpp"

namespace host_sim::identification {
namespace {

using PowerTable = std::vector<std::array<Power, noise_bands>>;  // by channel

/// Of the fitted windows, or of those held out.
PowerTable power_table(const IdentificationProblem& problem, const std::vector<Response>& responses, bool held_out) {
  const std::size_t channels = problem.channels().size();
  PowerTable result(channels);
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    const auto& whitening = held_out ? r.held_out_whitening : r.fit_whitening;
    if (!whitening) continue;
    const std::vector<double> values = whitening->by_channel(whitening->spectra(*r.samples, responses[i]));
    for (std::size_t k = 0; k < whitening->bins(); ++k) {
      const std::size_t b = std::min(noise_bands - 1, noise_band_of(whitening->frequency(k)));
      for (std::size_t c = 0; c < channels; ++c) {
        for (std::size_t part = 0; part < 2; ++part) {
          const double v = values[2 * (k * channels + c) + part];
          result[c][b].squares += v * v;
          result[c][b].count += 1.0;
        }
      }
    }
  }
  return result;
}

/// χ² of n degrees of freedom that a standard normal z stands for. Source: Wilson and Hilferty, 1931.
double chi_squared(double n, double z) {
  const double variance = 2.0 / (9.0 * n);
  return n * std::pow(std::max(1.0 - variance + z * std::sqrt(variance), 0.0), 3);
}

}  // namespace

std::vector<BandPower> band_powers(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  constexpr double z = 1.96;  // 95 %
  const PowerTable powers = power_table(problem, read_all(problem, hypothesis), false);
  std::vector<BandPower> result;
  for (std::size_t c = 0; c < powers.size(); ++c) {
    for (std::size_t b = 0; b < noise_bands; ++b) {
      const Power& p = powers[c][b];
      if (!(p.count > 0.0)) continue;
      result.push_back({problem.channels()[c], noise_band_edges[b], noise_band_edges[b + 1], p,
                        p.squares / chi_squared(p.count, z),
                        p.squares / std::max(chi_squared(p.count, -z), 1e-3 * p.count)});
    }
  }
  return result;
}

std::vector<ChannelExcess> channel_excesses(const std::vector<BandPower>& powers) {
  std::vector<ChannelExcess> result;
  for (auto first = powers.begin(); first != powers.end();) {
    const auto last =
        std::find_if(first, powers.end(), [&](const BandPower& p) { return p.channel != first->channel; });
    ChannelExcess e{first->channel, 0.0, 0.0, 0.0, noise_band_edges.back()};
    for (auto p = first; p != last; ++p) {
      e.excess += std::max(p->power.excess(), 0.0);
      e.significance = std::max(e.significance, p->power.significance());
    }
    double sum = 0.0;
    bool begun = false;
    for (auto p = first; p != last && e.excess > 0.0; ++p) {
      sum += std::max(p->power.excess(), 0.0);
      if (!begun && sum >= 0.1 * e.excess) {
        e.lowest = p->lowest;
        begun = true;
      }
      if (sum >= 0.9 * e.excess) {
        e.highest = p->highest;
        break;
      }
    }
    result.push_back(e);
    first = last;
  }
  return result;
}

bool corners_are_blurred(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  return problem.samples().front().input_noise.any() && has_corners(hypothesis.rig);
}

UnexplainedResidual unexplained_residual(const IdentificationProblem& problem, const Hypothesis& hypothesis,
                                         const std::vector<Response>& responses) {
  const PowerTable fitted = power_table(problem, responses, false);
  const PowerTable held_out = problem.has_held_out() ? power_table(problem, responses, true) : PowerTable();
  UnexplainedResidual left;
  const double least =
      corners_are_blurred(problem, hypothesis) ? thresholds::corner_power_error : thresholds::significant_share;
  for (std::size_t c = 0; c < fitted.size(); ++c) {
    for (std::size_t b = 0; b < noise_bands; ++b) {
      double z = fitted[c][b].significance();
      double share = fitted[c][b].excess() / std::max(fitted[c][b].count, 1.0);
      if (!held_out.empty()) {
        // The held-out quarter has half the significance.
        z = std::min(z, 2.0 * held_out[c][b].significance());
        share = std::min(share, held_out[c][b].excess() / std::max(held_out[c][b].count, 1.0));
      }
      if (share < least || z <= left.strongest) continue;
      left.strongest = z;
      char words[160];
      std::snprintf(words, sizeof words, "%s, %.3g to %.3g Hz: %.1f times the power of its noise",
                    std::string(model::name(problem.channels()[c])).c_str(), noise_band_edges[b],
                    noise_band_edges[b + 1], 1.0 + share);
      left.words = words;
    }
  }
  left.significant = left.strongest > thresholds::significant_deviations;
  if (!left.significant) left.words.clear();
  return left;
}

void SquaredError::add(const PreparedRecording& recording, model::Channel channel, const Response& response,
                       Window window) {
  const auto c = index(channel);
  window = recording.comparable(channel, window);
  double sum = 0.0, count = 0.0, squares = 0.0;
  for (std::size_t k = recording.compared_from(window.from); k < window.to; k += recording.step) {
    if (!recording.clipped[c].empty() && recording.clipped[c][k]) continue;
    const double measured = recording.recording[channel][k], difference = response[c][k] - measured;
    sum += difference;
    count += 1.0;
    squares += difference * difference;
    data += measured * measured;
  }
  error += recording.has_unknown_mean(channel) && count > 0.0 ? squares - sum * sum / count : squares;
}

SquaredError held_out_squares(const IdentificationProblem& problem, const std::vector<Response>& responses,
                              model::Channel channel) {
  SquaredError squares;
  for (std::size_t i = 0; i < responses.size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    squares.add(*r.samples, channel, responses[i], r.held_out);
  }
  return squares;
}

double pooled_error(const IdentificationProblem& problem, const Hypothesis& hypothesis) {
  double sum = 0.0, terms = 0.0;
  for (std::size_t i = 0; i < problem.recordings().size(); ++i) {
    const ProblemRecording& r = problem.recordings()[i];
    if (!r.is_fitted()) continue;
    const PreparedRecording& samples = *r.samples;
    const Response response =
        read_channels(hypothesis, samples, samples.input, hypothesis.starts[i], r.fitted.to, r.resolution());
    for (const model::Channel channel : samples.channels) {
      SquaredError squares;
      squares.add(samples, channel, response, r.fitted);
      if (!(squares.data > 0.0)) continue;
      sum += squares.error / squares.data;
      terms += 1.0;
    }
  }
  return terms > 0.0 ? std::sqrt(sum / terms) : 0.0;
}

}  // namespace host_sim::identification
