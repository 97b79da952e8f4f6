#include "host_sim/frf/cross_spectra.hpp"

#include <algorithm>
#include <stdexcept>

namespace host_sim::frf {

CrossSpectra::CrossSpectra(double sample_rate, const BlockScheme& scheme, std::size_t channels, std::size_t references)
    : sample_rate_(sample_rate),
      scheme_(scheme),
      channels_(channels),
      references_(references),
      transform_(make_window(scheme.window, scheme.length), scheme.detrend),
      block_(channels, std::vector<Complex>(transform_.bins())),
      power_(channels, std::vector<double>(transform_.bins())),
      cross_(references * channels, std::vector<Complex>(transform_.bins())) {
  if (scheme.hop == 0 || scheme.hop > scheme.length || references > channels || !(sample_rate > 0.0)) {
    throw std::invalid_argument("CrossSpectra: no such blocks");
  }
}

std::size_t CrossSpectra::add(std::span<const ShiftedSignal> recording) {
  if (recording.size() != channels_) throw std::invalid_argument("CrossSpectra: not one signal a channel");
  std::ptrdiff_t earliest = 0, latest = 0;
  for (const ShiftedSignal& signal : recording) {
    if (signal.samples.size() != recording.front().samples.size()) {
      throw std::invalid_argument("CrossSpectra: channels of different length");
    }
    earliest = std::min(earliest, signal.shift);
    latest = std::max(latest, signal.shift);
  }
  const auto lost = static_cast<std::size_t>(latest - earliest);
  const std::size_t samples = recording.front().samples.size();
  const std::size_t blocks = samples > lost ? scheme_.blocks(samples - lost) : 0;
  if (blocks == 0) return 0;

  for (std::size_t b = 0; b < blocks; ++b) {
    const auto start = static_cast<std::ptrdiff_t>(b * scheme_.hop) - earliest;
    for (std::size_t i = 0; i < channels_; ++i) {
      const auto at = static_cast<std::size_t>(start + recording[i].shift);
      const std::span<const Complex> bins = transform_(recording[i].samples.subspan(at, scheme_.length));
      std::copy(bins.begin(), bins.end(), block_[i].begin());
      std::vector<double>& power = power_[i];
      for (std::size_t k = 0; k < bins.size(); ++k) power[k] += std::norm(bins[k]);
    }
    for (std::size_t r = 0; r < references_; ++r) {
      const std::vector<Complex>& x = block_[r];
      for (std::size_t i = r + 1; i < channels_; ++i) {
        const std::vector<Complex>& y = block_[i];
        std::vector<Complex>& sum = cross_[r * channels_ + i];
        for (std::size_t k = 0; k < x.size(); ++k) {  // x* y by hand: the library's product looks for infinities
          sum[k] += Complex(x[k].real() * y[k].real() + x[k].imag() * y[k].imag(),
                            x[k].real() * y[k].imag() - x[k].imag() * y[k].real());
        }
      }
    }
  }
  blocks_ += blocks;
  const double spread = static_cast<double>(blocks) * welch_standard_error(transform_.window(), scheme_.hop, blocks);
  squares_ += spread * spread;
  return blocks;
}

double CrossSpectra::effective_averages() const {
  const auto K = static_cast<double>(blocks_);
  return blocks_ == 0 ? 0.0 : K * K / squares_;
}

double CrossSpectra::frequency(std::size_t line) const {
  return static_cast<double>(line) * sample_rate_ / static_cast<double>(scheme_.length);
}

double CrossSpectra::scale(std::size_t line) const {
  const double once = 1.0 / (sample_rate_ * transform_.window_power() * static_cast<double>(blocks_));
  return line == 0 || line + 1 == lines() ? once : 2.0 * once;
}

double CrossSpectra::power(std::size_t channel, std::size_t line) const { return scale(line) * power_[channel][line]; }

Complex CrossSpectra::cross(std::size_t reference, std::size_t channel, std::size_t line) const {
  if (reference == channel) return power(channel, line);
  if (channel < reference) return std::conj(cross(channel, reference, line));
  return scale(line) * cross_[reference * channels_ + channel][line];
}

}  // namespace host_sim::frf
