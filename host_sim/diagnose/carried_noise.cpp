#include "host_sim/diagnose/carried_noise.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "host_sim/diagnose/foot_point.hpp"
#include "host_sim/diagnose/whitening.hpp"
#include "host_sim/gaussian.hpp"
#include "host_sim/spectrum.hpp"

namespace host_sim::diagnose {

CarriedNoise carried_noise(const Evidence& evidence, const Hypothesis& hypothesis, const InitialState& start,
                           Window window) {
  const InputNoise& noise = evidence.input_noise;
  CarriedNoise carried;
  if (!(noise.position > 0.0) || window.size() < 16) return carried;
  const std::size_t n = evidence.size();
  const double period = evidence.drive.period;
  const auto m = static_cast<Eigen::Index>(evidence.channels.size());
  const Response clean = host_sim::respond(hypothesis.rig, evidence.drive, start, window.to);

  const std::size_t length = window.size() - window.size() % 2;
  RealTransform transform(good_fft_size(length));
  const double resolution = 1.0 / (period * static_cast<double>(transform.length()));
  const auto bands = static_cast<std::size_t>(std::min(Whitening::highest, 0.45 / period) / Whitening::band) + 1;
  std::vector<Eigen::MatrixXcd> sums(bands, Eigen::MatrixXcd::Zero(m, m));
  std::vector<double> counts(bands, 0.0);
  const std::vector<double> taper = hann_window(length);
  double squares = 0.0;
  for (const double w : taper) squares += w * w;

  constexpr int times = 3;
  for (int time = 0; time < times; ++time) {
    Gaussian gaussian(1, static_cast<std::uint32_t>(time));
    std::vector<double> position(n), acceleration(n);
    for (double& v : position) v = noise.position * gaussian();
    if (noise.acceleration > 0.0) {
      for (double& v : acceleration) v = noise.acceleration * gaussian();
      position = fused_displacement(position, acceleration, noise.position, noise.acceleration, period);
    }
    Drive noisy = evidence.drive;
    const FootPointMotion motion = through_samples(position, 1.0 / period);
    for (std::size_t k = 0; k < n; ++k) {
      noisy.motion[k].position += motion[k].position;
      noisy.motion[k].velocity += motion[k].velocity;
      noisy.motion[k].acceleration += motion[k].acceleration;
    }
    const Response disturbed = host_sim::respond(hypothesis.rig, noisy, start, window.to);
    std::vector<std::vector<std::complex<double>>> spectra;
    std::vector<double> difference(length);
    for (const model::Channel channel : evidence.channels) {
      const auto c = index(channel);
      double& variance = carried.variance[c];
      for (std::size_t k = window.from; k < window.to; ++k) {
        variance += std::pow(disturbed[c][k] - clean[c][k], 2) / static_cast<double>(times * window.size());
      }
      for (std::size_t k = 0; k < length; ++k) {
        difference[k] = taper[k] * (disturbed[c][window.from + k] - clean[c][window.from + k]);
      }
      const auto bins = transform(difference);
      spectra.emplace_back(bins.begin(), bins.end());
    }
    for (std::size_t k = 0; k < spectra.front().size(); ++k) {
      const auto b = static_cast<std::size_t>(static_cast<double>(k) * resolution / Whitening::band);
      if (b >= bands) break;
      counts[b] += squares;
      for (Eigen::Index i = 0; i < m; ++i) {
        for (Eigen::Index j = 0; j < m; ++j) {
          sums[b](i, j) += spectra[static_cast<std::size_t>(i)][k] * std::conj(spectra[static_cast<std::size_t>(j)][k]);
        }
      }
    }
  }
  for (std::size_t b = 0; b < bands; ++b) {
    if (counts[b] > 0.0) sums[b] /= counts[b];
  }
  carried.spectrum = std::move(sums);
  return carried;
}

}  // namespace host_sim::diagnose
