// Delay of a channel and its effect on an estimate from blocks.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "host_sim/frf/cross_spectra.hpp"

namespace host_sim::frf {

/// Common part of two windowed blocks if one is `shift` samples late:
///
///   (1)  r(d) = Σ_n w_n w_{n+|d|} / Σ w²
///
/// The estimate of a response with impulse response h tends to Σ_τ r(τ) h(τ) e^{−jωτ}. A pure delay d is therefore
/// multiplied by r(d): 1 − d/N for a rectangular window, 1 − (2π²/3)(d/N)² for Hann and small d. Its coherence is
/// multiplied by r(d)². Source: Bendat and Piersol, Random Data, 8.5.1 (rectangular window), from E(Ŝ_xy) with the
/// window's autocorrelation.
[[nodiscard]] double window_match(std::span<const double> window, std::ptrdiff_t shift);

/// The delay of `channel` against reference 0 [samples], by generalised cross-correlation: the highest point of the
/// envelope
///
///   (2)  c(d) = |Σ_k W_k S_k/|S_k| e^{jω_k d}|,  S = S_xy,  W = γ²/(1 − γ²), γ² freed from its bias 1/K, at most 0.99
///
/// A phase that is constant over frequency (a velocity, an inverted sensor) does not change d. The search covers a
/// quarter of a block to both sides. nullopt if c < 5 √(Σ W²) everywhere: unrelated signals exceed this limit in one of
/// 10⁵ points with a probability of 10⁻⁶.
/// Source: C. H. Knapp, G. C. Carter, IEEE Trans. ASSP 24 (1976), 320–327: the maximum-likelihood weighting.
[[nodiscard]] std::optional<std::ptrdiff_t> find_delay(const CrossSpectra& spectra, std::size_t channel);

}  // namespace host_sim::frf
