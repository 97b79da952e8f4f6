#include "host_sim/transfer/posterior/discrepancy.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "host_sim/identification/estimate/unexplained_residual.hpp"
#include "host_sim/least_squares/gram.hpp"
#include "host_sim/transfer/common/thresholds.hpp"

namespace host_sim::transfer {

using identification::Fit;
using identification::IdentificationProblem;
using identification::noise_bands;
using model::Channel;

namespace {

/// The channel that stands for the component's force: F itself, else the acceleration of the body that it moves.
std::optional<Channel> force_channel(const IdentificationProblem& problem) {
  const auto& channels = problem.channels();
  for (const Channel candidate : {Channel::F, Channel::zdd_b}) {
    if (std::find(channels.begin(), channels.end(), candidate) != channels.end()) return candidate;
  }
  return std::nullopt;
}

/// Σ |data − seen|² and Σ |seen|² of one channel by band, over the fitted windows.
struct BandSums {
  std::array<double, noise_bands> residual{}, signal{};
};
BandSums sums_of(const IdentificationProblem& problem, const Fit& fit, Channel channel) {
  BandSums sums;
  for (std::size_t r = 0; r < problem.recordings().size(); ++r) {
    const auto& recording = problem.recordings()[r];
    if (!recording.is_fitted()) continue;
    const auto& channels = recording.samples->channels;
    const auto c = static_cast<std::size_t>(std::find(channels.begin(), channels.end(), channel) - channels.begin());
    if (c == channels.size()) continue;
    const auto& measured = recording.samples->recording[channel];
    const identification::Spectrum data = recording.fit_whitening->spectrum(*recording.samples, c, measured);
    const identification::Spectrum& seen = fit.prediction.seen[r][c];
    for (std::size_t k = 0; k < std::min(data.size(), seen.size()); ++k) {
      const std::size_t band = identification::noise_band_of(recording.fit_whitening->frequency(k));
      if (band >= noise_bands) break;
      sums.residual[band] += std::norm(data[k] - seen[k]);
      sums.signal[band] += std::norm(seen[k]);
    }
  }
  return sums;
}

/// s_b(φ) of (2): what the channel's prediction times 1 + δ e^{iφ} in a band changes of the whitened residuals.
Eigen::VectorXd change_of(const IdentificationProblem& problem, const Fit& fit, Channel channel,
                          const Discrepancy::InBand& band, double phase) {
  identification::Prediction altered = fit.prediction;
  const std::complex<double> factor = 1.0 + std::polar(band.relative, phase);
  for (std::size_t r = 0; r < problem.recordings().size(); ++r) {
    const auto& recording = problem.recordings()[r];
    if (!recording.is_fitted()) continue;
    for (std::size_t c = 0; c < recording.samples->channels.size(); ++c) {
      if (recording.samples->channels[c] != channel) continue;
      identification::Spectrum& seen = altered.seen[r][c];
      for (std::size_t k = 0; k < seen.size(); ++k) {
        const double f = recording.fit_whitening->frequency(k);
        if (f >= band.lowest && f < band.highest) seen[k] *= factor;
      }
    }
  }
  return identification::residuals(problem, altered) - fit.residual;
}

}  // namespace

bool Discrepancy::any() const {
  return std::any_of(bands.begin(), bands.end(), [](const InBand& band) { return band.relative > 0.0; });
}

double Discrepancy::relative_at(double frequency) const {
  for (const InBand& band : bands) {
    if (frequency >= band.lowest && frequency < band.highest) return band.relative;
  }
  return 0.0;
}

Discrepancy find_discrepancy(const IdentificationProblem& problem, const Fit& fit, const Eigen::MatrixXd& covariance) {
  Discrepancy discrepancy;
  discrepancy.widening = Eigen::MatrixXd::Zero(covariance.rows(), covariance.cols());
  const std::optional<Channel> channel = force_channel(problem);
  if (!channel) return discrepancy;
  discrepancy.measured = true;
  discrepancy.channel = *channel;
  const BandSums sums = sums_of(problem, fit, *channel);
  for (const identification::BandPower& power : identification::band_powers(problem, fit.hypothesis)) {
    if (power.channel != *channel) continue;
    Discrepancy::InBand band{power.lowest, power.highest, 0.0, power.power.significance()};
    const std::size_t b = identification::noise_band_of(0.5 * (power.lowest + power.highest));
    if (band.significance > thresholds::discrepancy_significance && sums.signal[b] > 0.0) {
      const double ratio = power.power.ratio();
      band.relative = std::sqrt(sums.residual[b] * (ratio - 1.0) / ratio / sums.signal[b]);
    }
    discrepancy.bands.push_back(band);
  }
  for (const Discrepancy::InBand& band : discrepancy.bands) {
    if (!(band.relative > 0.0)) continue;
    for (const double phase : {0.0, 1.5707963267948966}) {
      const Eigen::VectorXd moved =
          covariance * transposed_product(fit.jacobian, change_of(problem, fit, *channel, band, phase));
      discrepancy.widening += 0.5 * moved * moved.transpose();
    }
  }
  return discrepancy;
}

}  // namespace host_sim::transfer
