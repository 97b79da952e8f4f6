// Delay of the test machine that changes with time.
#pragma once

#include <cstdint>

#include "model/numerics/elementary.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// The delay of the machine about that of its effect actuator_delay:
///
///   τ(t) = max(0, delay + swing sin(2π t/time) + jitter r_k),   r_k uniform in ± 1, anew in each period
///
/// r_k is a hash of the number of the period: the same in every run and on every machine.
template <class S, bool room>
struct DelayVariation {
  S swing{};   ///< [s]
  S time{10};  ///< of the swing [s]
  S jitter{};  ///< [s]

  [[nodiscard]] constexpr bool any() const { return swing > S(0) || jitter > S(0); }
  [[nodiscard]] constexpr S farthest() const { return swing + jitter; }  ///< from the mean [s]

  /// Of the delay in period k, less its mean [s].
  [[nodiscard]] constexpr S deviation(std::uint32_t k, S period) const {
    std::uint32_t h = k * 0x9e3779b9U;  // Weyl sequence, then the finaliser of MurmurHash3
    h = (h ^ (h >> 16U)) * 0x85ebca6bU;
    h = (h ^ (h >> 13U)) * 0xc2b2ae35U;
    h ^= h >> 16U;
    const S uniform = S(h) * S(1.0 / 2147483648.0) - S(1);
    return swing * turned(S(k) * period / time).sine + jitter * uniform;
  }
};

/// Where there is no room for one.
template <class S>
struct DelayVariation<S, false> {
  [[nodiscard]] static constexpr bool any() { return false; }
  [[nodiscard]] static constexpr S farthest() { return S(0); }
};

}  // namespace model
