#include "host_sim/stability/margins/interface_location.hpp"

#include <algorithm>
#include <cmath>

#include "host_sim/stability/margins/crossings.hpp"

namespace host_sim::stability {
namespace {

constexpr double full_turn_of_phase = 6.283185307179586;
/// Frequencies at which |e| is compared with 1, evenly by logarithm. Half: two crossings nearer than 1 % to each other
/// are missed. Twice: twice the time, 10 ms a border.
constexpr int location_frequencies = 3000;
constexpr double lowest_location_frequency = 0.05, highest_location_frequency = 1e5;  ///< [rad/s]

/// The values of e that solve (1) at s = jω: two, or one where R = 0.
std::vector<Complex> exponentials(const LocatedLoop& loop, double omega) {
  const Complex s(0.0, omega);
  const Complex p = loop.p(s), q = loop.q(s), r = loop.r(s);
  if (std::abs(r) <= 1e-14 * std::abs(q)) return {-p / q};
  const Complex root = std::sqrt(q * q - 4.0 * p * r);
  const Complex larger = std::abs(q + root) > std::abs(q - root) ? -(q + root) : -(q - root);
  Complex first = larger / (2.0 * r), second = 2.0 * p / larger;  // without cancellation
  return {first, second};
}

/// The excess of |e| over 1, the solutions sorted by size: continuous in ω.
double excess(const LocatedLoop& loop, double omega, std::size_t which) {
  std::vector<Complex> e = exponentials(loop, omega);
  std::sort(e.begin(), e.end(), [](Complex a, Complex b) { return std::abs(a) < std::abs(b); });
  return which < e.size() ? std::log(std::abs(e[which])) : 1.0;
}

double frequency(int i) {
  return lowest_location_frequency * std::pow(highest_location_frequency / lowest_location_frequency,
                                              static_cast<double>(i) / (location_frequencies - 1));
}

}  // namespace

LocatedLoop located_loop(const model::RigParameters<double>& rig, InterfaceLocation location, double factor) {
  const LinearRig linear = linearise(rig);
  if (location == InterfaceLocation::component) return {linear.p, factor * linear.q, {}};
  const auto [force, d] = linear.component_response();  // K = k/d
  const Polynomial k = factor * force;
  const Polynomial wheel{0.0, 0.0, rig.wheel.mass}, body{0.0, 0.0, rig.body.mass};
  const Polynomial tyre{rig.tyre.stiffness, rig.tyre.damping};
  if (location == InterfaceLocation::below_body) return {body * ((wheel + tyre) * d + k), k * (wheel + tyre), {}};
  // (m_w s² + K) m_b s² + e (K m_w s² + Z m_b s²) + e² Z K, times d
  return {body * (wheel * d + k), k * wheel + tyre * body * d, tyre * k};
}

LocatedBorder border_of(const LocatedLoop& loop) {
  LocatedBorder border;
  const std::vector<Complex> undelayed = roots(loop.p + loop.q + loop.r);
  border.stable_undelayed = std::all_of(undelayed.begin(), undelayed.end(), [](Complex s) { return s.real() < 0.0; });
  if (!border.stable_undelayed) return border;
  for (std::size_t which = 0; which < 2; ++which) {
    double before = excess(loop, frequency(0), which);
    for (int i = 1; i < location_frequencies; ++i) {
      const double after = excess(loop, frequency(i), which);
      if ((before > 0.0) != (after > 0.0)) {
        double low = frequency(i - 1), high = frequency(i);
        for (int halved = 0; halved < 60; ++halved) {
          const double middle = 0.5 * (low + high);
          ((excess(loop, middle, which) > 0.0) == (before > 0.0) ? low : high) = middle;
        }
        for (const Complex e : exponentials(loop, low)) {
          if (std::abs(std::log(std::abs(e))) > 1e-6) continue;
          double phase = -std::arg(e);
          if (phase <= 0.0) phase += full_turn_of_phase;
          const double delay = phase / low;
          if (delay <= longest_delay && (!border.critical_delay || delay < *border.critical_delay)) {
            border.critical_delay = delay;
            border.omega = low;
          }
        }
      }
      before = after;
    }
  }
  return border;
}

std::vector<LocationMap> compare_locations(const model::RigParameters<double>& rig) {
  std::vector<LocationMap> maps;
  for (std::size_t i = 0; i < interface_names.size(); ++i) {
    LocationMap map;
    map.location = static_cast<InterfaceLocation>(i);
    map.given = border_of(located_loop(rig, map.location));
    for (const double factor : component_factors) {
      map.borders.push_back(border_of(located_loop(rig, map.location, factor)));
    }
    maps.push_back(std::move(map));
  }
  return maps;
}

}  // namespace host_sim::stability
