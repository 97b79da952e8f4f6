// The simulated rig: plant of the simulated back-end of hal.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/simulation/gaussian.hpp"
#include "hal/simulated/plant.hpp"
#include "model/rig/rig_model.hpp"

namespace firmware {

/// Plant of a simulated run: the model of the rig (hil: machine and component; the firmware computes the car) and its
/// sensors, with the noise of the rig description, limited to the measuring ranges.
///
/// Noise is Gaussian and independent from sample to sample: one draw per noisy channel and instant, in the order of the
/// channels, from the seed of the run.
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
  void do_command_area(double area) override { model_.command_area(state_, area); }

  [[nodiscard]] hal::Openings late(hal::Openings openings);

  model::RigModel<> model_;
  model::RigModel<>::State state_;
  Gaussian gaussian_;
  std::array<double, model::channel_count> deviation_{};
  model::Signals<double> noise_{};  ///< of this instant
  std::array<std::optional<MeasuringRange>, model::channel_count> range_;
  std::vector<hal::Openings> on_their_way_;  ///< openings of valves.delay, a ring; empty: valves without delay
  std::size_t oldest_ = 0;
  bool valves_told_ = false;
};

/// The part of a rig that is hardware: everything but the virtual car of a hil rig.
[[nodiscard]] model::ModelledPart hardware_of(model::RigKind kind);

/// The channels that a rig of this kind measures on hardware.
[[nodiscard]] bool is_hardware_channel(model::RigKind kind, model::Channel channel);

}  // namespace firmware
