#include "host_sim/diagnose/rest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace host_sim::diagnose {
namespace {

constexpr const auto& edges = noise_band_edges;
constexpr std::size_t bands = noise_bands;

using Table = std::vector<std::array<Power, bands>>;  // by channel

Table table(const Case& all, const Hypothesis& hypothesis, bool held_out) {
  const auto responses = respond(all, hypothesis);
  const auto& whitenings = held_out ? all.judge : all.fit;
  const auto& recordings = held_out ? all.judged : all.fitted;
  const std::size_t channels = all.evidence.front().channels.size();
  Table result(channels);
  for (std::size_t i = 0; i < whitenings.size(); ++i) {
    const Whitening& whitening = whitenings[i];
    const std::vector<double> values =
        whitening.by_channel(whitening.spectra(all.evidence[recordings[i]], responses[recordings[i]]));
    for (std::size_t k = 0; k < whitening.bins(); ++k) {
      const std::size_t b = std::min(bands - 1, noise_band_of(whitening.frequency(k)));
      for (std::size_t c = 0; c < channels; ++c) {
        for (std::size_t part = 0; part < 2; ++part) {
          const double v = values[2 * (k * channels + c) + part];
          result[c][b].squares += v * v;
          result[c][b].count += 1.0;
        }
      }
    }
  }
  return result;
}

/// χ² of n degrees of freedom that a standard normal z stands for. Source: Wilson and Hilferty, 1931.
double chi_squared(double n, double z) {
  const double variance = 2.0 / (9.0 * n);
  return n * std::pow(std::max(1.0 - variance + z * std::sqrt(variance), 0.0), 3);
}

}  // namespace

std::vector<BandPower> band_powers(const Case& all, const Hypothesis& hypothesis) {
  constexpr double z = 1.96;  // 95 %
  const Table powers = table(all, hypothesis, false);
  std::vector<BandPower> result;
  for (std::size_t c = 0; c < powers.size(); ++c) {
    for (std::size_t b = 0; b < bands; ++b) {
      const Power& p = powers[c][b];
      if (!(p.count > 0.0)) continue;
      result.push_back({all.evidence.front().channels[c], edges[b], edges[b + 1], p,
                        p.squares / chi_squared(p.count, z),
                        p.squares / std::max(chi_squared(p.count, -z), 1e-3 * p.count)});
    }
  }
  return result;
}

std::vector<ChannelExcess> channel_excesses(const std::vector<BandPower>& powers) {
  std::vector<ChannelExcess> result;
  for (auto first = powers.begin(); first != powers.end();) {
    const auto last =
        std::find_if(first, powers.end(), [&](const BandPower& p) { return p.channel != first->channel; });
    ChannelExcess e{first->channel, 0.0, 0.0, 0.0, edges.back()};
    for (auto p = first; p != last; ++p) {
      e.excess += std::max(p->power.excess(), 0.0);
      e.significance = std::max(e.significance, p->power.significance());
    }
    double sum = 0.0;
    bool begun = false;
    for (auto p = first; p != last && e.excess > 0.0; ++p) {
      sum += std::max(p->power.excess(), 0.0);
      if (!begun && sum >= 0.1 * e.excess) {
        e.lowest = p->lowest;
        begun = true;
      }
      if (sum >= 0.9 * e.excess) {
        e.highest = p->highest;
        break;
      }
    }
    result.push_back(e);
    first = last;
  }
  return result;
}

Rest rest_of(const Case& all, const Hypothesis& hypothesis) {
  const Table fitted = table(all, hypothesis, false);
  const Table judged = all.judged.empty() ? Table() : table(all, hypothesis, true);
  Rest rest;
  for (std::size_t c = 0; c < fitted.size(); ++c) {
    for (std::size_t b = 0; b < bands; ++b) {
      double z = fitted[c][b].significance();
      double share = fitted[c][b].excess() / std::max(fitted[c][b].count, 1.0);
      if (!judged.empty()) {
        // The held-out quarter has half the significance.
        z = std::min(z, 2.0 * judged[c][b].significance());
        share = std::min(share, judged[c][b].excess() / std::max(judged[c][b].count, 1.0));
      }
      if (share < loud_share || z <= rest.strongest) continue;
      rest.strongest = z;
      char words[160];
      std::snprintf(words, sizeof words, "%s, %.3g to %.3g Hz: %.1f times the power of its noise",
                    std::string(model::name(all.evidence.front().channels[c])).c_str(), edges[b], edges[b + 1],
                    1.0 + share);
      rest.words = words;
    }
  }
  rest.significant = rest.strongest > significant;
  if (!rest.significant) rest.words.clear();
  return rest;
}

}  // namespace host_sim::diagnose
