// Test whether the size of an effect is the same at every amplitude and at every time.
#pragma once

#include <cstddef>

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// FoundCause::constancy of each effect of a model. With s(t) the change of the channels that a small change of a
/// parameter of the effect makes, the parameter p becomes p (1 + ε w(t)), where w is
///
///   (1)  the logarithm of the local rms of s (over thresholds::constancy_window), in deviations from its mean
///   (2)  time, in deviations from its mean
///
/// and ε = 0 is tested while everything fitted makes way linearly (linear_refit.hpp, 2), each residual with its weight in
/// the evidence (model_evidence.hpp): what a discrepancy leaves in a band is no noise that many samples average out. A law outside the catalogue
/// that is near the effect has another size at another amplitude: a power p of velocity in the place of the power q
/// grows by (p − q) times the logarithm of the amplitude. Source: score test, C. R. Rao, Proc. Camb. Phil. Soc. 44,
/// 1948.
void find_constancy(const IdentificationProblem& problem, SearchResult& found);

/// Whether the law of an effect that was found is in doubt: it fails, or another effect of the same subsystem does, by
/// more than a small share of what this one explains. Two laws together imitate a third one: viscous and quadratic
/// damping the power 1.4 of velocity.
[[nodiscard]] bool law_in_doubt(const SearchResult& found, std::size_t effect);

}  // namespace host_sim::identification
