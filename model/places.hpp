// The places of a rig where effects act, as the effects see them.
#pragma once

namespace model {

/// Path of the test machine x_cmd → x_act. An effect sets what it is; zero means ideal.
template <class S>
struct MachinePath {
  S delay{};  ///< τ [s]
};

/// What acts parallel to spring, damper and FDVA of the suspension component, beside laws with `suspension_force`.
template <class S>
struct SuspensionComponent {
  S stiffness{};     ///< k_b [N/m]
  S damping{};       ///< b_b [N s/m]
  S dry_friction{};  ///< F_r [N], Coulomb
};

/// Piston of the FDVA.
template <class S>
struct Piston {
  S dry_friction{};  ///< [N], Coulomb, against the piston's own travel
};

/// Guides of body and wheel.
template <class S>
struct Guides {
  S body_damping{};        ///< c_b [N s/m]
  S wheel_damping{};       ///< c_w [N s/m]
  S body_dry_friction{};   ///< [N], Coulomb
  S wheel_dry_friction{};  ///< [N], Coulomb
};

/// Sensor of the wheel load.
template <class S>
struct WheelLoadSensor {
  S mass_beyond{};  ///< mass between force sensor and wheel spring [kg]
};

}  // namespace model
