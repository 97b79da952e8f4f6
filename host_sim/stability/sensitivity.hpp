// What each parameter does to a root.
#pragma once

#include <functional>
#include <string>
#include <vector>

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
  Complex root_change;             ///< p ds/dp [1/s]
  double critical_delay_change{};  ///< p dτ_c/dp [s]
  double error{};                  ///< of (1), relative
};

/// \param extra_delay     what the loop delay holds beside the rig's own effects [s]
/// \param root            a simple root at the given delay
/// \param critical_delay  and `critical_omega`: a border, or 0 for none
[[nodiscard]] std::vector<ParameterSensitivity> sensitivities(const model::RigParameters<double>& rig,
                                                              double extra_delay, Complex root, double critical_delay,
                                                              double critical_omega);

/// Paths of all real parameters of this rig, those of its effects included.
[[nodiscard]] std::vector<std::string> real_parameters(const model::RigParameters<double>& rig);

}  // namespace host_sim::stability
