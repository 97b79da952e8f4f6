#include "host_sim/stability/margins/varying_delay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace host_sim::stability {
namespace {

/// Delays of the range whose roots are worked out: their spacing decides the worst one only, the verdict is exact.
/// Half: the worst root of a range of 2 ms is off by 1 % of its change. Twice: nothing that is printed changes.
constexpr int delays = 33;
/// (1) is evaluated at so many frequencies, evenly by logarithm, between these [rad/s]. Half: the minimum is off by
/// 1e-4 near a resonance with 1 % of damping.
constexpr int speed_frequencies = 8000;
constexpr double lowest_speed_frequency = 0.1, highest_speed_frequency = 1e5;
constexpr double rightmost_from = -200.0;  ///< [1/s] roots are looked for right of this line

std::optional<double> at_any_speed(const DelayEquation& equation) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < speed_frequencies; ++i) {
    const double omega = lowest_speed_frequency * std::pow(highest_speed_frequency / lowest_speed_frequency,
                                                           static_cast<double>(i) / (speed_frequencies - 1));
    const Complex s(0.0, omega);
    const Complex fed_back = times(equation.q()(s), equation.delayed(s));
    const double closed = std::abs(fed_back / (equation.p()(s) + fed_back));
    least = std::min(least, 1.0 / (omega * std::max(closed, 1e-300)));
  }
  return least;
}

}  // namespace

VaryingDelay varying_delay(const DelayEquation& equation, const Margins& margins, double lowest, double highest) {
  VaryingDelay result;
  result.lowest = lowest;
  result.highest = highest;
  result.stable =
      std::any_of(margins.stable_delays.begin(), margins.stable_delays.end(), [&](const StableRange& range) {
        return range.from <= lowest && (range.to >= highest || range.to >= longest_delay);
      });
  DelayEquation at = equation;
  double right = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < delays; ++i) {
    const double delay = lowest + (highest - lowest) * i / (delays - 1);
    at.set_delay(delay);
    const Complex root = characteristic_roots(at, rightmost_from).rightmost();
    if (root.real() <= right) continue;
    right = root.real();
    result.worst_root = root;
    result.worst_delay = delay;
  }
  at.set_delay(lowest);
  const bool begins_stable =
      std::any_of(margins.stable_delays.begin(), margins.stable_delays.end(),
                  [&](const StableRange& range) { return range.from <= lowest && range.to > lowest; });
  if (begins_stable) result.at_any_speed = at_any_speed(at);
  return result;
}

}  // namespace host_sim::stability
