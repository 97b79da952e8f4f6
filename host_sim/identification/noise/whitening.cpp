#include "host_sim/identification/noise/whitening.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>

#include "host_sim/signal/spectrum.hpp"

namespace host_sim::identification {
namespace {

/// h_c(f) of (4) and (5), with its zeros filled.
double power_of_noise(const PreparedRecording& recording, model::Channel channel, const NoiseColour& colour, double f) {
  const auto& renewals = recording.renewals[index(channel)];
  if (!renewals) {
    return std::max(colour.power(f, recording.compared_period()), thresholds::least_filtered_noise);
  }
  const double x = std::numbers::pi * f * renewals->period * recording.input.period;
  const double sinc = x > 1e-6 ? std::sin(x) / x : 1.0;
  const double samples = renewals->period / static_cast<double>(recording.step);
  return std::max(samples * sinc * sinc, thresholds::least_held_noise);
}

/// ε of (2)
double error_of_simulation(double f, double step) {
  const double turn = 2.0 * std::numbers::pi * f * step;
  return std::hypot(thresholds::simulation_error, std::pow(turn, 4) / 30.0);
}

/// A Fourier transform borrowed from a shared list: a plan costs more than a transform, and serves one thread at a
/// time.
class LentTransform {
 public:
  explicit LentTransform(std::size_t length) {
    const std::lock_guard lock(guard());
    auto& free = shelf();
    const auto fits = std::find_if(free.begin(), free.end(), [&](const auto& t) { return t->length() == length; });
    if (fits != free.end()) {
      transform_ = std::move(*fits);
      free.erase(fits);
    } else {
      transform_ = std::make_unique<RealTransform>(length);
    }
  }
  ~LentTransform() {
    const std::lock_guard lock(guard());
    auto& free = shelf();
    free.push_back(std::move(transform_));
    constexpr std::size_t most = 16;
    if (free.size() > most) free.erase(free.begin());
  }
  LentTransform(const LentTransform&) = delete;
  LentTransform& operator=(const LentTransform&) = delete;

  RealTransform& operator*() { return *transform_; }

 private:
  static std::mutex& guard() {
    static std::mutex mutex;
    return mutex;
  }
  static std::vector<std::unique_ptr<RealTransform>>& shelf() {
    static std::vector<std::unique_ptr<RealTransform>> free;
    return free;
  }
  std::unique_ptr<RealTransform> transform_;
};

}  // namespace

Whitening::Whitening(const PreparedRecording& recording, Window window, const ChannelNoises& noise,
                     const std::vector<Eigen::MatrixXcd>& input_noise, double model_error)
    : decimation_(1.0 / recording.compared_period(), thresholds::highest_frequency),
      window_(window),
      step_(recording.step),
      channels_(recording.channels.size()),
      period_(recording.compared_period()) {
  window_.from = recording.compared_from(window.from);
  length_ = decimation_.factor() *
            good_fft_size_at_most((window.to - std::min(window.to, window_.from)) / step_ / decimation_.factor());
  window_.to = window_.from + length_ * step_;
  const double resolution = 1.0 / (period_ * static_cast<double>(length_));
  const double top = std::min(thresholds::highest_frequency, thresholds::highest_share_of_rate / period_);
  bins_ = static_cast<std::size_t>(top / resolution) + 1;
  set_taper();
  set_means_kept(recording, noise);
  std::vector<double> mean_squares;
  for (std::size_t c = 0; c < channels_; ++c) {
    const auto& values = recording.recording[recording.channels[c]];
    data_.push_back(spectrum(recording, c, values));
    double sum = 0.0;
    for (std::size_t k = window_.from; k < window_.to; k += step_) sum += values[k] * values[k];
    mean_squares.push_back(sum / static_cast<double>(length_));
  }
  const auto bands = static_cast<std::size_t>(top / thresholds::covariance_band) + 1;
  const auto m = static_cast<Eigen::Index>(channels_);
  for (std::size_t b = 0; b < bands; ++b) {
    const Eigen::MatrixXcd sigma = covariance(recording, b, noise, input_noise, model_error, mean_squares);
    deviations_.push_back(sigma.diagonal().real().cwiseSqrt());
    const Eigen::LLT<Eigen::MatrixXcd> cholesky(sigma);
    factors_.push_back(cholesky.matrixL().solve(Eigen::MatrixXcd::Identity(m, m)));
  }
}

void Whitening::set_taper() {
  const auto ramp = std::min(length_ / 4, static_cast<std::size_t>(thresholds::taper_length / period_) + 1);
  taper_.assign(length_, 1.0);
  for (std::size_t k = 0; k < ramp; ++k) {
    const double w =
        0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(ramp));
    taper_[k] = taper_[length_ - 1 - k] = w;
  }
  for (const double w : taper_) taper_power_ += w * w;
  scale_ = std::sqrt(2.0 / taper_power_);
}

