#include "host_sim/stability/margins/sampled_margins.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace host_sim::stability {
namespace {

/// The loop's response is looked at from here to half the sample rate, at so many frequencies, evenly by logarithm.
/// Half: a crossing between two frequencies that lie closer than 0.2 % may be missed.
constexpr double lowest_frequency = 0.1;  ///< [rad/s]
constexpr int frequencies_looked_at = 6000;
constexpr double largest_factor = 100.0;
/// Delays of a range; a loop with more states is looked at on its ends and in the middle, an eigenvalue problem of 120
/// states takes 20 ms.
constexpr int delays_of_range = 33;
constexpr std::size_t most_states_over_range = 120;

/// Where `value` changes its sign between two frequencies.
template <class Value>
double root_between(const Value& value, double low, double high) {
  const bool above = value(low) > 0.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (low + high);
    ((value(middle) > 0.0) == above ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

SampledMargins sampled_margins(const StepMatrix& step, double period, bool stable) {
  const LoopResponse loop(step, period);
  SampledMargins result;
  const double top = std::numbers::pi / period;
  const auto frequency = [&](int i) {
    return lowest_frequency * std::pow(top / lowest_frequency, static_cast<double>(i) / (frequencies_looked_at - 1));
  };
  const auto take_gain = [&](double omega) {
    const double real = loop(omega).real();
    if (!(real < 0.0)) return;
    const double factor = -1.0 / real;
    if (factor > largest_factor || factor < 1.0 / largest_factor) return;
    if (factor > 1.0 && (!result.upper_gain || factor < result.upper_gain->factor)) {
      result.upper_gain = GainMargin{factor, omega};
    }
    if (factor <= 1.0 && (!result.lower_gain || factor > result.lower_gain->factor)) {
      result.lower_gain = GainMargin{factor, omega};
    }
  };
  const auto take_phase = [&](double omega) {
    const double margin = std::arg(-loop(omega));
    if (result.phase_margin && std::abs(margin) >= std::abs(*result.phase_margin)) return;
    result.phase_margin = margin;
    result.phase_margin_omega = omega;
  };
  double before = frequency(0);
  Complex at_before = loop(before);
  for (int i = 0; i < frequencies_looked_at; ++i) {
    const double omega = frequency(i);
    const Complex at = loop(omega);
    if (const double size = 1.0 / std::abs(1.0 + at); size > result.sensitivity.value) {
      result.sensitivity = {size, omega};
    }
    if (stable && i > 0) {
      if ((at.imag() > 0.0) != (at_before.imag() > 0.0)) {
        take_gain(root_between([&](double w) { return loop(w).imag(); }, before, omega));
      }
      if ((std::abs(at) > 1.0) != (std::abs(at_before) > 1.0)) {
        take_phase(root_between([&](double w) { return std::abs(loop(w)) - 1.0; }, before, omega));
      }
    }
    before = omega;
    at_before = at;
  }
  if (stable) take_gain(top);
  return result;
}

std::optional<DampingBorder> sampled_damping_border(const model::RigParameters<double>& rig, double period,
                                                    double delay, const DampingBorder& start) {
  const auto step_at = [&](double damping) {
    model::RigParameters<double> at = rig;
    at.machine.virtual_damping = damping;
    return step_matrix(at, period, delay);
  };
  Complex lambda = std::polar(1.0, start.omega * period);
  const auto found = value_on_circle(step_at, start.value, std::max(1e-3 * start.value, 0.1), period, lambda);
  if (!found || *found < 0.0) return std::nullopt;
  return DampingBorder{*found, std::arg(lambda) / period};
}

SampledOverDelays sampled_over_delays(const model::RigParameters<double>& rig, double period, double lowest,
                                      double highest) {
  SampledOverDelays result;
  result.stable = true;
  const auto states = static_cast<std::size_t>(step_matrix(rig, period, highest).matrix.rows());
  const int delays = states > most_states_over_range ? 3 : delays_of_range;
  for (int i = 0; i < delays; ++i) {
    const double delay = lowest + (highest - lowest) * i / (delays - 1);
    const double radius = spectral_radius(step_matrix(rig, period, delay));
    result.stable = result.stable && radius < 1.0;
    if (radius > result.worst_radius) {
      result.worst_radius = radius;
      result.worst_delay = delay;
    }
  }
  const StepMatrix first = step_matrix(rig, period, lowest);
  if (!(spectral_radius(first) < 1.0)) return result;
  const LoopResponse loop(first, period);
  double least = HUGE_VAL;
  const double top = std::numbers::pi / period;
  for (int i = 0; i < frequencies_looked_at; ++i) {
    const double omega =
        lowest_frequency * std::pow(top / lowest_frequency, static_cast<double>(i) / (frequencies_looked_at - 1));
    const Complex at = loop(omega);
    least = std::min(least, 1.0 / (omega * std::max(std::abs(at / (1.0 + at)), 1e-300)));
  }
  result.at_any_speed = least;
  return result;
}

}  // namespace host_sim::stability
