// The subsystems of a rig as values that effects change.
#pragma once

namespace model {

/// Path of the test machine x_cmd → delay → lag → resonance → rate limit → x_act, of a quarter car z_cmd → … → z_r. An
/// effect sets its own values; zero means ideal.
template <class S>
struct MachinePath {
  S delay{};                ///< τ [s]
  S lag{};                  ///< T [s]
  S resonance_frequency{};  ///< f [Hz]
  S resonance_damping{};    ///< ζ [1]
  S rate_limit{};           ///< highest |ẋ_act| [m/s]
};

/// The suspension component: top mount → free play → spring, damper, friction, relaxation, FDVA and the laws with
/// `suspension_force` in parallel. Zero means absent.
template <class S>
struct SuspensionComponent {
  S stiffness{};           ///< k_b [N/m]
  S damping{};             ///< b_b [N s/m]
  S dry_friction{};        ///< F_r [N], Coulomb
  S relaxing_stiffness{};  ///< k_r [N/m]
  S relaxation_time{};     ///< T [s]
  S mount_stiffness{};     ///< k_m [N/m]; zero: rigid
  S free_play{};           ///< g [m]
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

/// Load cell of a test machine, which measures F.
template <class S>
struct LoadCell {
  S moving_mass{};  ///< mass that moves between load cell and component [kg]
};

/// Sensor of the wheel load.
template <class S>
struct WheelLoadSensor {
  S mass_beyond{};  ///< mass between force sensor and wheel spring [kg]
};

/// The air spring: what is not as its parameters say. `AirSpring` has the equations.
template <class S>
struct AirSpringCondition {
  S polytropic_exponent{};  ///< κ
  S leak{};                 ///< ṁ/m₀ out of the first bellows at p₀ [1/s]
  bool stuck = false;       ///< the area does not follow its command
  S stuck_at{};             ///< u [1], where it stays then
};

/// A channel's sensor: gain and offset, then, on signal plus noise, lag → delay → limit → hold.
template <class S>
struct SensorPath {
  S gain{1};   ///< [1]
  S offset{};  ///< [unit of the channel]
  S lag{};     ///< T [s]
  S delay{};   ///< τ [s]
  S limit{};   ///< [unit of the channel]; zero: none
  S hold{};    ///< T_h [s]; zero: none
};

}  // namespace model
