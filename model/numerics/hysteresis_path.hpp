// One travel of a hysteresis element.
#pragma once

#include "model/numerics/select.hpp"

namespace model {

/// The force of an element with stiffness k whose rate changes along the path σ of the deflection:
///
///   (1)  da/dσ = k − r a,   a: the force along the present direction; r: of loading (a > 0) or unloading (a < 0)
///
/// solved with e^{−z} ≈ (1 − z/2 + z²/12)/(1 + z/2 + z²/12), z = r σ: error ∝ z⁵/720, bounded for every z of either
/// sign. Where the force passes through zero, the rest of the path loads anew.
template <class S>
struct HysteresisPath {
  S stiffness;           ///< k [N/m]
  S loading, unloading;  ///< r [1/m]

  /// The force after a travel [m] that began with force u [N].
  [[nodiscard]] constexpr S force_after(S u, S travel) const {
    const S along = select(travel < S(0), S(-u), u);
    const S path = absolute(travel);
    const auto unloads = along < S(0);
    const S end = after(along, path, select(unloads, unloading, loading));
    // unloaded within the travel
    const auto passes = unloads && end > S(0);
    const S rest = select(passes, S(path * end), S(0)) / select(passes, S(end - along), S(1));
    const S reached = select(passes, after(S(0), rest, loading), end);
    return select(travel < S(0), S(-reached), reached);
  }

 private:
  [[nodiscard]] constexpr S after(S along, S path, S rate) const {
    const S z = rate * path, even = S(1) + z * z / S(12), odd = z / S(2);
    return (along * (even - odd) + stiffness * path) / (even + odd);
  }
};

}  // namespace model
