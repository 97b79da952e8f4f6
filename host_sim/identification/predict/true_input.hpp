// The input of a recording as it was before the sensor that recorded it.
#pragma once

#include <optional>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/predict/hypothesis.hpp"

namespace host_sim::identification {

/// true: the signal before a sensor with this effect can be computed from its samples: gain, lag, delay, and a hold
/// whose renewals the recording shows. false: a limit has lost a part of it, and an offset changes nothing that is
/// compared.
[[nodiscard]] bool can_be_undone(const firmware::CatalogueEntry& effect, const PreparedRecording& recording,
                                 model::Channel channel);

/// A rig is moved by the true input u; its sensor gave y, and the hypothesis says with which effects
/// (model/components/sensors.hpp, in their order gain g, lag T, delay τ, hold). So
///
///   (0)  y(t) between renewals of a hold  by before_hold() (prepare/sample_hold.hpp)
///   (1)  v(t) = y(t + τ)                  on a polynomial of fifth order between samples
///   (2)  u = (v + T v̇)/g,  also of velocity and acceleration; the last with differences over two samples
///
/// `start` was estimated for the input y: position and velocity of wheel and body begin by u(0) − y(0) higher.
/// nullopt: the sensor is as described, or the input has none of its own (PreparedRecording::input_sensor).
struct TrueInput {
  SimulationInput input;
  InitialState start;
};
[[nodiscard]] std::optional<TrueInput> true_input(const Hypothesis& hypothesis, const PreparedRecording& recording,
                                                  const SimulationInput& input, const InitialState& start);

}  // namespace host_sim::identification
