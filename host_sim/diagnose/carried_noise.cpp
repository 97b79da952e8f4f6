#include "host_sim/diagnose/carried_noise.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "host_sim/diagnose/foot_point.hpp"
#include "host_sim/diagnose/readings.hpp"
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
  const Response clean = read_channels(hypothesis, evidence, evidence.drive, start, window.to);

  const std::size_t length = good_fft_size_at_most(window.size());
  RealTransform transform(length);
  const double resolution = 1.0 / (period * static_cast<double>(length));
  const auto bands = static_cast<std::size_t>(std::min(Whitening::highest, 0.45 / period) / Whitening::band) + 1;
  const std::vector<double> taper = hann_window(length);
  struct Sums {
    Eigen::MatrixXcd outputs;  // Σ D Dᴴ
    Eigen::VectorXcd across;   // Σ D P*
    double input = 0.0;        // Σ |P|²
    double count = 0.0;
  };
  std::vector<Sums> sums(bands, {Eigen::MatrixXcd::Zero(m, m), Eigen::VectorXcd::Zero(m)});
  const auto spectrum_of = [&](const auto& value_at) {
    std::vector<double> tapered(length);
    for (std::size_t k = 0; k < length; ++k) tapered[k] = taper[k] * value_at(window.from + k);
    const auto bins = transform(tapered);
    return Spectrum(bins.begin(), bins.end());
  };

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
    FootPointMotion motion = through_samples(position, 1.0 / period);
    if (evidence.acceleration_known > 0.0) {
      smooth_acceleration(motion, acceleration_edge * evidence.acceleration_known, period);
    }
    for (std::size_t k = 0; k < n; ++k) {
      noisy.motion[k].position += motion[k].position;
      noisy.motion[k].velocity += motion[k].velocity;
      noisy.motion[k].acceleration += motion[k].acceleration;
    }
    const Response disturbed = read_channels(hypothesis, evidence, noisy, start, window.to);
    const Spectrum input = spectrum_of([&](std::size_t k) { return position[k]; });
    Spectra outputs;
    for (const model::Channel channel : evidence.channels) {
      const auto c = index(channel);
      const Window known = evidence.known(channel, window);
      for (std::size_t k = known.from; k < known.to; ++k) {
        carried.variance[c] += std::pow(disturbed[c][k] - clean[c][k], 2) / static_cast<double>(times * known.size());
      }
      outputs.push_back(spectrum_of([&](std::size_t k) { return disturbed[c][k] - clean[c][k]; }));
    }
    Eigen::VectorXcd difference(m);
    for (std::size_t k = 0; k < input.size(); ++k) {
      const auto b = static_cast<std::size_t>(static_cast<double>(k) * resolution / Whitening::band);
      if (b >= bands) break;
      for (Eigen::Index i = 0; i < m; ++i) difference(i) = outputs[static_cast<std::size_t>(i)][k];
      sums[b].outputs += difference * difference.adjoint();
      sums[b].across += difference * std::conj(input[k]);
      sums[b].input += std::norm(input[k]);
      sums[b].count += 1.0;
    }
  }

  // The coherent part g gᴴ S with the input's own density S, which is known; what is left is of events that begin
  // earlier or later, and of a gain that changes inside the band.
  double squares = 0.0;
  for (const double w : taper) squares += w * w;
  for (std::size_t b = 0; b < bands; ++b) {
    const Sums& sum = sums[b];
    Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(m, m);
    if (sum.input > 0.0 && sum.count > 1.0) {
      const double f = (static_cast<double>(b) + 0.5) * Whitening::band;
      const double curvature = std::pow(2.0 * std::sin(std::numbers::pi * f * period) / period, 2);
      double density = noise.position * noise.position;
      if (noise.acceleration > 0.0) {
        density = 1.0 / (1.0 / density + std::pow(curvature / noise.acceleration, 2));
      }
      const Eigen::VectorXcd gain = sum.across / sum.input;
      matrix = gain * gain.adjoint() * density;
      matrix += (sum.outputs - gain * sum.across.adjoint()) / ((sum.count - 1.0) * squares);
      matrix = (0.5 * (matrix + matrix.adjoint())).eval();
    }
    carried.spectrum.push_back(std::move(matrix));
  }
  return carried;
}

}  // namespace host_sim::diagnose
