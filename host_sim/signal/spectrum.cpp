#include "host_sim/signal/spectrum.hpp"

#include <algorithm>
#include <cmath>
#include <kissfft/kissfft.hh>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace host_sim {

// kissfft transforms the N real numbers as N/2 complex ones and takes the result apart.
struct RealTransform::Plan {
  kissfft<double> half;
};

namespace {

bool is_good_fft_size(std::size_t n) {
  if (n == 0 || n % 2 != 0) return false;
  for (const std::size_t factor : {std::size_t{2}, std::size_t{3}, std::size_t{5}}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

}  // namespace

std::size_t good_fft_size(std::size_t n) {
  std::size_t size = n <= 2 ? 2 : n + n % 2;
  while (!is_good_fft_size(size)) size += 2;
  return size;
}

std::size_t good_fft_size_at_most(std::size_t n) {
  if (n < 2) throw std::invalid_argument("good_fft_size_at_most: less than 2");
  std::size_t size = n - n % 2;
  while (!is_good_fft_size(size)) size -= 2;
  return size;
}

RealTransform::RealTransform(std::size_t length)
    : length_(length >= 2 && length % 2 == 0 ? length : throw std::invalid_argument("RealTransform: length not even")),
      plan_(new Plan{kissfft<double>(length / 2, false)}),
      input_(length),
      output_(length / 2 + 1) {}

RealTransform::~RealTransform() = default;

std::span<const std::complex<double>> RealTransform::operator()(std::span<const double> signal) {
  if (signal.size() > length_) throw std::invalid_argument("RealTransform: signal longer than the transform");
  std::copy(signal.begin(), signal.end(), input_.begin());
  std::fill(input_.begin() + static_cast<std::ptrdiff_t>(signal.size()), input_.end(), 0.0);
  plan_->half.transform_real(input_.data(), output_.data());
  // It returns the two real bins, 0 and N/2, as one complex number.
  output_.back() = output_.front().imag();
  output_.front() = output_.front().real();
  return output_;
}

std::vector<double> RealTransform::inverse(std::span<const std::complex<double>> bins) {
  if (bins.size() != this->bins()) throw std::invalid_argument("RealTransform: another number of bins");
  const std::size_t n = length_;
  std::vector<double> hartley(n);
  hartley[0] = bins[0].real();
  hartley[n / 2] = bins[n / 2].real();
  for (std::size_t k = 1; k < n / 2; ++k) {
    hartley[k] = bins[k].real() - bins[k].imag();
    hartley[n - k] = bins[k].real() + bins[k].imag();
  }
  const auto turned = (*this)(hartley);
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) {
    const bool mirrored = i > n / 2;
    const std::complex<double> f = turned[mirrored ? n - i : i];
    values[i] = (f.real() - (mirrored ? -f.imag() : f.imag())) / static_cast<double>(n);
  }
  return values;
}

std::vector<double> make_window(WindowShape shape, std::size_t length) {
  std::vector<double> window(length, 1.0);
  if (shape == WindowShape::rectangular) return window;
  for (std::size_t n = 0; n < length; ++n) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(length);
    switch (shape) {
      case WindowShape::hann:
        window[n] = 0.5 - 0.5 * std::cos(turn);
        break;
      case WindowShape::hamming:
        window[n] = 0.54 - 0.46 * std::cos(turn);
        break;
      default:
        window[n] = 0.42 - 0.5 * std::cos(turn) + 0.08 * std::cos(2.0 * turn);
        break;
    }
  }
  return window;
}

std::vector<double> hann_window(std::size_t length) { return make_window(WindowShape::hann, length); }

BlockTransform::BlockTransform(std::vector<double> window, Detrend detrend)
    : window_(std::move(window)),
      power_(std::inner_product(window_.begin(), window_.end(), window_.begin(), 0.0)),
      detrend_(detrend),
      transform_(window_.size()),
      block_(window_.size()) {}

std::span<const std::complex<double>> BlockTransform::operator()(std::span<const double> block) {
  if (block.size() != length()) throw std::invalid_argument("BlockTransform: a block of another length");
  const auto N = static_cast<double>(block.size());
  const double middle = 0.5 * (N - 1.0);
  double mean = 0.0, slope = 0.0;
  if (detrend_ != Detrend::none) mean = std::accumulate(block.begin(), block.end(), 0.0) / N;
  if (detrend_ == Detrend::line) {
    for (std::size_t n = 0; n < block.size(); ++n) slope += (static_cast<double>(n) - middle) * (block[n] - mean);
    slope /= N * (N * N - 1.0) / 12.0;  // Σ (n − middle)²
  }
  if (slope == 0.0) {
    for (std::size_t n = 0; n < block.size(); ++n) block_[n] = window_[n] * (block[n] - mean);
  } else {
    for (std::size_t n = 0; n < block.size(); ++n) {
      block_[n] = window_[n] * (block[n] - mean - slope * (static_cast<double>(n) - middle));
    }
  }
  return transform_(block_);
}

double welch_standard_error(std::span<const double> window, std::size_t hop, std::size_t averages) {
  const auto overlap = [&](std::size_t shift) {
    return std::inner_product(window.begin() + static_cast<std::ptrdiff_t>(shift), window.end(), window.begin(), 0.0);
  };
  const double power = overlap(0);
  const auto K = static_cast<double>(averages);
  double sum = 1.0;
  for (std::size_t j = 1; j < averages && j * hop < window.size(); ++j) {
    const double share = overlap(j * hop) / power;
    sum += 2.0 * (1.0 - static_cast<double>(j) / K) * share * share;
  }
  return std::sqrt(sum / K);
}

PowerSpectrum welch(std::span<const double> signal, double sample_rate, std::size_t segment) {
  if (signal.size() < 4 || !(sample_rate > 0.0)) throw std::invalid_argument("welch: no signal, or no sample rate");
  std::size_t length = good_fft_size(segment);
  if (length > signal.size()) length = signal.size() - signal.size() % 2;
  const std::size_t hop = length / 2;
  BlockTransform transform(hann_window(length), Detrend::mean);
  PowerSpectrum spectrum;
  spectrum.density.assign(transform.bins(), 0.0);
  for (std::size_t start = 0; start + length <= signal.size(); start += hop) {
    const std::span<const std::complex<double>> bins = transform(signal.subspan(start, length));
    for (std::size_t k = 0; k < bins.size(); ++k) spectrum.density[k] += std::norm(bins[k]);
    ++spectrum.averages;
  }

  const double scale = 1.0 / (sample_rate * transform.window_power() * static_cast<double>(spectrum.averages));
  spectrum.frequency.resize(transform.bins());
  for (std::size_t k = 0; k < transform.bins(); ++k) {
    spectrum.frequency[k] = static_cast<double>(k) * sample_rate / static_cast<double>(length);
    spectrum.density[k] *= k == 0 || k == length / 2 ? scale : 2.0 * scale;
  }
  spectrum.relative_standard_error = welch_standard_error(transform.window(), hop, spectrum.averages);
  return spectrum;
}

}  // namespace host_sim
