#include "host_sim/diagnose/whitening.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "host_sim/spectrum.hpp"

namespace host_sim::diagnose {
namespace {

/// The largest fast transform length that is not beyond n.
std::size_t fast_length_within(std::size_t n) {
  std::size_t length = n - n % 2;
  while (length > 2 && good_fft_size(length) != length) length -= 2;
  return length;
}

/// One for each thread and length: plans cost more than transforms.
RealTransform& transform_of(std::size_t length) {
  thread_local std::vector<std::unique_ptr<RealTransform>> transforms;
  for (const auto& t : transforms) {
    if (t->length() == length) return *t;
  }
  return *transforms.emplace_back(std::make_unique<RealTransform>(length));
}

}  // namespace

Whitening::Whitening(const Evidence& evidence, Window window, const std::vector<Eigen::MatrixXcd>& input_noise)
    : window_(window), channels_(evidence.channels.size()), period_(evidence.drive.period) {
  length_ = fast_length_within(window.size());
  window_.to = window_.from + length_;
  const double resolution = 1.0 / (period_ * static_cast<double>(length_));
  const double top = std::min(highest, 0.45 / period_);
  bins_ = static_cast<std::size_t>(top / resolution) + 1;

  // A quarter of a second of cosine at each end.
  const auto ramp = std::min(length_ / 4, static_cast<std::size_t>(0.25 / period_) + 1);
  taper_.assign(length_, 1.0);
  for (std::size_t k = 0; k < ramp; ++k) {
    const double w =
        0.5 - 0.5 * std::cos(std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(ramp));
    taper_[k] = taper_[length_ - 1 - k] = w;
  }
  double squares = 0.0;
  for (const double w : taper_) squares += w * w;
  scale_ = std::sqrt(2.0 / squares);

  const auto bands = static_cast<std::size_t>(top / band) + 1;
  const auto data = spectra(evidence, nullptr);
  factors_.reserve(bands);
  for (std::size_t b = 0; b < bands; ++b) {
    const auto m = static_cast<Eigen::Index>(channels_);
    Eigen::MatrixXcd sigma = Eigen::MatrixXcd::Zero(m, m);
    if (b < input_noise.size()) sigma = input_noise[b];
    std::size_t first = static_cast<std::size_t>(std::ceil(static_cast<double>(b) * band / resolution));
    const std::size_t last =
        std::min(bins_, static_cast<std::size_t>(std::ceil(static_cast<double>(b + 1) * band / resolution)));
    first = std::min(first, bins_);
    for (std::size_t c = 0; c < channels_; ++c) {
      double power = 0.0;
      for (std::size_t k = first; k < last; ++k) power += std::norm(data[c][k]);
      if (last > first) power /= static_cast<double>(last - first) * squares;
      const double noise = evidence.noise[index(evidence.channels[c])];
      const auto i = static_cast<Eigen::Index>(c);
      sigma(i, i) += noise * noise + simulation_error * simulation_error * power + 1e-300;
    }
    deviations_.push_back(sigma.diagonal().real().cwiseSqrt());
    const Eigen::LLT<Eigen::MatrixXcd> cholesky(sigma);
    factors_.push_back(cholesky.matrixL().solve(Eigen::MatrixXcd::Identity(m, m)));
  }
}

double Whitening::frequency(std::size_t bin) const {
  return static_cast<double>(bin) / (period_ * static_cast<double>(length_));
}

std::vector<std::vector<std::complex<double>>> Whitening::spectra(const Evidence& evidence,
                                                                  const Response* response) const {
  RealTransform& transform = transform_of(length_);
  std::vector<std::vector<std::complex<double>>> result;
  std::vector<double> difference(length_);
  for (const model::Channel channel : evidence.channels) {
    const auto c = index(channel);
    const double* const data = evidence.recording[channel].data() + window_.from;
    const double* const simulated = response != nullptr ? (*response)[c].data() + window_.from : nullptr;
    for (std::size_t k = 0; k < length_; ++k) {
      difference[k] = taper_[k] * (data[k] - (simulated != nullptr ? simulated[k] : 0.0));
    }
    if (!evidence.clipped[c].empty()) {
      for (std::size_t k = 0; k < length_; ++k) {
        if (evidence.clipped[c][window_.from + k]) difference[k] = 0.0;
      }
    }
    const auto bins = transform(difference);
    result.emplace_back(bins.begin(), bins.begin() + static_cast<std::ptrdiff_t>(bins_));
  }
  return result;
}

void Whitening::operator()(const Evidence& evidence, const Response& response, std::vector<double>& out) const {
  const auto difference = spectra(evidence, &response);
  for (std::size_t k = 0; k < bins_; ++k) {
    const Eigen::MatrixXcd& factor = factors_[band_of(k)];
    for (std::size_t i = 0; i < channels_; ++i) {
      std::complex<double> sum = 0.0;
      for (std::size_t j = 0; j <= i; ++j) {
        sum += factor(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * difference[j][k];
      }
      out.push_back(scale_ * sum.real());
      out.push_back(scale_ * sum.imag());
    }
  }
}

std::size_t Whitening::band_of(std::size_t bin) const {
  return std::min(factors_.size() - 1, static_cast<std::size_t>(frequency(bin) / band));
}

void Whitening::by_channel(const Evidence& evidence, const Response& response, std::vector<double>& out) const {
  const auto difference = spectra(evidence, &response);
  for (std::size_t k = 0; k < bins_; ++k) {
    const Eigen::VectorXd& deviation = deviations_[band_of(k)];
    for (std::size_t c = 0; c < channels_; ++c) {
      const double scale = scale_ / deviation(static_cast<Eigen::Index>(c));
      out.push_back(scale * difference[c][k].real());
      out.push_back(scale * difference[c][k].imag());
    }
  }
}

}  // namespace host_sim::diagnose
