#include "host_sim/paper/transfer_estimate.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include "host_sim/frf/cross_spectra.hpp"
#include "host_sim/frf/estimators.hpp"

namespace host_sim::paper {

TransferEstimate transfer_estimate(std::span<const double> input, std::span<const double> output, double sample_rate,
                                   std::size_t segment, double from, double to, std::size_t count) {
  const std::size_t length = good_fft_size(segment);
  if (input.size() != output.size() || input.size() < length) {
    throw std::invalid_argument("two signals of one length, at least a segment long, are needed");
  }
  frf::CrossSpectra spectra(sample_rate, {length, length / 2, WindowShape::hann, Detrend::mean}, 2, 1);
  spectra.add(std::array{frf::ShiftedSignal{input}, frf::ShiftedSignal{output}});
  TransferEstimate result;
  result.averages = spectra.averages();
  std::size_t last = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double wanted = from * std::pow(to / from, static_cast<double>(i) / static_cast<double>(count - 1));
    const auto k = static_cast<std::size_t>(std::lround(wanted * static_cast<double>(length) / sample_rate));
    if (k <= last || k + 1 >= spectra.lines()) continue;
    last = k;
    const auto cross = spectra.cross(0, 1, k);
    result.frequency.push_back(spectra.frequency(k));
    result.response.push_back(cross / spectra.power(0, k));
    result.coherence.push_back(frf::coherence(spectra.power(0, k), spectra.power(1, k), cross));
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
