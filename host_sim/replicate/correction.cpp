#include "host_sim/replicate/correction.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "host_sim/replicate/thresholds.hpp"

namespace host_sim::replicate {
namespace {

using Bins = std::vector<std::complex<double>>;

/// Mean over ± half a band of a sixth of an octave, at least ± 8 bins.
std::vector<double> smoothed(const std::vector<double>& power) {
  const std::size_t n = power.size();
  std::vector<double> sums(n + 1, 0.0), mean(n);
  for (std::size_t k = 0; k < n; ++k) sums[k + 1] = sums[k] + power[k];
  for (std::size_t k = 0; k < n; ++k) {
    const auto half = std::max<std::size_t>(8, k / 17);
    const std::size_t from = k > half ? k - half : 0, to = std::min(n, k + half + 1);
    mean[k] = (sums[to] - sums[from]) / static_cast<double>(to - from);
  }
  return mean;
}

}  // namespace

void Correction::take(const RunRecord& run, const DriveModel::Answer& predicted) {
  RealTransform& transform = inverse_.transform();
  const std::size_t size = target_.size(), bins = transform.bins();
  const bool first = offset_.empty();
  if (first) offset_.assign(target_.channels.size(), std::vector<double>(size, 0.0));
  noise_.assign(target_.channels.size(), 0.0);
  std::vector<std::vector<double>> innovations(target_.channels.size());
  for (std::size_t c = 0; c < target_.channels.size(); ++c) {
    if (run.measured[c].empty()) continue;
    std::vector<double> innovation(size, 0.0);
    for (std::size_t k = 0; k < run.samples; ++k) {
      innovation[k] = run.measured[c][k] - predicted[c][k] - offset_[c][k];
    }
    if (run.samples < size) {  // fades out where the run ends
      const auto fade = std::min(run.samples, static_cast<std::size_t>(0.25 / target_.period));
      for (std::size_t k = 0; k < fade; ++k) {
        const double x = static_cast<double>(k) / static_cast<double>(fade);
        innovation[run.samples - 1 - k] *= 0.5 - 0.5 * std::cos(0.5 * full_turn * x);
      }
    }
    const auto spectrum = transform(innovation);
    Bins own(spectrum.begin(), spectrum.end());
    std::vector<double> power(bins);
    for (std::size_t k = 0; k < bins; ++k) power[k] = std::norm(own[k]);
    power = smoothed(power);
    const auto declared = description_.noise[index(target_.channels[c].channel)];
    std::vector<double> noise(bins, 0.0);
    if (declared) {
      const double density = *declared * *declared * static_cast<double>(run.samples);
      std::fill(noise.begin(), noise.end(), density);
    } else if (!first && !last_.empty() && !last_[c].empty()) {
      const auto before = transform(last_[c]);
      std::vector<double> apart(bins);
      for (std::size_t k = 0; k < bins; ++k) apart[k] = 0.5 * std::norm(own[k] - before[k]);
      noise = smoothed(apart);
    }
    double lost = 0.0;
    for (std::size_t k = 0; k < bins; ++k) {
      const double alpha = power[k] > 0.0 ? std::max(0.0, 1.0 - noise[k] / power[k]) : 0.0;
      lost += (1.0 - alpha) * std::norm(own[k]) *
              std::pow(target_.channels[c].band.weight(inverse_.frequency_step() * static_cast<double>(k)), 2);
      own[k] *= alpha;
    }
    const std::vector<double> learned = transform.inverse(own);
    for (std::size_t k = 0; k < size; ++k) offset_[c][k] += learned[k];
    const double n = static_cast<double>(transform.length());
    noise_[c] =
        std::sqrt(2.0 * lost / n / static_cast<double>(std::max<std::size_t>(run.samples, 1))) / inverse_.target_rms(c);
    innovations[c] = std::move(innovation);
  }
  last_ = std::move(innovations);
}

}  // namespace host_sim::replicate
