// The parameters of an air spring.
#pragma once

namespace model {

/// The table [air_spring] of a rig description. Zero means absent where the text says so.
template <class S, bool room>
struct AirSpringParameters {
  bool fitted = false;
  S pressure{};                ///< p₀ − p_a at rest [Pa], gauge
  S ambient_pressure{101325};  ///< p_a [Pa]
  S area{};                    ///< A at rest [m²]
  S volume{};                  ///< V at rest [m³]
  S area_per_stroke{};         ///< ∂A/∂s [m]
  S volume_per_area{};         ///< ∂V/∂u [m³]
  S polytropic_exponent{1.4};  ///< κ
  S heat_time{2.0};            ///< T [s]
  S counter_pressure{};        ///< second bellows: gauge, at rest [Pa]; zero: single bellows
  S counter_area{};            ///< [m²]
  S counter_volume{};          ///< [m³]
  S actuator_frequency{5.0};   ///< f_a [Hz]; zero: the area is fixed
  S actuator_damping{};        ///< ζ of second order; zero: first order
  S actuator_rate{};           ///< highest |u̇| [1/s]; zero: none
  S actuator_stroke{0.1};      ///< highest |u|
  S skyhook{};                 ///< c_sky [N s/m]; zero: the area stays
  S levelling_rate{};          ///< highest |ṁ|/m₀ [1/s]; zero: no levelling
  S levelling_band{2e-3};      ///< z_l: deflection that is left alone [m]
  S levelling_time{5.0};       ///< T_l: the levelling sees the deflection through a lag [s]
};

/// Where there is no room for an air spring.
template <class S>
struct AirSpringParameters<S, false> {
  static constexpr bool fitted = false;
};

}  // namespace model
