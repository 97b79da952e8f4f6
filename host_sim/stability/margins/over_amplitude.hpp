// The loop at the amplitude of an oscillation: describing functions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/stability/roots/delay_equation.hpp"

namespace host_sim::stability {

/// What a nonlinear force is to the first harmonic of a motion x = A sin φ, ẋ = A ω cos φ:
///
///   (1)  k(A, ω) = 1/(π A) ∮ f sin φ dφ,   c(A, ω) = 1/(π A ω) ∮ f cos φ dφ
///
/// Higher harmonics of f are left out; the masses let little of them through, which is the method's assumption.
/// Source: Gelb and Vander Velde, Multiple-input describing functions, 1968, 2.2.
struct EquivalentForce {
  double stiffness{};  ///< k [N/m]
  double damping{};    ///< c [N s/m]
};

/// The rig with (1) in place of its nonlinear forces, at the amplitude A [m] of the deflection dz_b and ω [rad/s]: laws
/// of suspension and tyre, dry friction, and the effects that are a force over dz_b, ḋz_b or dz_w. Maxwell branches are
/// exact at ω. Everything else stays, and is linearised at rest (linear_part). The tyre moves with
///
///   (2)  dz_w/dz_b = −1/(1 + (m_w s² + b_t s + k_t)/(m_b s²)),  s = jω
///
/// which follows from the equations of motion of both masses on a foot point at rest.
struct EquivalentRig {
  model::RigParameters<double> rig;
  EquivalentForce suspension{}, tyre{};  ///< what was added
};
/// `share` of the forces acts.
[[nodiscard]] EquivalentRig equivalent_rig(const model::RigParameters<double>& rig, double amplitude, double omega,
                                           double share = 1.0);

/// The loop that oscillates with one amplitude.
struct AtAmplitude {
  double amplitude{};                      ///< A [m]
  double omega{};                          ///< [rad/s] of (1), and the imaginary part of the root
  EquivalentForce suspension{}, tyre{};    ///< (1)
  Complex root;                            ///< of the oscillation that decays slowest or grows fastest [1/s]
  std::optional<double> critical_delay{};  ///< without the hold [s]

  [[nodiscard]] bool stable() const { return root.real() < 0.0; }
};

/// An amplitude at which the loop neither grows nor decays. Where smaller oscillations grow and larger ones decay, the
/// rig ends up there; where smaller ones decay and larger ones grow, it must not be pushed beyond.
struct LimitCycle {
  AtAmplitude at;
  bool attracts{};
};

struct OverAmplitude {
  std::vector<AtAmplitude> rows;  ///< ascending
  std::vector<LimitCycle> limit_cycles;
  std::vector<std::string> left_out;  ///< what has no describing function here and no linear part
};

inline constexpr std::size_t amplitudes = 13;  ///< from a hundredth to the whole, by equal ratios: six per decade

/// From `largest`/100 to `largest` [m], of the loop that runs: half a step of hold is part of its delay, and the
/// critical delays are what machine and budget may have beside it. Each oscillation is a root s of the loop that its
/// own frequency ω = Im s makes by (1). They are followed from amplitude to amplitude, so that a row does not jump
/// between them; those that come from elsewhere are looked for among all roots. Throws InputError for a rig that is no
/// loop, or where (1) makes one impossible.
[[nodiscard]] OverAmplitude over_amplitude(const firmware::RigDescription& description, double largest);

}  // namespace host_sim::stability
