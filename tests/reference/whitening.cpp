#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/simulation/road.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "tests/reference/diagnose.hpp"
#include "tests/truth/random.hpp"

namespace reference {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using model::Channel;
using std::numbers::pi;

std::size_t band_of(double f) {
  return static_cast<std::size_t>(std::upper_bound(band_edges.begin(), band_edges.end(), f) - band_edges.begin()) - 1;
}

/// σ_c of (7). F_w of a hil rig has no sensor, but its tyre has a wheel that F accelerates in steps, as F's noise is new
/// in each sample: differences of fourth order miss h Δa/12 of the velocity.
double noise_of(const Description& description, Channel channel) {
  const auto& declared = description.noise;
  if (channel != Channel::F_w || declared[index(channel)]) return declared[index(channel)].value_or(0.0);
  const double step = std::sqrt(2.0) * declared[index(Channel::F)].value_or(0.0) / description.rig.wheel.mass;
  return description.rig.tyre.damping * description.period() * step / 12.0;
}

/// h_c of (7); sinc² is kept from its zeros, as no renewal is exact.
double held(double period, double step, double f) {
  const double x = std::max(pi * f * period, 1e-6);
  return period > 0.0 ? std::max(period / step * std::pow(std::sin(x) / x, 2), 0.05) : 1.0;
}

/// A recording that is driven by z_r and noise of this size.
Measured shaken(Measured m, double noise, truth::Random& random) {
  m.simulated.clear();
  std::vector<double> position;
  for (const auto& motion : m.input.motion) position.push_back(motion.position + noise * random.normal());
  const auto moved = firmware::through_samples(position, 1.0 / m.input.period);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    m.input.motion[k] = {moved[k].position, moved[k].velocity, m.input.motion[k].acceleration};
  }
  return m;
}

}  // namespace

Whitening::Whitening(const Description& description, const Measured& m, const Model& model)
    : length_(host_sim::good_fft_size_at_most(m.to - m.from)),
      resolution_(1.0 / (m.input.period * static_cast<double>(length_))),
      taper_(length_, 1.0) {
  const double step = m.input.period;
  bins_ = static_cast<std::size_t>(band_edges.back() / resolution_);
  const auto ramp = static_cast<std::size_t>(0.25 / step);
  double taper_power = static_cast<double>(length_ - 2 * ramp);
  for (std::size_t k = 0; k < ramp; ++k) {
    const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(ramp);
    taper_[k] = taper_[length_ - 1 - k] = 0.5 - 0.5 * std::cos(pi * share);
    taper_power += 2.0 * taper_[k] * taper_[k];
  }

  const auto channels = static_cast<Index>(m.channels.size());
  Readings nothing;
  nothing.fill(std::vector<double>(m.to));
  const MatrixXcd signal = spectra(m, m.recording.channels, nothing);
  Eigen::MatrixXd power = Eigen::MatrixXd::Zero(channels, bands);
  Eigen::VectorXd count = Eigen::VectorXd::Constant(bands, 1e-300);
  for (std::size_t k = 0; k < bins_; ++k) {
    const std::size_t band = band_of(frequency(k));
    for (Index i = 0; i < 2 * channels; ++i) cells_.push_back(static_cast<std::size_t>(i / 2) * bands + band);
    power.col(static_cast<Index>(band)) += signal.col(static_cast<Index>(k)).cwiseAbs2() / taper_power;
    count(static_cast<Index>(band)) += 1.0;
  }

  std::vector<MatrixXcd> sigma(static_cast<std::size_t>(band_edges.back()), MatrixXcd::Zero(channels, channels));
  const double noise = m.input.channel == Channel::z_r ? description.noise[index(Channel::z_r)].value_or(0.0) : 0.0;
  const Readings quiet = noise > 0.0 ? predicted(description, model, m) : nothing;
  truth::Random random(1);
  for (int draw = 0; draw < 4 && noise > 0.0; ++draw) {
    const MatrixXcd d = spectra(m, predicted(description, model, shaken(m, noise, random)), quiet);
    for (Index k = 0; k < d.cols(); ++k) {
      sigma[static_cast<std::size_t>(frequency(static_cast<std::size_t>(k)))] +=
          d.col(k) * d.col(k).adjoint() * (resolution_ / 4.0 / taper_power);
    }
  }
  for (std::size_t hertz = 0; hertz < sigma.size(); ++hertz) {
    const double f = static_cast<double>(hertz) + 0.5;
    const auto band = static_cast<Index>(band_of(f));
    const auto foot = std::find(m.channels.begin(), m.channels.end(), Channel::zdd_r) - m.channels.begin();
    if (foot < channels) {
      const double own = sigma[hertz](foot, foot).real(), sensor = noise_of(description, Channel::zdd_r);
      sigma[hertz].row(foot).setZero();
      sigma[hertz].col(foot).setZero();
      sigma[hertz](foot, foot) = own * (1.0 + own / (sensor * sensor + 1e-30));
    }
    for (Index c = 0; c < channels; ++c) {
      const Channel channel = m.channels[static_cast<std::size_t>(c)];
      const double own = noise_of(description, channel);
      const double error = std::hypot(2e-4, std::pow(2.0 * pi * f * step, 4) / 30.0);
      sigma[hertz](c, c) +=
          own * own * held(m.hold_period(channel), step, f) + error * error * power(c, band) / count(band) + 1e-30;
    }
    const MatrixXcd lower = sigma[hertz].llt().matrixL();
    factors_.push_back(std::sqrt(2.0 / taper_power) * lower.inverse());
  }
}

MatrixXcd Whitening::spectra(const Measured& m, const Readings& of, const Readings& less) const {
  MatrixXcd result(static_cast<Index>(m.channels.size()), static_cast<Index>(bins_));
  host_sim::RealTransform transform(length_);
  std::vector<double> weighted(length_);
  for (Index c = 0; c < result.rows(); ++c) {
    const auto i = index(m.channels[static_cast<std::size_t>(c)]);
    for (std::size_t k = 0; k < length_; ++k) weighted[k] = taper_[k] * (of[i][m.from + k] - less[i][m.from + k]);
    result.row(c) = Eigen::Map<const Eigen::RowVectorXcd>(transform(weighted).data(), result.cols());
  }
  return result;
}

Eigen::VectorXd Whitening::operator()(const Measured& m, const Readings& predicted) const {
  const MatrixXcd difference = spectra(m, m.recording.channels, predicted);
  Eigen::MatrixXcd whitened(difference.rows(), difference.cols());
  for (Index k = 0; k < difference.cols(); ++k) {
    whitened.col(k) = factors_[static_cast<std::size_t>(frequency(static_cast<std::size_t>(k)))] * difference.col(k);
  }
  return Eigen::Map<const Eigen::VectorXd>(reinterpret_cast<const double*>(whitened.data()), 2 * whitened.size());
}

}  // namespace reference
