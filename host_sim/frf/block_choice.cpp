#include "host_sim/frf/block_choice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "host_sim/frf/delay.hpp"

namespace host_sim::frf {
namespace {

constexpr std::size_t lags = 256;
using Autocorrelation = std::array<double, lags + 1>;  // r(j/256)

Autocorrelation autocorrelation(WindowShape shape) {
  const std::vector<double> window = make_window(shape, lags);
  Autocorrelation r{};
  for (std::size_t j = 0; j < lags; ++j) r[j] = window_match(window, static_cast<std::ptrdiff_t>(j));
  return r;
}

// (1), r straight between its points: of a curvature of 4π²/3 that is wrong by at most 2.5e-5.
double peak_bias(const Autocorrelation& r, double bandwidth_times_block) {
  const double a = std::numbers::pi * bandwidth_times_block;
  const double step = 1.0 / static_cast<double>(lags);
  if (!(a > 1e-9)) return 1.0;
  double kept = 0.0;
  for (std::size_t j = 0; j < lags; ++j) {
    // a ∫ e^{−au} (r_j + slope (u − u_j)) du over one step
    const double u = static_cast<double>(j) * step;
    const double slope = (r[j + 1] - r[j]) / step;
    const double fall = std::exp(-a * step);
    kept += std::exp(-a * u) * (r[j] - r[j + 1] * fall + slope / a * (1.0 - fall));
  }
  return 1.0 - kept;
}

std::size_t hop_of(std::size_t length, double overlap) {
  const double hop = std::round((1.0 - overlap) * static_cast<double>(length));
  return std::clamp<std::size_t>(static_cast<std::size_t>(hop), 1, length);
}

double independent_averages(const BlockScheme& scheme, std::span<const std::size_t> recordings,
                            std::span<const double> window) {
  double blocks = 0.0, squares = 0.0;
  for (const std::size_t samples : recordings) {
    const std::size_t count = scheme.blocks(samples);
    if (count == 0) continue;
    const double spread = static_cast<double>(count) * welch_standard_error(window, scheme.hop, count);
    blocks += static_cast<double>(count);
    squares += spread * spread;
  }
  return squares > 0.0 ? blocks * blocks / squares : 0.0;
}

// The effective number of blocks does not depend on the sample rate, so a coarse window is enough to compute it.
double independent_averages(const BlockScheme& scheme, std::span<const std::size_t> recordings) {
  if (scheme.length <= lags) return independent_averages(scheme, recordings, make_window(scheme.window, scheme.length));
  const double scale = static_cast<double>(lags) / static_cast<double>(scheme.length);
  BlockScheme coarse = scheme;
  coarse.length = lags;
  coarse.hop = hop_of(lags, 1.0 - static_cast<double>(scheme.hop) / static_cast<double>(scheme.length));
  std::vector<std::size_t> shrunk;
  for (const std::size_t samples : recordings) {
    shrunk.push_back(static_cast<std::size_t>(static_cast<double>(samples) * scale));
  }
  return independent_averages(coarse, shrunk, make_window(scheme.window, lags));
}

}  // namespace

double peak_bias(WindowShape window, double bandwidth_times_block) {
  return peak_bias(autocorrelation(window), bandwidth_times_block);
}

double random_error(double averages, double coherence) {
  return std::sqrt((1.0 - coherence) / (2.0 * coherence * averages));
}

double needed_duration(const BlockWish& wish, double sample_rate) {
  if (wish.block) return 2.0 * *wish.block;
  return static_cast<double>(fewest_blocks + 1) / 2.0 *
         std::max(1.0 / wish.bandwidth(), static_cast<double>(shortest_block) / sample_rate);
}

std::optional<BlockChoice> choose_blocks(std::span<const std::size_t> recordings, double sample_rate,
                                         const BlockWish& wish) {
  if (recordings.empty()) return std::nullopt;
  const std::size_t shortest = *std::min_element(recordings.begin(), recordings.end());
  const std::size_t all = std::accumulate(recordings.begin(), recordings.end(), std::size_t{0});
  const Autocorrelation r = autocorrelation(wish.window);

  const auto scheme_of = [&](std::size_t length) {
    BlockScheme scheme{length, 1, wish.window, wish.detrend};
    const double usual = wish.window == WindowShape::rectangular ? 0.0 : 0.5;
    scheme.hop = hop_of(length, wish.overlap.value_or(usual));
    if (!wish.overlap && usual > 0.0 && independent_averages(scheme, recordings) < 16.0) {
      scheme.hop = hop_of(length, 0.75);
    }
    return scheme;
  };
  const auto choice_of = [&](std::size_t length) {
    BlockChoice choice{scheme_of(length), 0.0, 0.0};
    choice.peak_bias = peak_bias(r, wish.bandwidth() * static_cast<double>(length) / sample_rate);
    choice.random_error = random_error(independent_averages(choice.scheme, recordings), expected_coherence);
    return choice;
  };

  if (wish.block) {
    const double samples = *wish.block * sample_rate;
    if (!(samples <= static_cast<double>(shortest))) return std::nullopt;
    const std::size_t length = good_fft_size(static_cast<std::size_t>(std::llround(samples)));
    if (length > shortest) return std::nullopt;
    std::size_t apart = 0;  // blocks that do not overlap
    for (const std::size_t recording : recordings) apart += recording / length;
    if (apart < 2) return std::nullopt;
    return choice_of(length);
  }

  const std::size_t most = std::min(shortest, 2 * all / (fewest_blocks + 1));
  if (most < shortest_block || static_cast<double>(most) * wish.bandwidth() < sample_rate) return std::nullopt;
  std::optional<BlockChoice> best;
  double least = std::numeric_limits<double>::infinity();
  const std::size_t longest = good_fft_size_at_most(most);
  for (std::size_t length = longest; length >= shortest_block;) {
    const BlockChoice choice = choice_of(length);
    const double error = choice.peak_bias * choice.peak_bias + choice.random_error * choice.random_error;
    if (error < least) {
      least = error;
      best = choice;
    }
    length = good_fft_size_at_most(std::min(static_cast<std::size_t>(static_cast<double>(length) / 1.04), length - 2));
  }
  return best;
}

}  // namespace host_sim::frf
