#include "host_sim/stability/margins/margins.hpp"

#include <cmath>
#include <numbers>

#include "host_sim/stability/margins/affine_family.hpp"

namespace host_sim::stability {

Margins margins(const DelayEquation& equation, bool stable) {
  Margins result;
  const Polynomial& p = equation.p();
  const Polynomial& q = equation.q();
  const double tau = equation.delay();
  result.frequencies = crossing_frequencies(p, q);
  result.stable_delays = stable_ranges(p, q, result.frequencies);
  const std::vector<Crossing> all = crossings(result.frequencies, longest_delay);
  if (!all.empty()) {
    result.critical_delay = all.front().delay;
    result.critical_omega = all.front().omega;
  }
  if (stable) {
    for (const Crossing& c : all) {
      if (c.delay <= tau) continue;
      result.delay_margin = c.delay - tau;
      result.delay_margin_omega = c.omega;
      break;
    }
  } else {  // the nearest edge of a range in which the loop would be stable
    for (const StableRange& range : result.stable_delays) {
      for (const double edge : {range.from, range.to}) {
        const bool real_edge = edge > 0.0 && edge < longest_delay;
        if (real_edge && (!result.delay_margin || std::abs(edge - tau) < std::abs(*result.delay_margin))) {
          result.delay_margin = edge - tau;
        }
      }
    }
    for (const Crossing& c : all) {
      if (result.delay_margin && std::abs(c.delay - tau - *result.delay_margin) < 1e-12) {
        result.delay_margin_omega = c.omega;
      }
    }
  }

  for (const CrossingFrequency& f : result.frequencies) {
    const Complex s(0.0, f.omega);
    const Complex loop = q(s) / p(s) * equation.delayed(s);
    const double margin = std::arg(-loop);  // arg L + π in −π … π
    if (!result.phase_margin || std::abs(margin) < std::abs(*result.phase_margin)) {
      result.phase_margin = margin;
      result.phase_margin_omega = f.omega;
    }
  }

  const AffineFamily gain{p, {}, {}, q};
  constexpr double largest = 100.0;
  for (const AxisValue& value : axis_values(gain, tau, 1.0 / largest, largest)) {
    if (!value.border) continue;
    if (value.value > 1.0 && !result.upper_gain) result.upper_gain = GainMargin{value.value, value.omega};
    if (value.value <= 1.0) result.lower_gain = GainMargin{value.value, value.omega};
  }
  return result;
}

SensitivityPeak sensitivity_peak(const DelayEquation& equation) {
  const auto size = [&](double omega) {
    const Complex s(0.0, omega);
    return std::abs(equation.p()(s) / equation(s));
  };
  SensitivityPeak peak;
  const double ratio = std::pow(10.0, 1.0 / 400.0);
  for (double omega = 1e-2; omega < 1e5; omega *= ratio) {
    if (const double value = size(omega); value > peak.value) peak = {value, omega};
  }
  // Golden section around the highest sample.
  constexpr double golden = std::numbers::phi - 1.0;
  double low = peak.omega / ratio, high = peak.omega * ratio;
  for (int i = 0; i < 60; ++i) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (size(a) > size(b) ? high : low) = size(a) > size(b) ? b : a;
  }
  peak.omega = 0.5 * (low + high);
  peak.value = size(peak.omega);
  return peak;
}

}  // namespace host_sim::stability
