// The car of a hil rig, which is a number of the real-time program.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "host_sim/catalogue.hpp"
#include "host_sim/diagnose/evidence.hpp"

namespace host_sim::diagnose {

/// A value with its standard error.
struct Estimate {
  double value, error;
};

/// An effect of the virtual tyre, and what it does to the error of F_w, relative to its rms.
struct TyreEffect {
  PlacedEffect effect;
  std::vector<Estimate> parameters;
  double before = 0.0, after = 0.0;
};

/// What is found of the virtual car.
struct VirtualCar {
  std::map<std::string, Estimate> parameters;  ///< tolerated ones, by path
  std::vector<TyreEffect> effects;
};

/// The tolerated parameters of the virtual car (masses, tyre, virtual damping) by least squares over what the program
/// recorded, which carries no sensor noise:
///
///   (1)  m_b z̈_b − b̃ ẋ_cmd = F      (2)  m_w z̈_w + b̃ ẋ_cmd = F_w − F      (3)  k_t dz_w + b_t ḋz_w = F_w
///
/// with b̃ the virtual damping; each where its channels are recorded, in units of its right-hand side's rms; velocities
/// by differences of fourth order; values inside the tolerance. Effects of the tyre, which is a number too, show in (3)
/// alone: k₃ dz_w³ where it takes away half the power of what is left and moves F_w by a thousandth at least; lift-off
/// where the lowest F_w is repeated exactly near the static load.
[[nodiscard]] VirtualCar virtual_car(const RigDescription& description, const std::vector<Evidence>& evidence);

}  // namespace host_sim::diagnose
