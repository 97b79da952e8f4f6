// The compensation of a rig description, ready for the control loop.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "firmware/description/rig_description.hpp"
#include "firmware/loop/compensation/compensator.hpp"

namespace firmware {

/// Settings of the described compensator; none: the description has no [compensation]. What is not given follows from
/// the rig, with the effects that diagnose has named:
///
///   delay, lag, frequency, damping_ratio   of the machine's effects; [delay_budget] and the delay of the sensor of F
///                                          are added to the delay
///   coefficients                           inverse_at() the wheel mode, up to the second derivative
///   damping                                (k/ω) sin ωτ at the wheel mode, k of springs and FDVA, τ with half a period
///   component                              springs, damper and [fdva]
///
/// InputError, at the line of the key, where they do not fit each other or the sample rate.
[[nodiscard]] std::optional<compensation::Settings> compensation_settings(const RigDescription& description);

/// The same with another method: what is given for one is given for all.
[[nodiscard]] compensation::Settings compensation_settings(const RigDescription& description, compensation::Kind kind);

/// The compensator of a description; nothing: it has none.
[[nodiscard]] std::unique_ptr<Compensation> compensation_of(const RigDescription& description);

/// Where the wheel load of the undelayed loop has its peak [rad/s], over the linear car, springs, dampers and FDVA:
///
///   (1)  F_w/z_r = T D/(D + T),   T = k_t + b_t s,   D = m_w s² + K m_b s²/(m_b s² + K)
///   (2)  K = i² (k + b s + k_c (s² + r s)/(s² + r s + a)) + b̃ s + F₀ di/dd,   a = n k_c/(I A_p²),   r = R/I
///
/// An undercompensated loop rings there. No libm function: the same bits on every machine.
[[nodiscard]] double wheel_mode(const model::RigParameters<double>& rig);

/// InputError for a description with [compensation]: `command` computes with a loop without one.
void refuse_compensation(const RigDescription& description, std::string_view command);

}  // namespace firmware
