#include "tests/reference/whitening.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "firmware/simulation/road.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "tests/reference/evidence.hpp"

namespace reference {
namespace {

using model::Channel;
using std::numbers::pi;

double held(double period, double step, double f) {
  if (period == 0.0) return 1.0;
  const double x = std::max(pi * f * period, 1e-6);
  return std::max(period / step * std::pow(std::sin(x) / x, 2), 0.05);  // no renewal is exact: sinc has no zeros
}

}  // namespace

Whitening::Whitening(const firmware::RigDescription& description, const Measured& measured, const Model& described)
    : length_(host_sim::good_fft_size_at_most(measured.to - measured.from)) {
  const double step = measured.input.period, resolution = 1.0 / (step * static_cast<double>(length_));
  bins_ = static_cast<std::size_t>(band_edges.back() / resolution);
  const auto channels = static_cast<Eigen::Index>(measured.channels.size());
  std::vector<double> taper(length_, 1.0);
  const auto ramp = static_cast<std::size_t>(0.25 / step);
  for (std::size_t k = 0; k < ramp; ++k) {
    taper[k] = taper[length_ - 1 - k] = 0.5 - 0.5 * std::cos(pi * (static_cast<double>(k) + 0.5) / static_cast<double>(ramp));
  }
  double taper_power = 0.0;
  for (const double w : taper) taper_power += w * w;
  std::size_t band = 0;
  std::vector<std::size_t> band_of(bins_);
  for (std::size_t k = 0; k < bins_; ++k) {
    while (static_cast<double>(k) * resolution >= band_edges[band + 1]) ++band;
    band_of[k] = band;
  }

  // A foot point that moves by 1 µm in one sample: its spectrum is flat, and the recording's own length gives its bins.
  Measured impulse = measured;
  const bool driven = measured.input.channel == Channel::z_r;
  const double noise = description.noise[index(Channel::z_r)].value_or(0.0), size = 1e-6;
  host_sim::Response response;
  if (driven && noise > 0.0) {
    std::vector<double> position(measured.to);
    position[measured.from + length_ / 4] = size;
    impulse.input.motion = firmware::through_samples(position, 1.0 / step);
    response = true_channels(description, described, impulse);
  }
  std::vector<Eigen::VectorXcd> gains, spectra;
  std::vector<std::array<double, bands>> powers;
  for (const Channel channel : measured.channels) {
    weights_.push_back(taper);
    const auto& range = description.range[index(channel)];
    const auto& values = measured.recording[channel];
    for (std::size_t k = 0; range && k < length_; ++k) {
      if (!range->holds(values[measured.from + k])) weights_.back()[k] = 0.0;
    }
    spectra.push_back(spectrum(weights_.back(), values.data() + measured.from));
    auto& power = powers.emplace_back();
    std::array<double, bands> count{};
    for (std::size_t k = 0; k < bins_; ++k) {
      power[band_of[k]] += std::norm(spectra.back()(static_cast<Eigen::Index>(k))) / taper_power;
      count[band_of[k]] += 1.0;
    }
    for (std::size_t b = 0; b < bands; ++b) power[b] /= std::max(count[b], 1.0);
    const auto& answer = response[index(channel)];
    gains.push_back(answer.empty() ? Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(bins_)).eval()
                                   : spectrum(std::vector<double>(length_, 1.0), answer.data() + measured.from));
  }
  for (std::size_t k = 0; k < bins_; ++k) {
    const double f = static_cast<double>(k) * resolution;
    const double error = std::hypot(2e-4, std::pow(2.0 * pi * f * step, 4) / 30.0);
    Eigen::VectorXcd gain(channels);
    Eigen::MatrixXcd sigma = Eigen::MatrixXcd::Zero(channels, channels);
    for (Eigen::Index c = 0; c < channels; ++c) {
      const auto i = static_cast<std::size_t>(c);
      const double own = description.noise[index(measured.channels[i])].value_or(0.0);
      gain(c) = noise / size * gains[i](static_cast<Eigen::Index>(k));
      sigma(c, c) = own * own * held(measured.hold_period(measured.channels[i]), step, f) +
                    error * error * powers[i][band_of[k]] + 1e-30;
      for (int part = 0; part < 2; ++part) cells_.push_back(i * bands + band_of[k]);
    }
    const Eigen::LLT<Eigen::MatrixXcd> cholesky(sigma + gain * gain.adjoint());
    factors_.push_back(std::sqrt(2.0 / taper_power) * cholesky.matrixL().solve(Eigen::MatrixXcd::Identity(channels, channels)));
  }
}

Eigen::VectorXcd Whitening::spectrum(const std::vector<double>& weights, const double* values) const {
  std::vector<double> weighted(length_);
  for (std::size_t k = 0; k < length_; ++k) weighted[k] = weights[k] * values[k];
  host_sim::RealTransform transform(length_);
  return Eigen::Map<const Eigen::VectorXcd>(transform(weighted).data(), static_cast<Eigen::Index>(bins_));
}

Eigen::VectorXd Whitening::operator()(const Measured& measured, const host_sim::Response& predicted) const {
  const auto channels = static_cast<Eigen::Index>(measured.channels.size());
  Eigen::MatrixXcd differences(channels, static_cast<Eigen::Index>(bins_));
  std::vector<double> difference(length_);
  for (Eigen::Index c = 0; c < channels; ++c) {
    const auto i = static_cast<std::size_t>(c);
    const Channel channel = measured.channels[i];
    for (std::size_t k = 0; k < length_; ++k) {
      difference[k] = measured.recording[channel][measured.from + k] - predicted[index(channel)][measured.from + k];
    }
    differences.row(c) = spectrum(weights_[i], difference.data()).transpose();
  }
  Eigen::VectorXd whitened(static_cast<Eigen::Index>(cells_.size()));
  for (Eigen::Index k = 0; k < differences.cols(); ++k) {
    const Eigen::VectorXcd r = factors_[static_cast<std::size_t>(k)].triangularView<Eigen::Lower>() * differences.col(k);
    for (Eigen::Index c = 0; c < channels; ++c) {
      whitened(2 * (channels * k + c)) = r(c).real();
      whitened(2 * (channels * k + c) + 1) = r(c).imag();
    }
  }
  return whitened;
}

}  // namespace reference
