// The rig that exists only in the computer, as the simulated hal back-end meets it.
#pragma once

#include <array>
#include <cstdint>

#include "hal/simulated/plant.hpp"
#include "host_sim/gaussian.hpp"
#include "host_sim/rig_description.hpp"
#include "model/rig_model.hpp"

namespace host_sim {

/// Plant of a simulated run: the rig's model (hil: machine and component; the car is the firmware's), its sensors with
/// the noise of the rig description, cut off at the measuring ranges.
///
/// Noise is normal, independent from sample to sample, one draw a noisy channel and instant in the order of the
/// channels; `seed` is that of the run.
class SimulatedRig final : public hal::simulated::Plant {
 public:
  enum class Noise : bool { none, as_described };

  SimulatedRig(const RigDescription& description, std::uint64_t seed, Noise noise, double start = 0.0);

  /// True values at this instant.
  [[nodiscard]] model::Signals<double> truth() const { return model_.signals(state_); }

 private:
  void draw_noise();
  void do_measure(std::span<double, hal::channel_capacity> values) override;
  void do_advance(const hal::Command& command, hal::Openings openings) override;

  model::RigModel<> model_;
  model::RigModel<>::State state_;
  Gaussian gaussian_;
  std::array<double, model::channel_count> deviation_{};
  model::Signals<double> noise_{};  ///< of this instant
  std::array<std::optional<MeasuringRange>, model::channel_count> range_;
};

/// The part of a rig that is hardware: everything but the virtual car of a hil rig.
[[nodiscard]] model::Extent hardware_of(model::RigKind kind);

/// The channels that a rig of this kind measures on hardware.
[[nodiscard]] bool is_hardware_channel(model::RigKind kind, model::Channel channel);

}  // namespace host_sim
