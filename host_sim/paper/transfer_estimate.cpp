#include "host_sim/paper/transfer_estimate.hpp"

#include <cmath>
#include <stdexcept>

#include "host_sim/spectrum.hpp"

namespace host_sim::paper {
namespace {

using Complex = std::complex<double>;

/// The windowed segment, its mean removed.
std::vector<double> segment_of(std::span<const double> signal, const std::vector<double>& window) {
  double mean = 0.0;
  for (const double v : signal) mean += v;
  mean /= static_cast<double>(signal.size());
  std::vector<double> result(signal.size());
  for (std::size_t i = 0; i < signal.size(); ++i) result[i] = window[i] * (signal[i] - mean);
  return result;
}

}  // namespace

TransferEstimate transfer_estimate(std::span<const double> input, std::span<const double> output, double sample_rate,
                                   std::size_t segment, double from, double to, std::size_t count) {
  const std::size_t length = good_fft_size(segment);
  if (input.size() != output.size() || input.size() < length) {
    throw std::invalid_argument("two signals of one length, at least a segment long, are needed");
  }
  RealTransform transform(length);
  const std::vector<double> window = hann_window(length);
  std::vector<double> power_in(transform.bins()), power_out(transform.bins());
  std::vector<Complex> cross(transform.bins());
  TransferEstimate result;
  for (std::size_t start = 0; start + length <= input.size(); start += length / 2) {
    const auto x = transform(segment_of(input.subspan(start, length), window));
    const std::vector<Complex> at_input(x.begin(), x.end());
    const auto y = transform(segment_of(output.subspan(start, length), window));
    for (std::size_t k = 0; k < cross.size(); ++k) {
      power_in[k] += std::norm(at_input[k]);
      power_out[k] += std::norm(y[k]);
      cross[k] += std::conj(at_input[k]) * y[k];
    }
    ++result.averages;
  }
  std::size_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double wanted = from * std::pow(to / from, static_cast<double>(i) / static_cast<double>(count - 1));
    const auto k = static_cast<std::size_t>(std::lround(wanted * static_cast<double>(length) / sample_rate));
    if (k <= last || k + 1 >= cross.size()) continue;
    last = k;
    result.frequency.push_back(static_cast<double>(k) * sample_rate / static_cast<double>(length));
    result.response.push_back(cross[k] / power_in[k]);
    result.coherence.push_back(std::norm(cross[k]) / (power_in[k] * power_out[k]));
  }
  return result;
}

double growth_rate(std::span<const double> signal, double sample_rate, std::size_t window) {
  const std::size_t windows = signal.size() / window;
  if (windows < 2) throw std::invalid_argument("two windows at least are needed");
  double sum_t = 0.0, sum_l = 0.0, sum_tt = 0.0, sum_tl = 0.0;
  for (std::size_t i = 0; i < windows; ++i) {
    double squares = 0.0;
    for (const double v : signal.subspan(i * window, window)) squares += v * v;
    const double t = static_cast<double>(i * window) / sample_rate;
    const double l = 0.5 * std::log(squares / static_cast<double>(window));
    sum_t += t;
    sum_l += l;
    sum_tt += t * t;
    sum_tl += t * l;
  }
  const auto n = static_cast<double>(windows);
  return (n * sum_tl - sum_t * sum_l) / (n * sum_tt - sum_t * sum_t);
}

}  // namespace host_sim::paper
