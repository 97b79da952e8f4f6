#include "tests/reference/whitening.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "firmware/simulation/road.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "tests/reference/evidence.hpp"
#include "tests/truth/random.hpp"

namespace reference {
namespace {

using Eigen::Index;
using model::Channel;
using std::numbers::pi;

/// h_c of (7); sinc² has no zeros, as no renewal is exact.
double held(double period, double step, double f) {
  if (period == 0.0) return 1.0;
  const double x = std::max(pi * f * period, 1e-6);
  return std::max(period / step * std::pow(std::sin(x) / x, 2), 0.05);
}

/// A recording that is driven by z_r and noise of this size.
Measured shaken(Measured measured, double noise, truth::Random& random) {
  std::vector<double> position;
  for (const auto& m : measured.input.motion) position.push_back(m.position + noise * random.normal());
  auto motion = firmware::through_samples(position, 1.0 / measured.input.period);
  for (std::size_t k = 0; k < motion.size(); ++k) motion[k].acceleration = measured.input.motion[k].acceleration;
  measured.input.motion = std::move(motion);
  return measured;
}

}  // namespace

Whitening::Whitening(const firmware::RigDescription& description, const Measured& measured, const Model& model)
    : length_(host_sim::good_fft_size_at_most(measured.to - measured.from)),
      resolution_(1.0 / (measured.input.period * static_cast<double>(length_))) {
  const double step = measured.input.period, top = band_edges.back();
  bins_ = static_cast<std::size_t>(top / resolution_);
  std::vector<double> taper(length_, 1.0);
  const auto ramp = static_cast<std::size_t>(0.25 / step);
  for (std::size_t k = 0; k < ramp; ++k) {
    taper[k] = taper[length_ - 1 - k] = 0.5 - 0.5 * std::cos(pi * (static_cast<double>(k) + 0.5) / static_cast<double>(ramp));
  }
  double taper_power = 0.0;
  for (const double w : taper) taper_power += w * w;
  for (const Channel channel : measured.channels) {
    weights_.push_back(taper);
    const auto& range = description.range[index(channel)];
    for (std::size_t k = 0; range && k < length_; ++k) {
      if (!range->holds(measured.recording[channel][measured.from + k])) weights_.back()[k] = 0.0;
    }
  }
  const auto band_of = [](double f) {
    std::size_t band = 0;
    while (f >= band_edges[band + 1]) ++band;
    return band;
  };
  const auto channels = static_cast<Index>(measured.channels.size());
  host_sim::Response nothing;
  nothing.fill(std::vector<double>(measured.to));
  const Spectra signal = spectra(measured, measured.recording.channels, nothing);
  Eigen::MatrixXd powers = Eigen::MatrixXd::Zero(channels, bands);
  Eigen::VectorXd counts = Eigen::VectorXd::Zero(bands);
  for (std::size_t k = 0; k < bins_; ++k) {
    const std::size_t band = band_of(static_cast<double>(k) * resolution_);
    for (Index c = 0; c < channels; ++c) {
      for (int part = 0; part < 2; ++part) cells_.push_back(static_cast<std::size_t>(c) * bands + band);
    }
    powers.col(static_cast<Index>(band)) += signal.col(static_cast<Index>(k)).cwiseAbs2() / taper_power;
    counts(static_cast<Index>(band)) += 1.0;
  }

  constexpr int draws = 4;  // Σ of rank 1 and little beside it, from 100 bins
  std::vector<Eigen::MatrixXcd> sigma(static_cast<std::size_t>(top), Eigen::MatrixXcd::Zero(channels, channels));
  std::vector<double> lines(sigma.size());
  const double noise = measured.input.channel == Channel::z_r ? description.noise[index(Channel::z_r)].value_or(0.0) : 0.0;
  truth::Random random(1);
  const host_sim::Response quiet = noise > 0.0 ? predicted(description, model, measured) : nothing;
  for (int draw = 0; draw < draws && noise > 0.0; ++draw) {
    const Spectra d = spectra(measured, predicted(description, model, shaken(measured, noise, random)), quiet);
    for (Index k = 0; k < d.cols(); ++k) {
      const auto hertz = static_cast<std::size_t>(static_cast<double>(k) * resolution_);
      sigma[hertz] += d.col(k) * d.col(k).adjoint() / taper_power;
      lines[hertz] += 1.0;
    }
  }
  for (std::size_t hertz = 0; hertz < sigma.size(); ++hertz) {
    const double f = static_cast<double>(hertz) + 0.5;
    const double error = std::hypot(2e-4, std::pow(2.0 * pi * f * step, 4) / 30.0);
    sigma[hertz] /= std::max(lines[hertz], 1.0);
    for (Index c = 0; c < channels; ++c) {
      const Channel channel = measured.channels[static_cast<std::size_t>(c)];
      const auto band = static_cast<Index>(band_of(f));
      sigma[hertz](c, c) += std::pow(description.noise[index(channel)].value_or(0.0), 2) * held(measured.hold_period(channel), step, f) +
                            error * error * powers(c, band) / counts(band) + 1e-30;
    }
    const Eigen::LLT<Eigen::MatrixXcd> cholesky(sigma[hertz]);
    factors_.push_back(std::sqrt(2.0 / taper_power) * cholesky.matrixL().solve(Eigen::MatrixXcd::Identity(channels, channels)));
  }
}

Whitening::Spectra Whitening::spectra(const Measured& measured, const host_sim::Response& of, const host_sim::Response& less) const {
  Spectra result(static_cast<Index>(measured.channels.size()), static_cast<Index>(bins_));
  host_sim::RealTransform transform(length_);
  std::vector<double> weighted(length_);
  for (std::size_t c = 0; c < measured.channels.size(); ++c) {
    const auto& a = of[index(measured.channels[c])];
    const auto& b = less[index(measured.channels[c])];
    for (std::size_t k = 0; k < length_; ++k) weighted[k] = weights_[c][k] * (a[measured.from + k] - b[measured.from + k]);
    const auto bins = transform(weighted);
    for (std::size_t k = 0; k < bins_; ++k) result(static_cast<Index>(c), static_cast<Index>(k)) = bins[k];
  }
  return result;
}

Eigen::VectorXd Whitening::operator()(const Measured& measured, const host_sim::Response& predicted) const {
  const Spectra difference = spectra(measured, measured.recording.channels, predicted);
  Eigen::VectorXd whitened(static_cast<Index>(cells_.size()));
  for (Index k = 0; k < difference.cols(); ++k) {
    const auto hertz = static_cast<std::size_t>(static_cast<double>(k) * resolution_);
    const Eigen::VectorXcd r = factors_[hertz].triangularView<Eigen::Lower>() * difference.col(k);
    for (Index c = 0; c < r.size(); ++c) {
      whitened(2 * (r.size() * k + c)) = r(c).real();
      whitened(2 * (r.size() * k + c) + 1) = r(c).imag();
    }
  }
  return whitened;
}

}  // namespace reference
