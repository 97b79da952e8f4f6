// The phase of the loop against the trigger of its converters.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "hal/clock.hpp"
#include "hal/sensor_source.hpp"
#include "hal/time.hpp"

namespace firmware::controller {

/// When the periods of a loop begin, so that the converters' samples have the same age at every start:
///
///   (1)  t_k = t_s + a + (n + k) T,   t_s the stamp of a sample, a the wanted age, T the period
struct SamplePhase {
  hal::Time stamp;   ///< t_s
  hal::Time age;     ///< a
  hal::Time period;  ///< T

  /// The first instant (1) that is not before `now`.
  [[nodiscard]] hal::Time next(hal::Time now) const;
};

/// The age for which the loop waits where the description does not say: conversion, interrupt and driver take less on a
/// kernel with real-time preemption (0.1 ms and below), and three quarters of the period are left before the sample
/// after it comes. Half: a slow bus delivers some samples late, which are then a period old. Twice: half a period of
/// delay.
inline constexpr double usual_share_of_period = 0.25;

/// Reads the channels for 64 periods and takes the median phase of their stamps. nullopt: samples do not come once a
/// period (the middle four fifths of the phases scatter by more than a quarter of it), or there are none. Then no phase
/// can be kept. Sleeps on the rig's clock.
[[nodiscard]] std::optional<SamplePhase> measured_phase(hal::Clock& clock, hal::SensorSource& sensors,
                                                        std::span<const std::size_t> channels, hal::Time period,
                                                        hal::Time age);

}  // namespace firmware::controller
