#include "host_sim/identification/noise/input_noise_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "firmware/simulation/gaussian.hpp"
#include "host_sim/identification/noise/whitening.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/identification/prepare/input_fusion.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

/// Noise of the input, as it passes the fusion, and the input with it.
struct NoisyInput {
  std::vector<double> position;
  SimulationInput input;
};
NoisyInput noisy_input(const PreparedRecording& recording, int realisation) {
  const InputNoise& noise = recording.input_noise;
  const std::size_t n = recording.size();
  const double period = recording.input.period;
  firmware::Gaussian gaussian(1, static_cast<std::uint32_t>(realisation));
  NoisyInput noisy{std::vector<double>(n), recording.input};
  for (double& v : noisy.position) v = noise.position * gaussian();
  if (noise.acceleration > 0.0) {
    std::vector<double> acceleration(n);
    for (double& v : acceleration) v = noise.acceleration * gaussian();
    noisy.position = fused_displacement(noisy.position, acceleration, noise.position, noise.acceleration, period);
  }
  firmware::FootPointMotion motion = firmware::through_samples(noisy.position, 1.0 / period);
  if (recording.acceleration_known > 0.0) {
    smooth_acceleration(motion, thresholds::acceleration_edge * recording.acceleration_known, period);
  }
  for (std::size_t k = 0; k < n; ++k) {
    noisy.input.motion[k].position += motion[k].position;
    noisy.input.motion[k].velocity += motion[k].velocity;
    noisy.input.motion[k].acceleration += motion[k].acceleration;
  }
  return noisy;
}

/// The sums of (1) and (2) over the lines of one band.
struct BandSums {
  Eigen::MatrixXcd outputs;  ///< Σ D Dᴴ
  Eigen::VectorXcd across;   ///< Σ D P*
  double input = 0.0;        ///< Σ |P|²
  double count = 0.0;

  explicit BandSums(Eigen::Index channels)
      : outputs(Eigen::MatrixXcd::Zero(channels, channels)), across(Eigen::VectorXcd::Zero(channels)) {}

  void add(const Eigen::VectorXcd& difference, const std::complex<double>& noise) {
    outputs += difference * difference.adjoint();
    across += difference * std::conj(noise);
    input += std::norm(noise);
    count += 1.0;
  }

  /// (2)
  [[nodiscard]] Eigen::MatrixXcd covariance(double density, double taper_power) const {
    if (!(input > 0.0 && count > 1.0)) return Eigen::MatrixXcd::Zero(outputs.rows(), outputs.cols());
    const Eigen::VectorXcd gain = across / input;
    Eigen::MatrixXcd matrix = gain * gain.adjoint() * density;
    matrix += (outputs - gain * across.adjoint()) / ((count - 1.0) * taper_power);
    return 0.5 * (matrix + matrix.adjoint());
  }
};

/// (3)
double input_density(const InputNoise& noise, double f, double period) {
  const double density = noise.position * noise.position * noise.position_colour.power(f, period);
  if (!(noise.acceleration > 0.0)) return density;
  const double curvature = std::pow(2.0 * std::sin(std::numbers::pi * f * period) / period, 2);
  const double acceleration = noise.acceleration * noise.acceleration * noise.acceleration_colour.power(f, period);
  return 1.0 / (1.0 / density + curvature * curvature / acceleration);
}

/// Spectra of a tapered window.
class WindowSpectrum {
 public:
  explicit WindowSpectrum(Window window)
      : from_(window.from),
        length_(good_fft_size_at_most(window.size())),
        taper_(hann_window(length_)),
        transform_(length_) {}

  [[nodiscard]] std::size_t length() const { return length_; }
  [[nodiscard]] double taper_power() const {
    double squares = 0.0;
    for (const double w : taper_) squares += w * w;
    return squares;
  }
  template <class ValueAt>
  [[nodiscard]] Spectrum operator()(const ValueAt& value_at) {
    std::vector<double> tapered(length_);
    for (std::size_t k = 0; k < length_; ++k) tapered[k] = taper_[k] * value_at(from_ + k);
    const auto bins = transform_(tapered);
    return {bins.begin(), bins.end()};
  }

 private:
  std::size_t from_, length_;
  std::vector<double> taper_;
  RealTransform transform_;
};

}  // namespace

InputNoiseCovariance input_noise_covariance(const PreparedRecording& recording, const Hypothesis& hypothesis,
                                            const InitialState& start, Window window) {
  InputNoiseCovariance result;
  if (!(recording.input_noise.position > 0.0) || window.size() < thresholds::shortest_covariance_window) return result;
  const double period = recording.input.period;
  const auto m = static_cast<Eigen::Index>(recording.channels.size());
  const Resolution resolution{recording.substeps};
  const Response clean = read_channels(hypothesis, recording, recording.input, start, window.to, resolution);

  WindowSpectrum spectrum_of(window);
  const double line = 1.0 / (period * static_cast<double>(spectrum_of.length()));
  const double top = std::min(thresholds::highest_frequency, thresholds::highest_share_of_rate / period);
  const auto bands = static_cast<std::size_t>(top / thresholds::covariance_band) + 1;
  std::vector<BandSums> sums(bands, BandSums(m));
  constexpr int realisations = thresholds::noise_realisations;
  for (int realisation = 0; realisation < realisations; ++realisation) {
    const NoisyInput noisy = noisy_input(recording, realisation);
    const Response disturbed = read_channels(hypothesis, recording, noisy.input, start, window.to, resolution);
    const Spectrum input = spectrum_of([&](std::size_t k) { return noisy.position[k]; });
    Spectra outputs;
    for (const model::Channel channel : recording.channels) {
      const auto c = index(channel);
      const auto difference = [&](std::size_t k) { return disturbed[c][k] - clean[c][k]; };
      const Window compared = recording.comparable(channel, window);
      for (std::size_t k = compared.from; k < compared.to; ++k) {
        result.variance[c] += std::pow(difference(k), 2) / static_cast<double>(realisations * compared.size());
      }
      outputs.push_back(spectrum_of(difference));
    }
    Eigen::VectorXcd difference(m);
    for (std::size_t k = 0; k < input.size(); ++k) {
      const auto b = static_cast<std::size_t>(static_cast<double>(k) * line / thresholds::covariance_band);
      if (b >= bands) break;
      for (Eigen::Index i = 0; i < m; ++i) difference(i) = outputs[static_cast<std::size_t>(i)][k];
      sums[b].add(difference, input[k]);
    }
  }
  for (std::size_t b = 0; b < bands; ++b) {
    const double f = (static_cast<double>(b) + 0.5) * thresholds::covariance_band;
    result.spectrum.push_back(
        sums[b].covariance(input_density(recording.input_noise, f, period), spectrum_of.taper_power()));
  }
  return result;
}

}  // namespace host_sim::identification
