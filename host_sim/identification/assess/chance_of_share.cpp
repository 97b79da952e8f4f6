#include "host_sim/identification/assess/chance_of_share.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "host_sim/identification/common/frequency_bands.hpp"
#include "host_sim/identification/estimate/evidence.hpp"
#include "host_sim/identification/estimate/prediction.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

using BandPowers = std::array<double, noise_bands + 1>;

/// Simulated − measured in a window, without its mean where that is unknown, clipped samples as zeros.
std::vector<double> left_of(const PreparedRecording& recording, model::Channel channel, const Response& response,
                            Window window) {
  const auto c = index(channel);
  window = recording.comparable(channel, window);
  std::vector<double> left;
  double sum = 0.0;
  for (std::size_t k = recording.compared_from(window.from); k < window.to; k += recording.step) {
    const bool clipped = !recording.clipped[c].empty() && recording.clipped[c][k];
    left.push_back(clipped ? 0.0 : response[c][k] - recording.recording[channel][k]);
    sum += left.back();
  }
  if (!recording.has_unknown_mean(channel)) return left;
  for (double& value : left) value -= sum / static_cast<double>(left.size());
  return left;
}

/// Σ of the squares in each band, and what noise of such a variance has of it.
void add_by_band(const std::vector<double>& left, double period, double variance, BandPowers& powers,
                 BandPowers& noise) {
  if (left.size() < 2 || !std::all_of(left.begin(), left.end(), [](double v) { return std::isfinite(v); })) return;
  RealTransform transform(good_fft_size(left.size()));
  const auto lines = transform(left);
  const auto length = static_cast<double>(transform.length());
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double sides = k == 0 || k + 1 == lines.size() ? 1.0 : 2.0;
    const std::size_t band = noise_band_of(static_cast<double>(k) / (length * period));
    powers[band] += sides * std::norm(lines[k]) / length;
    noise[band] += sides * variance * static_cast<double>(left.size()) / length;
  }
}

/// ∫₀^θ sin^n by Simpson's rule: the integrand is smooth, and for a thousand directions a fiftieth of π/2 wide.
double integral_of_sine_power(double theta, double n) {
  constexpr int intervals = 2000;
  const double h = theta / intervals;
  double sum = 0.0;
  for (int i = 1; i <= intervals; ++i) {
    const double weight = i == intervals ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
    sum += weight * std::pow(std::sin(h * i), n);  // 0 at 0
  }
  return sum * h / 3.0;
}

}  // namespace

std::vector<ChannelRest> rest_of_channels(const IdentificationProblem& problem, Hypothesis hypothesis) {
  estimate_held_out_starts(hypothesis, problem.samples());
  const std::vector<Response> readings = read_all(problem, hypothesis);
  std::vector<ChannelRest> rests;
  for (const model::Channel channel : problem.channels()) {
    BandPowers powers{}, noise{};
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const ProblemRecording& r = problem.recordings()[i];
      for (const Window window : {r.fitted, r.held_out}) {
        add_by_band(left_of(*r.samples, channel, readings[i], window), r.samples->compared_period(),
                    r.noise_variance(channel), powers, noise);
      }
    }
    double sum = 0.0, squares = 0.0, left = 0.0, expected = 0.0;
    for (std::size_t band = 0; band < powers.size(); ++band) {
      const double excess = std::max(powers[band] - noise[band], 0.0);
      sum += excess;
      squares += excess * excess;
      left += powers[band];
      expected += noise[band];
    }
    rests.push_back({left, std::max(left - expected, thresholds::significant_share * expected),
                     DiscrepancyModel{}.directions * (squares > 0.0 ? sum * sum / squares : 1.0)});
  }
  return rests;
}

double chance_of_share(double share, double directions, std::size_t tried) {
  if (!(share > 0.0)) return 1.0;
  const double theta = std::acos(std::sqrt(std::min(share, 1.0)));
  const double beyond = integral_of_sine_power(theta, directions - 2.0);
  const double all = integral_of_sine_power(0.5 * std::numbers::pi, directions - 2.0);
  return std::min(1.0, static_cast<double>(tried) * beyond / all);
}

double chance_of_cause(const std::vector<ChannelRest>& with, const std::vector<ChannelRest>& without,
                       std::size_t tried) {
  double least = 1.0;
  for (std::size_t c = 0; c < with.size(); ++c) {
    for (double ChannelRest::*const power : {&ChannelRest::left, &ChannelRest::excess}) {
      // A model that diverges without the cause cannot do without it.
      const double of = without[c].*power, share = std::isfinite(of) ? 1.0 - with[c].*power / of : 1.0;
      least = std::min(least, chance_of_share(share, with[c].directions, 2 * tried * with.size()));
    }
  }
  return least;
}

}  // namespace host_sim::identification
