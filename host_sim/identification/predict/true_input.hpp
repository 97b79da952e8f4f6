// The input of a recording as it was before the sensor that recorded it.
#pragma once

#include <optional>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/predict/hypothesis.hpp"

namespace host_sim::identification {

/// Whether an effect of a sensor leaves what it read to be found from what it shows: not one that cuts off or holds,
/// nor an offset, which moves nothing that is compared.
[[nodiscard]] bool can_be_undone(const firmware::CatalogueEntry& effect, model::Channel channel);

/// A rig is moved by the true input u; its sensor gave y, and the hypothesis says with which effects
/// (model/sensors.hpp, in their order gain g, lag T, delay τ). So
///
///   (1)  v(t) = y(t + τ)                  on a polynomial of fifth order between samples
///   (2)  u = (v + T v̇)/g,  also of velocity and acceleration; the last with differences over two samples
///
/// and a car that was estimated to begin with some motion of y begins with as much of u more as u(0) is more than y(0).
/// nullopt: the sensor is as described, or the input has none of its own (PreparedRecording::input_sensor).
struct TrueInput {
  SimulationInput input;
  InitialState start;
};
[[nodiscard]] std::optional<TrueInput> true_input(const model::RigParameters<double>& rig,
                                                  const PreparedRecording& recording, const SimulationInput& input,
                                                  const InitialState& start);

}  // namespace host_sim::identification
