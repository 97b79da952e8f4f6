// The period of a force that repeats along a travel.
#pragma once

#include <vector>

namespace host_sim::identification {

/// The period λ = 1/ν at which a force e over a travel x has the strongest ripple [m]; 0: none stands out.
///
///   (1)  P(ν) = |Σ_k (e_k − ē) exp(2πi ν x_k)|²
///   (2)  λ = 1/argmax P,   where P(ν) ≥ ripple_prominence · median P
///   (3)  ν ≤ 1/(2 median |x_{k+1} − x_k|)     half of the samples tell such a ripple from a slower one
///
/// ν from 1.5/X to thresholds::most_ripples/X in steps of 1/(4X), then of 1/(32X) around the largest, X: the range of
/// x. A force that depends on anything else than the position (noise, friction, a part of the motion) spreads over all
/// ν. Source: Lomb, Astrophysics and Space Science 39, 1976.
[[nodiscard]] double ripple_period(const std::vector<double>& travel, const std::vector<double>& force);

}  // namespace host_sim::identification
