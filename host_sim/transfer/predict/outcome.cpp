#include "host_sim/transfer/predict/outcome.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/frf/cross_spectra.hpp"
#include "host_sim/transfer/common/thresholds.hpp"

namespace host_sim::transfer {
namespace {

frf::BlockScheme scheme_of(std::size_t block) { return {block, block / 2, WindowShape::hann, Detrend::mean}; }

/// Sums over the samples of all runs, about the mean.
struct Sums {
  double rms = 0.0, peak = 0.0;
};
Sums sums_of(std::span<const Response> runs, model::Channel channel) {
  double sum = 0.0, count = 0.0;
  for (const Response& run : runs) {
    for (const double v : run[index(channel)]) sum += v;
    count += static_cast<double>(run[index(channel)].size());
  }
  Sums result;
  if (!(count > 0.0)) return {std::nan(""), std::nan("")};
  const double mean = sum / count;
  double squares = 0.0;
  for (const Response& run : runs) {
    for (const double v : run[index(channel)]) {
      squares += (v - mean) * (v - mean);
      result.peak = std::max(result.peak, std::abs(v - mean));
    }
  }
  result.rms = std::sqrt(squares / count);
  return result;
}

}  // namespace

double vertical_weighting(double f) {
  constexpr double f1 = 0.4, f2 = 100.0, f3 = 12.5, f4 = 12.5, q4 = 0.63, f5 = 2.37, q5 = 0.91, f6 = 3.35, q6 = 0.91;
  if (!(f > 0.0)) return 0.0;
  const Complex s(0.0, f);  // frequencies in Hz throughout: the formulas hold for ratios
  const double root2 = std::sqrt(2.0);
  const Complex high = s * s / (s * s + root2 * f1 * s + f1 * f1);
  const Complex low = f2 * f2 / (s * s + root2 * f2 * s + f2 * f2);
  const Complex transition = (1.0 + s / f3) / (1.0 + s / (q4 * f4) + s * s / (f4 * f4));
  const Complex step =
      (1.0 + s / (q5 * f5) + s * s / (f5 * f5)) / (1.0 + s / (q6 * f6) + s * s / (f6 * f6)) * (f5 * f5) / (f6 * f6);
  return std::abs(high * low * transition * step);
}

Analysis::Analysis(std::vector<std::vector<double>> foot_points, double sample_rate, double static_load)
    : foot_points_(std::move(foot_points)), sample_rate_(sample_rate), static_load_(static_load) {
  std::size_t shortest = static_cast<std::size_t>(-1);
  for (const auto& z : foot_points_) shortest = std::min(shortest, z.size());
  const auto wanted = static_cast<std::size_t>(thresholds::block * sample_rate);
  block_ = good_fft_size_at_most(std::max<std::size_t>(16, std::min(wanted, shortest)));
  line_width_ = sample_rate / static_cast<double>(block_);
  frf::CrossSpectra spectra(sample_rate, scheme_of(block_), 1, 1);
  for (const auto& z : foot_points_) {
    const frf::ShiftedSignal signal{z, 0};
    spectra.add({&signal, 1});
  }
  averages_ = spectra.effective_averages();
  first_line_ = static_cast<std::size_t>(std::ceil(thresholds::lowest_frequency / line_width_ - 1e-9));
  first_line_ = std::max<std::size_t>(first_line_, 1);
  for (std::size_t k = first_line_; k < spectra.lines() && spectra.frequency(k) <= thresholds::highest_frequency + 1e-9;
       ++k) {
    frequencies_.push_back(spectra.frequency(k));
    foot_power_.push_back(spectra.power(0, k));
  }
}

Outcome Analysis::of(std::span<const Response> runs) const {
  Outcome outcome;
  frf::CrossSpectra spectra(sample_rate_, scheme_of(block_), 3, 1);
  const std::vector<double> silence(
      std::max_element(foot_points_.begin(), foot_points_.end(), [](const auto& a, const auto& b) {
        return a.size() < b.size();
      })->size());
  std::array<bool, 2> has{true, true};
  for (std::size_t r = 0; r < runs.size(); ++r) {
    std::array<frf::ShiftedSignal, 3> signals{{{foot_points_[r], 0}, {}, {}}};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& values = runs[r][index(response_channel[i])];
      has[i] = has[i] && values.size() == foot_points_[r].size();
      signals[i + 1].samples =
          has[i] ? std::span<const double>(values) : std::span<const double>(silence).first(foot_points_[r].size());
    }
    spectra.add(signals);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (!has[i]) continue;
    for (std::size_t k = 0; k < frequencies_.size(); ++k) {
      const std::size_t line = first_line_ + k;
      outcome.response[i].push_back(spectra.cross(0, i + 1, line) / foot_power_[k]);
      outcome.density[i].push_back(spectra.power(i + 1, line));
    }
  }
  const Sums load = sums_of(runs, model::Channel::F_w), body = sums_of(runs, model::Channel::zdd_b),
             stroke = sums_of(runs, model::Channel::dz_b);
  const auto put = [&](Quantity quantity, double value) {
    outcome.quantity[static_cast<std::size_t>(quantity)] = value;
  };
  put(Quantity::rms_F_w, load.rms);
  put(Quantity::dynamic_load_coefficient, load.rms / static_load_);
  put(Quantity::rms_zdd_b, body.rms);
  put(Quantity::rms_dz_b, stroke.rms);
  put(Quantity::peak_dz_b, stroke.peak);
  double weighted = has[1] ? 0.0 : std::nan("");
  for (std::size_t line = 1; has[1] && line < spectra.lines(); ++line) {
    weighted += std::pow(vertical_weighting(spectra.frequency(line)), 2) * spectra.power(2, line) * line_width_;
  }
  put(Quantity::weighted_zdd_b, std::sqrt(weighted));
  return outcome;
}

}  // namespace host_sim::transfer
