// The car of a hil rig, which is a number of the real-time program.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host_sim/diagnose/evidence.hpp"

namespace host_sim::diagnose {

/// A value with its standard error.
struct Estimate {
  double value, error;
};

/// The tolerated parameters of the virtual car (masses, tyre, virtual damping) by least squares over what the program
/// recorded, which carries no sensor noise:
///
///   (1)  m_b z̈_b − b̃ ẋ_cmd = F      (2)  m_w z̈_w + b̃ ẋ_cmd = F_w − F      (3)  k_t dz_w + b_t ḋz_w = F_w
///
/// each where its channels are recorded, in units of its right-hand side's rms; velocities by differences of fourth
/// order; values inside the tolerance.
[[nodiscard]] std::map<std::string, Estimate> virtual_car(const RigDescription& description,
                                                          const std::vector<Evidence>& evidence);

}  // namespace host_sim::diagnose
