#include "host_sim/signal/bands.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "host_sim/signal/spectrum.hpp"

namespace host_sim {
namespace {

// Nominal mid-band frequencies of a decade.
constexpr std::array<int, 10> nominal{100, 125, 160, 200, 250, 315, 400, 500, 630, 800};

// The edge below band n is the edge above band n − 1: one formula, one value.
double edge_below(int number) { return 1000.0 * std::pow(10.0, (2.0 * number - 1.0) / 20.0); }

// Σ |X_k|² of the one-sided bins, as power of the two-sided spectrum.
std::vector<double> line_powers(std::span<const double> signal, double mean, double tapered_part) {
  const std::size_t n = signal.size();
  std::vector<double> piece(n);
  const double taper = std::max(tapered_part * static_cast<double>(n), 1.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double from_end = static_cast<double>(std::min(i, n - 1 - i)) + 0.5;
    const double weight =
        tapered_part > 0.0 && from_end < taper ? 0.5 - 0.5 * std::cos(std::numbers::pi * from_end / taper) : 1.0;
    piece[i] = weight * (signal[i] - mean);
  }
  RealTransform transform(good_fft_size(n));
  const auto bins = transform(piece);
  std::vector<double> powers(bins.size());
  for (std::size_t k = 0; k < bins.size(); ++k) {
    powers[k] = std::norm(bins[k]) * (k == 0 || k + 1 == bins.size() ? 1.0 : 2.0);
  }
  return powers;
}

}  // namespace

Band third_octave_band(int number) {
  return {number, edge_below(number), 1000.0 * std::pow(10.0, number / 10.0), edge_below(number + 1)};
}

std::string nominal_name(const Band& band) {
  // 1000 Hz is number 0: three decades of the table above 1 Hz.
  const int decade = static_cast<int>(std::floor(band.number / 10.0));
  int digits = nominal[static_cast<std::size_t>(band.number - 10 * decade)];  // three significant digits
  int power = decade + 1;                                                     // f = digits · 10^power
  while (digits % 10 == 0) {
    digits /= 10;
    ++power;
  }
  std::string name = std::to_string(digits);
  if (power >= 0) return name + std::string(static_cast<std::size_t>(power), '0');
  const auto decimals = static_cast<std::size_t>(-power);
  if (name.size() <= decimals) name.insert(0, decimals + 1 - name.size(), '0');
  return name.insert(name.size() - decimals, ".");
}

std::vector<Band> resolved_bands(std::size_t samples, double sample_rate) {
  std::vector<Band> bands;
  if (samples < 16) return bands;
  const double line = sample_rate / static_cast<double>(samples);
  const double width = third_octave_band(0).upper / 1000.0 - third_octave_band(0).lower / 1000.0;
  int number = static_cast<int>(std::floor(10.0 * std::log10(4.0 * line / width / 1000.0)));
  for (;; ++number) {
    const Band band = third_octave_band(number);
    if (band.lower >= 0.5 * sample_rate) return bands;
    if (band.upper - band.lower >= 4.0 * line) bands.push_back(band);
  }
}

BandRms band_rms(std::span<const double> signal, double sample_rate, std::span<const Band> bands) {
  BandRms result;
  result.rms.assign(bands.size(), 0.0);
  const std::size_t n = signal.size();
  if (n == 0) return result;
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / static_cast<double>(n);
  double variance = 0.0;
  for (const double x : signal) variance += (x - mean) * (x - mean);
  variance /= static_cast<double>(n);
  if (variance == 0.0) return result;

  constexpr double tapered_part = 0.05;
  std::vector<double> powers = line_powers(signal, mean, tapered_part);
  // If nearly all power lies in the tapered ends, the signal is transformed without taper.
  double total = std::accumulate(powers.begin(), powers.end(), 0.0);
  if (total < 1e-3 * variance * static_cast<double>(n) * static_cast<double>(2 * (powers.size() - 1))) {
    powers = line_powers(signal, mean, 0.0);
  }

  // cumulated[k]: the power below the upper end of line k, which reaches half a line to both sides of its frequency.
  std::vector<double> cumulated(powers.size());
  std::partial_sum(powers.begin(), powers.end(), cumulated.begin());
  total = cumulated.back();
  const double lines_per_hertz = static_cast<double>(2 * (powers.size() - 1)) / sample_rate;
  const auto power_below = [&](double frequency) {
    const double position = frequency * lines_per_hertz + 0.5;
    if (position >= static_cast<double>(powers.size())) return total;
    const auto k = static_cast<std::size_t>(position);
    return cumulated[k] - powers[k] * (static_cast<double>(k + 1) - position);
  };
  const auto rms = [&](double power) { return std::sqrt(std::max(0.0, power) / total * variance); };

  if (bands.empty()) {
    result.below = std::sqrt(variance);
    return result;
  }
  result.below = rms(power_below(bands.front().lower));
  for (std::size_t i = 0; i < bands.size(); ++i) {
    result.rms[i] = rms(power_below(bands[i].upper) - power_below(bands[i].lower));
  }
  result.above = rms(total - power_below(bands.back().upper));
  return result;
}

}  // namespace host_sim
