// What each parameter does to a root.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/stability/delay_equation.hpp"
#include "host_sim/stability/linear_rig.hpp"

namespace host_sim::stability {

/// Change of a root s = σ + jω, and of the critical delay, with one parameter; × p: per relative change.
///
///   (1)  ds/dp = −(∂f/∂p)/(∂f/∂s)                              at a fixed root of f(s; p) = P + Q e^{−sτ}
///   (2)  ∂f/∂s j dω + ∂f/∂τ dτ + ∂f/∂p dp = 0                  on the border, σ = 0
///
/// ∂f/∂p goes through the model's equations: central differences of linearise() with two steps, extrapolated; `error`
/// is what the extrapolation changed, relative to the largest of the derivatives.
struct ParameterSensitivity {
  std::string path;                ///< as in rig descriptions; "loop delay": τ itself
  double value{};                  ///< p
  Complex root_change;             ///< p ds/dp of the rightmost root [1/s]
  Complex critical_root_change;    ///< p ds/dp of the critical root [1/s]
  double critical_delay_change{};  ///< p dτ_c/dp [s]
  double error{};                  ///< of (1), relative
};

/// \param extra_delay     what the loop delay holds beside the rig's own effects [s]
/// \param root            the rightmost root at the given delay, simple
/// \param critical_root   the critical root at the given delay, simple
/// \param critical_delay  and `critical_omega`: a border, or 0 for none
[[nodiscard]] std::vector<ParameterSensitivity> sensitivities(const model::RigParameters<double>& rig,
                                                              double extra_delay, Complex root, Complex critical_root,
                                                              double critical_delay, double critical_omega);

/// The critical root: where the root that stands at j `omega` on the border, τ = f.delay(), is at `delay` [s]. It is
/// followed in steps that move it by 1 1/s at most, each finished by Newton. Nothing where it gets lost: it meets
/// another root, or leaves to the left of `line` [1/s] on the way to no delay.
[[nodiscard]] std::optional<Complex> critical_root(DelayEquation f, double omega, double delay, double line);

/// Paths of all real parameters of this rig, those of its effects included.
[[nodiscard]] std::vector<std::string> real_parameters(const model::RigParameters<double>& rig);

}  // namespace host_sim::stability
