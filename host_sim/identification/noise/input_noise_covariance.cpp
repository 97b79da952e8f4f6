#include "host_sim/identification/noise/input_noise_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "firmware/simulation/gaussian.hpp"
#include "host_sim/identification/noise/whitening.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"
#include "host_sim/identification/prepare/driving_input.hpp"
#include "host_sim/identification/prepare/input_fusion.hpp"
#include "host_sim/identification/prepare/smoothed_input.hpp"
#include "host_sim/identification/prepare/thresholds.hpp"
#include "host_sim/signal/interpolation.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

/// Noise of the recorded samples of an input, between them interpolated as the input is.
std::vector<double> noise_of_input(const PreparedRecording& recording, double rms, firmware::Gaussian& gaussian) {
  std::vector<double> noise((recording.size() + recording.step - 1) / recording.step);
  for (double& v : noise) v = rms * gaussian();
  noise = Interpolation(recording.step)(noise);
  noise.resize(recording.size(), 0.0);
  return noise;
}

/// Reduces noise above the smoothing edge to 3 %. That still shows its gain to the channels, (1), and shifts no events.
void weaken_above_edge(std::vector<double>& noise, double edge, double period) {
  constexpr double left = 0.03;
  const std::vector<double> slow = smoothed(noise, edge, period);
  for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = slow[k] + left * (noise[k] - slow[k]);
}

/// Noise of the input, as it passes the fusion or the integration, and the input with it.
struct NoisyInput {
  std::vector<double> noise;  ///< P of (1): of the position, of an acceleration that is integrated before that
  SimulationInput input;
};
NoisyInput noisy_input(const PreparedRecording& recording, int realisation) {
  const InputNoise& noise = recording.input_noise;
  const std::size_t n = recording.size();
  const double period = recording.input.period;
  firmware::Gaussian gaussian(1, static_cast<std::uint32_t>(realisation));
  NoisyInput noisy{{}, recording.input};
  std::vector<double> position;
  if (noise.position > 0.0) {
    position = noise_of_input(recording, noise.position, gaussian);
    if (noise.acceleration > 0.0) {
      const std::vector<double> acceleration = noise_of_input(recording, noise.acceleration, gaussian);
      position = fused_displacement(position, acceleration, noise.position, noise.acceleration, period);
    }
    if (recording.input_edge > 0.0) weaken_above_edge(position, recording.input_edge, period);
    noisy.noise = position;
  } else {
    noisy.noise = noise_of_input(recording, noise.acceleration, gaussian);
    position = twice_integrated(noisy.noise, period);
    // From rest, since the state at the start is found with the noise that is there.
    const double first = position.front(), rise = n > 1 ? position[1] - first : 0.0;
    for (std::size_t k = 0; k < n; ++k) position[k] -= first + rise * static_cast<double>(k);
  }
  const firmware::FootPointMotion motion =
      motion_between(recording.input.channel == Channel::x_act, position, 1.0 / period);
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
  if (!(noise.position > 0.0)) return noise.acceleration * noise.acceleration;
  const double density = noise.position * noise.position * noise.position_colour.power(f, noise.sample_period);
  if (!(noise.acceleration > 0.0)) return density;
  const double curvature = std::pow(2.0 * std::sin(std::numbers::pi * f * period) / period, 2);
  const double acceleration =
      noise.acceleration * noise.acceleration * noise.acceleration_colour.power(f, noise.sample_period);
  return 1.0 / (1.0 / density + curvature * curvature / acceleration);
}

/// Spectra of a tapered window, of the samples that are compared.
class WindowSpectrum {
 public:
  WindowSpectrum(Window window, std::size_t step)
      : from_(window.from),
        step_(step),
        length_(good_fft_size_at_most(window.size() / step)),
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
    for (std::size_t k = 0; k < length_; ++k) tapered[k] = taper_[k] * value_at(from_ + k * step_);
    const auto bins = transform_(tapered);
    return {bins.begin(), bins.end()};
  }

 private:
  std::size_t from_, step_, length_;
  std::vector<double> taper_;
  RealTransform transform_;
};

}  // namespace

InputNoiseCovariance input_noise_covariance(const PreparedRecording& recording, const Hypothesis& hypothesis,
                                            const InitialState& start, Window window) {
  InputNoiseCovariance result;
  if (!recording.input_noise.any() || window.size() / recording.step < thresholds::shortest_covariance_window) {
    return result;
  }
  const double period = recording.compared_period();
  const auto m = static_cast<Eigen::Index>(recording.channels.size());
  const Resolution resolution{recording.substeps};
  const Response clean = read_channels(hypothesis, recording, recording.input, start, window.to, resolution);

  WindowSpectrum spectrum_of(window, recording.step);
  const double line = 1.0 / (period * static_cast<double>(spectrum_of.length()));
  const double top = std::min(thresholds::highest_frequency, thresholds::highest_share_of_rate / period);
  const auto bands = static_cast<std::size_t>(top / thresholds::covariance_band) + 1;
  std::vector<BandSums> sums(bands, BandSums(m));
  constexpr int realisations = thresholds::noise_realisations;
  for (int realisation = 0; realisation < realisations; ++realisation) {
    const NoisyInput noisy = noisy_input(recording, realisation);
    const Response disturbed = read_channels(hypothesis, recording, noisy.input, start, window.to, resolution);
    const Spectrum input = spectrum_of([&](std::size_t k) { return noisy.noise[k]; });
    Spectra outputs;
    for (const model::Channel channel : recording.channels) {
      const auto c = index(channel);
      std::vector<double> changed(disturbed[c].size());
      for (std::size_t k = 0; k < changed.size(); ++k) changed[k] = disturbed[c][k] - clean[c][k];
      const auto difference = [&](std::size_t k) { return changed[k]; };
      outputs.push_back(spectrum_of(difference));
      // The input's own acceleration would hold what is left of the noise above the edge, ω² as much of it.
      if (channel == model::Channel::zdd_r && recording.input_edge > 0.0) {
        changed = smoothed(changed, recording.input_edge, recording.input.period);
      }
      const Window compared = recording.comparable(channel, window);
      for (std::size_t k = compared.from; k < compared.to; ++k) {
        result.variance[c] += std::pow(difference(k), 2) / static_cast<double>(realisations * compared.size());
      }
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
    double density = input_density(recording.input_noise, f, recording.input.period);
    if (b == 0 && recording.mean_unknown) density *= thresholds::integrated_noise_in_lowest_band;
    result.spectrum.push_back(sums[b].covariance(density, spectrum_of.taper_power()));
  }
  return result;
}

}  // namespace host_sim::identification
