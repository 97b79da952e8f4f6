// What the model answers to a recording's own input.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "host_sim/recording.hpp"
#include "host_sim/rig_description.hpp"
#include "host_sim/road.hpp"
#include "model/rig_model.hpp"

namespace host_sim {

/// The input that a recording holds, ready for the model: worked out once, used for every simulation.
///
///   quarter_car, hil     foot point z_r, and F_act where recorded
///   component_bench      command x_cmd; x_act where there is no x_cmd, the machine is then left out of the model
///
/// Between samples z_r and x move on cubic Hermite polynomials whose velocities are differences of fourth order. z̈_r,
/// which only sensors with inertia see, is the recorded zdd_r; without it second differences of z_r, which multiply the
/// noise of z_r by 2.7/h².
struct Drive {
  double period = 0.0;                           ///< [s]
  FootPointMotion motion;                        ///< foot point or command
  std::vector<double> actuator_force;            ///< F_act [N]; empty: none
  std::vector<model::OpenDucts> ducts;           ///< in force from each sample on; empty: as in the rig description
  bool deflection_reached = false;               ///< motion is x_act
  model::Channel channel = model::Channel::z_r;  ///< that the motion comes from

  [[nodiscard]] std::size_t size() const { return motion.size(); }
};

/// InputError when the recording does not hold the input of this kind of rig.
[[nodiscard]] Drive drive_of(const model::RigParameters<double>& rig, const Recording& recording);

/// The channels that the model answers with: all of the kind but those of its input.
[[nodiscard]] std::vector<model::Channel> response_channels(model::RigKind kind, const Drive& drive);

/// z_w, ż_w, z_b, ż_b, y, ẏ
using InitialState = model::Column<double, 6>;

/// At rest above the first sample of the input.
[[nodiscard]] InitialState resting(const model::RigParameters<double>& rig, const Drive& drive);

/// Simulated channels, by model::Channel; those that the rig does not have stay empty. `samples`: 0 for all. `parts`:
/// steps a sample, with the input between samples as the model has it: laws with corners act at their own instant then,
/// not at the next sample; 1 is what a controller runs.
using Response = std::array<std::vector<double>, model::channel_count>;
[[nodiscard]] Response respond(const model::RigParameters<double>& rig, const Drive& drive, const InitialState& start,
                               std::size_t samples = 0, int parts = 1);

/// Whether the recording begins quietly: its first samples stay within 5 % of each channel's rms of where a resting rig
/// would be.
[[nodiscard]] bool begins_at_rest(const model::RigParameters<double>& rig, const Drive& drive,
                                  const Recording& recording);

/// State at the first sample that fits the recording's first seconds best: least squares over the samples that are
/// inside their measuring range, each channel weighted by its own rms. The response is nearly linear in the state: two
/// Gauss–Newton steps.
[[nodiscard]] InitialState estimated_start(const model::RigParameters<double>& rig, const Drive& drive,
                                           const Recording& recording, const MeasuringRanges& range = {});

}  // namespace host_sim
