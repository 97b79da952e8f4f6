// What a rig's sensors make of simulated channels.
#pragma once

#include <vector>

#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/diagnose/hypothesis.hpp"

namespace host_sim::diagnose {

/// Whether something in a rig acts from an instant on that depends on the motion: dry friction, free play, a stop, a
/// limit.
[[nodiscard]] bool has_corners(const model::RigParameters<double>& rig);

/// With how many steps a sample a rig with corners is simulated: `Evidence::fine`, or half as many, which are as good
/// for a difference of two.
enum class Steps : unsigned char { fine, half };

/// Channels of the evidence before their sensors: the rig's own answer, at full rate. `drive`: that of the evidence, or
/// one that differs from it by noise.
[[nodiscard]] Response true_channels(const model::RigParameters<double>& rig, const Evidence& evidence,
                                     const Drive& drive, const InitialState& start, std::size_t samples = 0,
                                     Steps steps = Steps::fine);

/// Whether something acts between a channel and what is read of it.
[[nodiscard]] bool has_sensor_effect(const model::RigParameters<double>& rig, model::Channel channel);

/// Readings of one channel from its true values, by the model's own Sensors. A held channel is renewed where the
/// recording shows that it was: the phase of a hold is nobody's parameter.
[[nodiscard]] std::vector<double> readings(const Hypothesis& hypothesis, const Evidence& evidence,
                                           model::Channel channel, const std::vector<double>& truth);

/// true_channels() as they are read.
[[nodiscard]] Response read_channels(const Hypothesis& hypothesis, const Evidence& evidence, const Drive& drive,
                                     const InitialState& start, std::size_t samples = 0);

}  // namespace host_sim::diagnose
