#include "tests/bench/replicate_rival/inverse_response.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/signal/spectrum.hpp"

namespace replicate_rival {

using host_sim::replicate::BandInverse;
using model::Channel;

std::vector<std::complex<double>> measured_response(const firmware::Recording& run, std::size_t length) {
  const double rate = 1.0 / run.sample_period;
  const std::size_t block = host_sim::good_fft_size(static_cast<std::size_t>(4.0 * rate));
  host_sim::BlockTransform transform(host_sim::hann_window(block), host_sim::Detrend::mean);
  const auto &in = run[Channel::z_cmd], &out = run[Channel::zdd_w];
  std::vector<std::complex<double>> cross(transform.bins());
  std::vector<double> power(transform.bins(), 0.0);
  for (std::size_t at = 0; at + block <= in.size(); at += block / 2) {
    const auto u = transform(std::span(in).subspan(at, block));
    const std::vector<std::complex<double>> input(u.begin(), u.end());
    const auto y = transform(std::span(out).subspan(at, block));
    for (std::size_t k = 0; k < power.size(); ++k) {
      cross[k] += std::conj(input[k]) * y[k];
      power[k] += std::norm(input[k]);
    }
  }
  std::vector<std::complex<double>> response(length / 2 + 1);
  for (std::size_t k = 0; k < response.size(); ++k) {
    const double at = static_cast<double>(k * block) / static_cast<double>(length);
    const auto line = std::min(static_cast<std::size_t>(at), power.size() - 2);
    const double share = std::min(1.0, at - static_cast<double>(line));
    const auto h = [&](std::size_t i) { return power[i] > 0.0 ? cross[i] / power[i] : std::complex<double>(); };
    response[k] = (1.0 - share) * h(line) + share * h(line + 1);
  }
  return response;
}

InverseResponse::InverseResponse(const host_sim::replicate::Target& target,
                                 const std::vector<std::complex<double>>& response,
                                 const host_sim::replicate::DriveLimits& limits, double gain)
    : target_(target),
      inverse_(BandInverse::transform_length(target), {response}, target),
      limits_(inverse_, limits, target.period),
      gain_(gain),
      drive_(target.size(), 0.0) {
  take(drive_);
}

std::vector<double> InverseResponse::error(const std::vector<double>& answer) const {
  std::vector<double> error = target_.values.front();
  for (std::size_t k = 0; k < std::min(error.size(), answer.size()); ++k) error[k] -= answer[k];
  return inverse_.in_band(0, error);
}

void InverseResponse::take(const std::vector<double>& answer) {
  const std::vector<double> step = inverse_.drive({error(answer)});
  for (std::size_t k = 0; k < drive_.size(); ++k) drive_[k] += gain_ * step[k];
  drive_ = limits_(std::move(drive_));
}

}  // namespace replicate_rival