/// (7)
void Whitening::set_means_kept(const PreparedRecording& recording, const ChannelNoises& noise) {
  for (const model::Channel channel : recording.channels) {
    means_kept_.push_back(recording.has_unknown_mean(channel) ? 0.0 : 1.0);
  }
  if (!recording.mean_unknown) return;
  double squares = 0.0, weights = 0.0;
  for (std::size_t k = window_.from; k < window_.to; ++k) {
    const double v = recording.input.motion[k].velocity;
    squares += v * v / static_cast<double>(window_.size());
  }
  for (const double w : taper_) weights += w;
  const double duration = period_ * static_cast<double>(length_);
  const double unknown = std::sqrt(2.0 * thresholds::integrated_noise_in_lowest_band * squares) / duration;
  for (std::size_t c = 0; c < channels_; ++c) {
    const model::Channel channel = recording.channels[c];
    const bool acceleration = channel == model::Channel::zdd_w || channel == model::Channel::zdd_b;
    const double own = noise[index(channel)].level * std::sqrt(taper_power_) / weights;
    if (acceleration && own > 0.0) means_kept_[c] = own / std::hypot(own, unknown);
  }
}

/// S_c of (2) in one band.
double Whitening::power(std::size_t channel, std::size_t band) const {
  const double resolution = 1.0 / (period_ * static_cast<double>(length_));
  const auto first_bin = [&](std::size_t b) {
    const double edge = static_cast<double>(b) * thresholds::covariance_band;
    return std::min(bins_, static_cast<std::size_t>(std::ceil(edge / resolution)));
  };
  const std::size_t first = first_bin(band), last = first_bin(band + 1);
  double sum = 0.0;
  for (std::size_t k = first; k < last; ++k) sum += std::norm(data_[channel][k]);
  return last > first ? sum / (static_cast<double>(last - first) * taper_power_) : sum;
}

/// (2)
Eigen::MatrixXcd Whitening::covariance(const PreparedRecording& recording, std::size_t band, const ChannelNoises& noise,
                                       const std::vector<Eigen::MatrixXcd>& input_noise, double model_error,
                                       const std::vector<double>& mean_squares) const {
  const auto m = static_cast<Eigen::Index>(channels_);
  Eigen::MatrixXcd sigma = Eigen::MatrixXcd::Zero(m, m);
  if (band < input_noise.size()) sigma = input_noise[band];
  const double f = (static_cast<double>(band) + 0.5) * thresholds::covariance_band;
  for (std::size_t c = 0; c < channels_; ++c) {
    const model::Channel channel = recording.channels[c];
    const ChannelNoise& own = noise[index(channel)];
    const double channel_power = power(c, band);
    const auto i = static_cast<Eigen::Index>(c);
    const double error = error_of_simulation(f, recording.input.period);
    sigma(i, i) += own.level * own.level * power_of_noise(recording, channel, own.colour, f) +
                   error * error * channel_power + 1e-300;
    if (!recording.renewals[index(channel)]) {
      const double unknown = own.on_signal ? thresholds::filter_error : 1.0;
      sigma(i, i) += std::pow(unknown * (1.0 - own.colour.power(f, period_)), 2) * channel_power;
    }
    sigma(i, i) += model_error * model_error * mean_squares[c];
    // z_r alone says nothing of faster motion: the whole channel is uncertain.
    const bool unknown = recording.acceleration_known > 0.0 && f > recording.acceleration_known;
    if (unknown && channel == model::Channel::zdd_r) sigma(i, i) += channel_power;
  }
  return sigma;
}

double Whitening::spread() const {
  double fourth = 0.0;
  for (const double w : taper_) fourth += std::pow(w, 4);
  return static_cast<double>(length_) * fourth / (taper_power_ * taper_power_);
}

