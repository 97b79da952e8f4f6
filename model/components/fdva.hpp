// Fluid dynamic vibration absorber: oil in ducts as an inertance, in series with a coil spring.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace model {

inline constexpr std::size_t duct_capacity = 6;

/// Which ducts are open: bit j − 1 is duct j.
using OpenDucts = std::uint8_t;

[[nodiscard]] constexpr int count(OpenDucts open) {
  int n = 0;
  for (std::size_t j = 0; j < duct_capacity; ++j) n += (open >> j) & 1;
  return n;
}

/// The first n ducts open.
[[nodiscard]] constexpr OpenDucts first_ducts(int n) { return static_cast<OpenDucts>((1U << n) - 1U); }

/// A piston pushes oil through up to six equal ducts; a coil spring couples the piston to the suspension deflection.
///
///   (6)  F_c = k_c (e − y)                               coil spring in series with the piston, travel y
///   (7)  A_p ẏ = Σ_j q_j                                 oil is incompressible; q_j flow through open duct j
///   (8)  I q̇_j = Δp − R q_j − S q_j |q_j|,  F_c = A_p Δp  each open duct; a closed duct has q_j = 0
///   (9)  I = ρ l/a,  R = 128 ρ ν l/(π d⁴),  S = ρ ΣK/(2 a²),  a = π d²/4
///
/// Summed over n open ducts, with the piston velocity u = ẏ and the deviation δ_j = q_j − A_p u/n of each flow from
/// their mean, (7) and (8) are
///
///   (8a)  u̇   = n/(I A_p²) F_c − R/I u − S/(I A_p) Σ_j q_j |q_j|
///   (8b)  δ̇_j = −R/I δ_j − S/I (q_j |q_j| − 1/n Σ_i q_i |q_i|)
///
/// so the linear part has two states (y, u) however many ducts are open, and the deviations only decay. With no duct
/// open the piston is locked: u = 0, y stays. The flow of a closing duct ends and its energy ½ I q_j² is lost; an
/// opening duct starts with q_j = 0.
///
/// Leaves out: unsteady laminar friction, turbulent friction, bulk modulus, cavitation, seal friction (an effect).
/// Source: (6)–(9) incompressible one-dimensional duct flow; loss coefficients Idelchik, Handbook of Hydraulic
/// Resistance; (9) Hagen–Poiseuille.
template <class S>
struct Fdva {
  struct Parameters {
    S piston_area;         ///< A_p [m²]
    S duct_diameter;       ///< d [m]
    S duct_length;         ///< l [m]
    S oil_density;         ///< ρ [kg/m³]
    S oil_viscosity;       ///< ν, kinematic [m²/s]
    S minor_loss;          ///< ΣK [1]
    S coupling_stiffness;  ///< k_c [N/m]
    int ducts;             ///< installed [1], 1 … 6
    int open_ducts;        ///< open at the start [1], 0 … ducts
  };

  /// (9) one duct
  struct Duct {
    S inertance;     ///< I [kg/m⁴]
    S laminar_loss;  ///< R [Pa·s/m³]
    S minor_loss;    ///< S [Pa·s²/m⁶]
  };

  [[nodiscard]] static constexpr Duct duct(const Parameters& p) {
    const S pi = S(3.141592653589793);
    const S d2 = p.duct_diameter * p.duct_diameter;
    const S area = pi * d2 / S(4);
    return {p.oil_density * p.duct_length / area,
            S(128) * p.oil_density * p.oil_viscosity * p.duct_length / (pi * d2 * d2),
            p.oil_density * p.minor_loss / (S(2) * area * area)};
  }

  /// (6) [N]
  [[nodiscard]] static constexpr S force(const Parameters& p, S deflection, S travel) {
    return p.coupling_stiffness * (deflection - travel);
  }

  /// (8a) without the minor losses: acceleration of the piston under a net force [m/s²].
  [[nodiscard]] static constexpr S piston_acceleration(const Parameters& p, const Duct& duct, int open, S velocity,
                                                       S net_force) {
    if (open == 0) return S(0);
    return S(open) * net_force / (duct.inertance * p.piston_area * p.piston_area) -
           duct.laminar_loss / duct.inertance * velocity;
  }

  /// The minor losses as they enter (8a): S/(I A_p) Σ q|q| for Σ q|q| = 1 [1/m⁵ · …].
  [[nodiscard]] static constexpr S piston_deceleration_per_loss(const Parameters& p, const Duct& duct) {
    return duct.minor_loss / (duct.inertance * p.piston_area);
  }
};

}  // namespace model
