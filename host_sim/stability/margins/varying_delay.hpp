// A loop whose delay varies: the worst delay of a range, and how much may vary at any speed.
#pragma once

#include <optional>

#include "host_sim/stability/margins/margins.hpp"
#include "host_sim/stability/roots/characteristic_roots.hpp"

namespace host_sim::stability {

/// The loop over the delays lowest … highest.
///
///   slow variation   stable where every delay of the range is: no border within it (crossings, exact)
///   any variation    stable, however fast, within lowest … lowest + δ, where for all ω
///
///     (1)  |T(jω)| < 1/(δ ω),   T = L/(1 + L) at the delay `lowest`
///
/// (1) is sufficient and not necessary: between both the speed of the variation decides. Source: Kao and Lincoln,
/// Simple stability criteria for systems with time-varying delays, Automatica 2004, theorem 1.
struct VaryingDelay {
  double lowest{}, highest{};          ///< [s]
  bool stable{};                       ///< at every constant delay of the range
  double worst_delay{};                ///< where the rightmost root lies farthest to the right [s]
  Complex worst_root;                  ///< [1/s]
  std::optional<double> at_any_speed;  ///< δ of (1) [s]; none: unstable at `lowest`
  [[nodiscard]] bool stable_at_any_speed() const { return stable && at_any_speed && *at_any_speed >= highest - lowest; }
};

/// `margins`: of the same loop, which do not depend on its delay as far as stable_delays go.
[[nodiscard]] VaryingDelay varying_delay(const DelayEquation& equation, const Margins& margins, double lowest,
                                         double highest);

}  // namespace host_sim::stability
