// Delays at which roots cross the imaginary axis, in closed form.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/stability/roots/delay_equation.hpp"

namespace host_sim::stability {

inline constexpr double longest_delay =
    1.0;  ///< largest delay that is analysed [s]; far above any loop that a rig could use

/// A frequency at which a pair of roots ±jω lies on the axis for some delay.
struct CrossingFrequency {
  double omega{};   ///< [rad/s] > 0
  double first{};   ///< smallest such delay [s], in 0 … 2π/ω; the others follow every 2π/ω
  int direction{};  ///< with growing delay +1: to the right, −1: to the left, 0: touches the axis
};

/// A pair of roots on the axis.
struct Crossing {
  double delay{};   ///< [s]
  double omega{};   ///< [rad/s]
  int direction{};  ///< as above
};

/// All ω > 0 with |P(jω)|² = |Q(jω)|², a real polynomial of ω², highest first; e^{−jωτ} = −P/Q gives the delay. The
/// direction is the sign of d/dω² (|P|² − |Q|²), whatever the delay.
/// Source: Cooke and van den Driessche, On zeroes of some transcendental equations, Funkcialaj Ekvacioj 1986.
[[nodiscard]] std::vector<CrossingFrequency> crossing_frequencies(const Polynomial& p, const Polynomial& q);

/// All crossings with delays in 0 … `longest`, by delay.
[[nodiscard]] std::vector<Crossing> crossings(const std::vector<CrossingFrequency>& frequencies, double longest);

/// Number of roots with Re > 0 at `delay`: that at zero delay plus the crossings up to `delay`. nullopt where this
/// count is undefined (a root stays at zero or touches the axis).
[[nodiscard]] std::optional<int> unstable_roots(const Polynomial& p, const Polynomial& q,
                                                const std::vector<CrossingFrequency>& frequencies, double delay);

/// Number of roots of a polynomial with Re > 0.
[[nodiscard]] int unstable_roots(const Polynomial& p);

/// A delay range in which the loop is stable [s].
struct StableRange {
  double from{}, to{};
};
/// Within 0 … longest_delay.
[[nodiscard]] std::vector<StableRange> stable_ranges(const Polynomial& p, const Polynomial& q,
                                                     const std::vector<CrossingFrequency>& frequencies);

/// Critical delay with a Padé approximation in place of the delay.
///
///   e^{−sτ} ≈ D(−sτ)/D(sτ),   D(x) = Σ_k (2n−k)! n! / ((2n)! k! (n−k)!) x^k,   order n
///
/// The approximation has modulus 1 on the axis, so roots cross at the same frequencies, with 2 arg D(jωτ) in place of
/// ωτ.
struct PadeResult {
  int order{};
  std::optional<double> critical_delay;  ///< [s]; none up to longest_delay
  double omega{};                        ///< [rad/s] of that crossing
  std::optional<double> error;           ///< relative to the exact critical delay
  bool unsafe{};                         ///< overestimates the critical delay
};
[[nodiscard]] PadeResult pade_critical_delay(int order, const std::vector<CrossingFrequency>& frequencies,
                                             std::optional<double> exact);

/// D of order n.
[[nodiscard]] Polynomial pade_denominator(int order);

}  // namespace host_sim::stability
