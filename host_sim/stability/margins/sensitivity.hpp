// Derivatives of roots and of the critical delay by the parameters.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/stability/roots/delay_equation.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"

namespace host_sim::stability {

/// Change of a root s = σ + jω and of the critical delay with one parameter, per relative change (multiplied by p).
///
///   (1)  ds/dp = −(∂f/∂p)/(∂f/∂s)                              at a fixed root of f(s; p) = P + Q e^{−sτ}
///   (2)  ∂f/∂s j dω + ∂f/∂τ dτ + ∂f/∂p dp = 0                  on the border, σ = 0
///
/// ∂f/∂p comes from central differences of linearise() with two step sizes and Richardson extrapolation. `error` is the
/// change by the extrapolation, relative to the largest derivative.
struct ParameterSensitivity {
  std::string path;                ///< as in rig descriptions; "loop delay": τ itself
  double value{};                  ///< p
  Complex root_change;             ///< p ds/dp of the rightmost root [1/s]
  Complex critical_root_change;    ///< p ds/dp of the critical root [1/s]
  double critical_delay_change{};  ///< p dτ_c/dp [s]
  double error{};                  ///< of (1), relative
};

/// \param extra_delay     part of the loop delay that is not an effect of the rig [s]
/// \param root            the rightmost root at the given delay, simple
/// \param critical_root   the critical root at the given delay, simple
/// \param critical_delay  and `critical_omega`: a border, or 0 for none
[[nodiscard]] std::vector<ParameterSensitivity> sensitivities(const model::RigParameters<double>& rig,
                                                              double extra_delay, Complex root, Complex critical_root,
                                                              double critical_delay, double critical_omega);

/// The critical root: where the root that stands at j `omega` on the border, τ = f.delay(), is at `delay` [s]. It is
/// followed in steps that move it by at most 1 1/s, each refined by Newton. nullopt if it meets another root or moves
/// left of `line` [1/s] on the way.
[[nodiscard]] std::optional<Complex> critical_root(DelayEquation f, double omega, double delay, double line);

/// Paths of all real parameters of this rig, those of its effects included.
[[nodiscard]] std::vector<std::string> real_parameters(const model::RigParameters<double>& rig);

}  // namespace host_sim::stability
