// What each compensator takes a described rig for.
#pragma once

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/compensation/settings.hpp"

namespace host_sim::compensation {

/// The settings of a method that follow from a rig description with the effects that diagnose has named:
///
///   machine     delay, lag and resonance of the effects; the delay of the sensor of F and [delay_budget] sensor_age
///   and
///               transport are added to the delay
///   damping     (k/ω) sin ωτ at the wheel's mode, k of springs and FDVA, τ with half a period of
///   hold component   [suspension] and [fdva]
///
/// InputError where they do not fit each other or the sample rate.
[[nodiscard]] firmware::compensation::Settings method_settings(const firmware::RigDescription& description,
                                                               firmware::compensation::Kind kind);

/// The rig with an ideal machine and ideal sensors.
[[nodiscard]] model::RigParameters<double> without_delay(model::RigParameters<double> rig);

/// Where the wheel load of the undelayed loop has its peak [rad/s]: the frequency at which an undercompensated loop
/// rings. On a rig it is read off a recording.
[[nodiscard]] double wheel_mode(const model::RigParameters<double>& rig);

/// Coefficients of the inverse that are exact at rest and at ω, where the series is cut:
///
///   a₀ + j a₁ ω − a₂ ω² = 1/M(jω),   a₀ = 1
///
/// The time series arrives at them where one mode dominates the motion.
[[nodiscard]] firmware::compensation::Coefficients inverse_at(const model::MachinePath<double>& machine, double omega);

}  // namespace host_sim::compensation