double Whitening::frequency(std::size_t bin) const {
  return static_cast<double>(bin) / (period_ * static_cast<double>(length_));
}

/// (7) and (8)
void Whitening::remove_line(const std::vector<bool>& clipped, double share, std::vector<double>& tapered) const {
  const auto weight = [&](std::size_t k) {
    return clipped.empty() || !clipped[window_.from + k * step_] ? taper_[k] : 0.0;
  };
  double weights = 0.0, places = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < length_; ++k) {
    weights += weight(k);
    places += weight(k) * static_cast<double>(k);
    sum += tapered[k];
  }
  if (!(weights > 0.0)) return;
  const double middle = places / weights;
  double moments = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < length_; ++k) {
    const double place = static_cast<double>(k) - middle;
    moments += place * tapered[k];
    squares += weight(k) * place * place;
  }
  const double mean = share * sum / weights, slope = squares > 0.0 ? moments / squares : 0.0;
  for (std::size_t k = 0; k < length_; ++k) {
    tapered[k] -= weight(k) * (mean + slope * (static_cast<double>(k) - middle));
  }
}

Spectrum Whitening::spectrum(const PreparedRecording& recording, std::size_t channel,
                             const std::vector<double>& readings) const {
  std::vector<double> tapered(length_);
  const double* const values = readings.data() + window_.from;
  for (std::size_t k = 0; k < length_; ++k) tapered[k] = taper_[k] * values[k * step_];
  const std::vector<bool>& clipped = recording.clipped[index(recording.channels[channel])];
  if (!clipped.empty()) {
    for (std::size_t k = 0; k < length_; ++k) {
      if (clipped[window_.from + k * step_]) tapered[k] = 0.0;
    }
  }
  if (means_kept_[channel] < 1.0) remove_line(clipped, 1.0 - means_kept_[channel], tapered);
  const std::vector<double> decimated = decimation_(std::move(tapered));
  LentTransform transform(decimated.size());
  const auto bins = (*transform)(decimated);
  Spectrum spectrum(bins.begin(), bins.begin() + static_cast<std::ptrdiff_t>(bins_));
  for (auto& value : spectrum) value *= static_cast<double>(decimation_.factor());
  return spectrum;
}

Spectra Whitening::spectra(const PreparedRecording& recording, const Response& readings) const {
  Spectra result;
  for (std::size_t c = 0; c < channels_; ++c) {
    result.push_back(spectrum(recording, c, readings[index(recording.channels[c])]));
  }
  return result;
}

void Whitening::whiten(const Spectra& simulated, double* out) const {
  std::vector<std::complex<double>> difference(channels_);
  for (std::size_t k = 0; k < bins_; ++k) {
    const Eigen::MatrixXcd& factor = factors_[band_of(k)];
    for (std::size_t j = 0; j < channels_; ++j) difference[j] = data_[j][k] - simulated[j][k];
    for (std::size_t i = 0; i < channels_; ++i) {
      double real = 0.0, imaginary = 0.0;
      for (std::size_t j = 0; j <= i; ++j) {
        const std::complex<double> f = factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
        const std::complex<double> d = difference[j];
        real += f.real() * d.real() - f.imag() * d.imag();
        imaginary += f.real() * d.imag() + f.imag() * d.real();
      }
      *out++ = scale_ * real;
      *out++ = scale_ * imaginary;
    }
  }
}

std::size_t Whitening::band_of(std::size_t bin) const {
  return std::min(factors_.size() - 1, static_cast<std::size_t>(frequency(bin) / thresholds::covariance_band));
}

std::vector<double> Whitening::by_channel(const Spectra& simulated) const {
  std::vector<double> out;
  out.reserve(count());
  for (std::size_t k = 0; k < bins_; ++k) {
    const Eigen::VectorXd& deviation = deviations_[band_of(k)];
    for (std::size_t c = 0; c < channels_; ++c) {
      const double scale = scale_ / deviation(static_cast<Eigen::Index>(c));
      out.push_back(scale * (data_[c][k] - simulated[c][k]).real());
      out.push_back(scale * (data_[c][k] - simulated[c][k]).imag());
    }
  }
  return out;
}

}  // namespace host_sim::identification
