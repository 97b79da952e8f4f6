// Body and wheel of a quarter car.
#pragma once

#include "model/numerics/motion.hpp"

namespace model {

/// Quarter car on its tyre, above any suspension component.
///
///   (1)  m_b z̈_b = F_s + b̃ (ż_w − ż_b) − c_b ż_b                body
///   (2)  m_w z̈_w = F_w − F_s − b̃ (ż_w − ż_b) − c_w ż_w          wheel
///   (3)  F_w     = k_t (z_r − z_w) + b_t (ż_r − ż_w)             tyre, dynamic wheel load
///   (4)  dz_b    = z_w − z_b,   dz_w = z_r − z_w                 suspension and tyre deflection
///
/// b̃: virtual damping, only in a hardware-in-the-loop rig. c_b, c_w: drag of the guides, zero unless an effect adds it.
/// Forces are dynamic: the static wheel load (m_b + m_w) g is removed; compression is positive.
/// State [z_w m, ż_w m/s, z_b m, ż_b m/s]; inputs foot point and suspension force F_s [N].
/// Leaves out: pitch, roll, the tyre's relaxation length; lift-off and progression of the tyre are effects.
/// Source: (1)–(4) as in the hardware-in-the-loop study of a fluid dynamic vibration absorber, TU Darmstadt.
template <class S>
struct QuarterCar {
  struct Parameters {
    S body_mass;              ///< m_b [kg]
    S wheel_mass;             ///< m_w [kg]
    S tyre_stiffness;         ///< k_t [N/m]
    S tyre_damping;           ///< b_t [N s/m]
    S virtual_damping;        ///< b̃ [N s/m]
    S wheel_guide_damping{};  ///< c_w [N s/m]
    S body_guide_damping{};   ///< c_b [N s/m]
  };
  struct State {
    S z_w, v_w, z_b, v_b;  ///< z_w [m], ż_w [m/s], z_b [m], ż_b [m/s]
  };
  struct Forces {
    S wheel, body;  ///< m_w z̈_w, m_b z̈_b [N]
  };

  static constexpr double gravity = 9.81;  ///< g [m/s²]

  /// (3) without what effects add [N]
  [[nodiscard]] static constexpr S tyre_force(const Parameters& p, const State& x, S z_r, S v_r) {
    return p.tyre_stiffness * (z_r - x.z_w) + p.tyre_damping * (v_r - x.v_w);
  }

  /// Right-hand sides of (1) and (2) [N]
  [[nodiscard]] static constexpr Forces net_forces(const Parameters& p, const State& x, S tyre_force,
                                                   S suspension_force) {
    const S upward = suspension_force + p.virtual_damping * (x.v_w - x.v_b);
    return {tyre_force - upward - p.wheel_guide_damping * x.v_w, upward - p.body_guide_damping * x.v_b};
  }

  /// (m_b + m_w) g [N]
  [[nodiscard]] static constexpr S static_wheel_load(const Parameters& p) {
    return (p.body_mass + p.wheel_mass) * S(gravity);
  }

  /// Kinetic energy and that of the tyre spring [J].
  [[nodiscard]] static constexpr S energy(const Parameters& p, const State& x, S z_r) {
    const S dz_w = z_r - x.z_w;
    return S(0.5) * (p.body_mass * x.v_b * x.v_b + p.wheel_mass * x.v_w * x.v_w + p.tyre_stiffness * dz_w * dz_w);
  }
};

}  // namespace model
