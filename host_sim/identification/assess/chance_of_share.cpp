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
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

using BandPowers = std::array<double, noise_bands + 1>;

/// Simulated − measured in a window, without the mean, clipped samples as zeros; relative to the rms that was measured.
std::vector<double> left_of(const PreparedRecording& recording, model::Channel channel, const Response& response,
                            Window window) {
  const auto c = index(channel);
  window = recording.comparable(channel, window);
  std::vector<double> left;
  double sum = 0.0, squares = 0.0;
  for (std::size_t k = recording.compared_from(window.from); k < window.to; k += recording.step) {
    const bool clipped = !recording.clipped[c].empty() && recording.clipped[c][k];
    const double measured = recording.recording[channel][k];
    left.push_back(clipped ? 0.0 : response[c][k] - measured);
    sum += left.back();
    squares += measured * measured;
  }
  const auto count = static_cast<double>(left.size());
  for (double& value : left) value = (value - sum / count) / std::sqrt(squares / count);
  return left;
}

void add_by_band(const std::vector<double>& left, double period, BandPowers& powers) {
  if (left.size() < 2 || !std::all_of(left.begin(), left.end(), [](double v) { return std::isfinite(v); })) return;
  RealTransform transform(good_fft_size(left.size()));
  const auto lines = transform(left);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double f = static_cast<double>(k) / (static_cast<double>(transform.length()) * period);
    powers[noise_band_of(f)] += std::norm(lines[k]) / static_cast<double>(left.size() * transform.length());
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

double directions_left(const IdentificationProblem& problem, Hypothesis hypothesis) {
  estimate_held_out_starts(hypothesis, problem.samples());
  const std::vector<Response> readings = read_all(problem, hypothesis);
  double sum = 0.0, squares = 0.0;
  for (const model::Channel channel : problem.channels()) {
    BandPowers powers{};
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const ProblemRecording& r = problem.recordings()[i];
      for (const Window window : {r.fitted, r.held_out}) {
        add_by_band(left_of(*r.samples, channel, readings[i], window), r.samples->compared_period(), powers);
      }
    }
    for (const double power : powers) {
      sum += power;
      squares += power * power;
    }
  }
  const double bands = squares > 0.0 ? sum * sum / squares : 1.0;
  return DiscrepancyModel{}.directions * bands;
}

double chance_of_share(double share, double directions, std::size_t tried) {
  if (!(share > 0.0)) return 1.0;
  const double theta = std::asin(1.0 - std::min(share, 1.0));  // cos²θ = 1 − (1 − s)²
  const double beyond = integral_of_sine_power(theta, directions - 2.0);
  const double all = integral_of_sine_power(0.5 * std::numbers::pi, directions - 2.0);
  return std::min(1.0, static_cast<double>(tried) * beyond / all);
}

}  // namespace host_sim::identification
