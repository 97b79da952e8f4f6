#include "host_sim/replicate/band_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "host_sim/replicate/thresholds.hpp"

namespace host_sim::replicate {
namespace {

/// Largest value within half an octave to either side.
std::vector<double> largest_near(const std::vector<double>& values) {
  const std::size_t n = values.size();
  std::vector<double> largest(n, 0.0);
  std::deque<std::size_t> window;  // indices with falling values
  std::size_t next = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double f = static_cast<double>(k);
    const auto last = std::min(n - 1, static_cast<std::size_t>(std::sqrt(2.0) * f));
    const auto first = static_cast<std::size_t>(std::ceil(f / std::sqrt(2.0)));
    for (; next <= last; ++next) {
      while (!window.empty() && values[window.back()] <= values[next]) window.pop_back();
      window.push_back(next);
    }
    while (window.front() < first) window.pop_front();
    largest[k] = values[window.front()];
  }
  return largest;
}

}  // namespace

double rms_over(const std::vector<Part>& events, std::span<const double> values) {
  double squares = 0.0;
  std::size_t count = 0;
  for (const Part& part : events) {
    const std::size_t end = std::min(part.to, values.size());
    for (std::size_t k = part.from; k < end; ++k) squares += values[k] * values[k];
    count += end > part.from ? end - part.from : 0;
  }
  return count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0.0;
}

std::size_t BandInverse::transform_length(const Target& target) {
  const auto guard = static_cast<std::size_t>(2.0 * thresholds::lead / target.period);
  return good_fft_size(target.size() + guard);
}

BandInverse::BandInverse(const DriveModel& model, const Target& target)
    : transform_(std::make_unique<RealTransform>(transform_length(target))),
      step_(1.0 / (target.period * static_cast<double>(transform_->length()))),
      size_(target.size()),
      responses_(model.linear_response(transform_->length())) {
  prepare(target);
}

BandInverse::BandInverse(std::size_t length, std::vector<std::vector<std::complex<double>>> responses,
                         const Target& target)
    : transform_(std::make_unique<RealTransform>(length)),
      step_(1.0 / (target.period * static_cast<double>(length))),
      size_(target.size()),
      responses_(std::move(responses)) {
  prepare(target);
}

void BandInverse::prepare(const Target& target) {
  const std::size_t channels = target.channels.size(), bins = transform_->bins();
  metric_.assign(bins, 0.0);
  for (std::size_t c = 0; c < channels; ++c) {
    std::vector<double> band(bins);
    for (std::size_t k = 0; k < bins; ++k) band[k] = target.channels[c].band.weight(step_ * static_cast<double>(k));
    bands_.push_back(std::move(band));
    rms_.push_back(rms_over(target.events, in_band(c, target.values[c])));
    const double relative = rms_[c] > 0.0 ? target.channels[c].weight / rms_[c] : 0.0;
    weights_.push_back(relative * relative);
    for (std::size_t k = 0; k < bins; ++k)
      metric_[k] += weights_[c] * bands_[c][k] * bands_[c][k] * std::norm(responses_[c][k]);
  }
  floor_ = largest_near(metric_);
  for (double& value : floor_) value *= thresholds::inverse_floor;
  const std::vector<double> best = drive(target.values);
  const auto bins_of_drive = (*transform_)(best);
  const std::vector<std::complex<double>> u(bins_of_drive.begin(), bins_of_drive.end());
  for (std::size_t c = 0; c < channels; ++c) {
    std::vector<std::complex<double>> made(bins);
    for (std::size_t k = 0; k < bins; ++k) made[k] = responses_[c][k] * u[k];
    std::vector<double> reached = transform_->inverse(made);
    reached.resize(size_);
    for (std::size_t k = 0; k < size_; ++k) reached[k] = target.values[c][k] - reached[k];
    unreachable_.push_back(rms_[c] > 0.0 ? rms_over(target.events, in_band(c, reached)) / rms_[c] : 0.0);
  }
}

std::vector<double> BandInverse::drive(const std::vector<std::vector<double>>& errors) const {
  std::vector<std::complex<double>> sum(transform_->bins());
  for (std::size_t c = 0; c < errors.size(); ++c) {
    const auto bins = (*transform_)(errors[c]);
    for (std::size_t k = 0; k < sum.size(); ++k) {
      sum[k] += weights_[c] * bands_[c][k] * bands_[c][k] * std::conj(responses_[c][k]) * bins[k];
    }
  }
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const double by = metric_[k] + floor_[k];
    sum[k] = by > 0.0 ? sum[k] / by : 0.0;
  }
  std::vector<double> drive = transform_->inverse(sum);
  drive.resize(size_);
  end_at_rest(drive);
  return drive;
}

void BandInverse::end_at_rest(std::vector<double>& drive) const {
  const auto ramp = std::min(
      size_ / 2,
      static_cast<std::size_t>(0.25 * thresholds::lead / (1.0 / (step_ * static_cast<double>(transform_->length())))));
  for (std::size_t k = 0; k < ramp; ++k) {
    const double fade = 0.5 - 0.5 * std::cos(0.5 * full_turn * static_cast<double>(k) / static_cast<double>(ramp));
    drive[k] *= fade;
    drive[size_ - 1 - k] *= fade;
  }
}

std::vector<double> BandInverse::in_band(std::size_t channel, const std::vector<double>& signal) const {
  const auto spectrum = (*transform_)(signal);
  std::vector<std::complex<double>> bins(spectrum.begin(), spectrum.end());
  for (std::size_t k = 0; k < bins.size(); ++k) bins[k] *= bands_[channel][k];
  std::vector<double> filtered = transform_->inverse(bins);
  filtered.resize(signal.size());
  return filtered;
}

}  // namespace host_sim::replicate
