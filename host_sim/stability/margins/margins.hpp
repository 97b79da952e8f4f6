// Stability margins of a loop.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/stability/margins/crossings.hpp"

namespace host_sim::stability {

/// A gain factor of the force F at which stability begins or ends, from 1/100 to 100.
struct GainMargin {
  double factor{};  ///< [1]
  double omega{};   ///< [rad/s]
};

/// Margins of the loop L = (Q/P) e^{−sτ}, broken at the force F, with 1 + L = 0 on the border. For a stable
/// loop they are distances to the nearest border; for an unstable loop they are the changes that reach one.
struct Margins {
  std::optional<double> critical_delay;  ///< smallest total delay with a root on the axis [s], up to longest_delay
  double critical_omega{};               ///< its frequency [rad/s]
  std::optional<double> delay_margin;    ///< delay to the next border: > 0 to be added, < 0 to be taken away [s]
  double delay_margin_omega{};           ///< [rad/s]
  std::optional<GainMargin> upper_gain;  ///< smallest factor > 1 on the border
  std::optional<GainMargin> lower_gain;  ///< largest factor below 1 on the border
  std::optional<double> phase_margin;    ///< smallest |arg L + π| where |L| = 1, with its sign [rad]
  double phase_margin_omega{};           ///< [rad/s]
  std::vector<CrossingFrequency> frequencies;
  std::vector<StableRange> stable_delays;
};

/// `stable`: the verdict at the equation's delay.
[[nodiscard]] Margins margins(const DelayEquation& equation, bool stable);

/// Peak of the sensitivity function between 0.01 and 1e5 rad/s: the reciprocal of the smallest distance of L(jω) from
/// −1.
struct SensitivityPeak {
  double value{};  ///< max |1/(1 + L)|
  double omega{};  ///< [rad/s]
};
[[nodiscard]] SensitivityPeak sensitivity_peak(const DelayEquation& equation);

}  // namespace host_sim::stability
