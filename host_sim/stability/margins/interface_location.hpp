// Where a rig is cut into hardware and program, and what that does to its stability.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "host_sim/stability/roots/linear_rig.hpp"

namespace host_sim::stability {

/// The part of the quarter car that is hardware.
enum class InterfaceLocation : unsigned char {
  component,            ///< the suspension component, deflected by the test machine
  component_and_wheel,  ///< and the wheel mass: a machine moves the body's end, a cylinder in force control is the tyre
  below_body,           ///< everything below the body: a machine moves the body's end, a cylinder is the road
};
inline constexpr std::array<std::string_view, 3> interface_names{"component", "component_and_wheel", "below_body"};

/// Characteristic equation with every interface late by τ, e = e^{−sτ}:
///
///   (1)  P + Q e + R e² = 0
///
///   component            P, Q of LinearRig, R = 0: with virtual damping, with lags of machine and sensor
///   component_and_wheel  (m_w s² + K + e Z)(m_b s² + e K) − e K² = 0      both interfaces are late, hence e²
///   below_body           m_b s² + e K (m_w s² + Z)/(m_w s² + Z + K) = 0
///
/// K: component, Z = k_t + b_t s. Virtual damping needs wheel and body in the program: the first location only. The
/// road's cylinder is outside of the loop. Source of the question: Terkovics, Neild, Lowenberg, Szalai and Krauskopf,
/// Substructurability: the effect of interface location on a real-time dynamic substructuring test, Proc. R. Soc. A
/// 2016.
struct LocatedLoop {
  Polynomial p, q, r;
};
/// `factor`: on the force of the component.
[[nodiscard]] LocatedLoop located_loop(const model::RigParameters<double>& rig, InterfaceLocation location,
                                       double factor = 1.0);

/// The smallest delay with a root of (1) on the axis [s] and its frequency [rad/s].
struct LocatedBorder {
  bool stable_undelayed{};
  std::optional<double> critical_delay;  ///< none up to longest_delay
  double omega{};
};
[[nodiscard]] LocatedBorder border_of(const LocatedLoop& loop);

/// One location: its border, and the critical delay over the size of the component's force.
struct LocationMap {
  InterfaceLocation location{};
  LocatedBorder given;
  std::vector<LocatedBorder> borders;  ///< one for each of component_factors
};

/// The component's force times these: how a stiffer component moves the border.
inline constexpr std::array<double, 7> component_factors{0.25, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0};

/// All three locations.
[[nodiscard]] std::vector<LocationMap> compare_locations(const model::RigParameters<double>& rig);

}  // namespace host_sim::stability
