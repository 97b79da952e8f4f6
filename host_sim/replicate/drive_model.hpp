// The rig as a map from drive to channels.
#pragma once

#include <complex>
#include <cstddef>
#include <utility>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/comparison/simulation.hpp"

namespace host_sim::replicate {

/// The part of a rig that a drive moves. A hil rig is moved as its test bench: the drive is x_cmd, the virtual car
/// rests.
[[nodiscard]] firmware::RigDescription driven_part(const firmware::RigDescription& description);

/// z_cmd of a quarter_car, x_cmd of a component_bench.
[[nodiscard]] model::Channel drive_channel(model::RigKind kind);

/// Answer of the described rig to a drive [m], one command a sample, from rest at its first: the one step function,
/// sensors' effects included, without noise.
class DriveModel {
 public:
  DriveModel(const firmware::RigDescription& description, std::vector<model::Channel> channels);
  DriveModel(const model::RigParameters<double>& rig, double period, std::vector<model::Channel> channels)
      : rig_(rig), period_(period), channels_(std::move(channels)) {}
  /// Another rig, for the same channels at the same rate.
  DriveModel(const model::RigParameters<double>& rig, const DriveModel& like)
      : rig_(rig), period_(like.period_), channels_(like.channels_) {}

  [[nodiscard]] const std::vector<model::Channel>& channels() const { return channels_; }
  [[nodiscard]] double period() const { return period_; }
  [[nodiscard]] const model::RigParameters<double>& rig() const { return rig_; }

  using Answer = std::vector<std::vector<double>>;  ///< by channel
  [[nodiscard]] Answer answer(const std::vector<double>& drive) const;
  /// The same of a rig with other numbers: a smoothed one.
  [[nodiscard]] Answer answer(const model::RigParameters<double>& rig, const std::vector<double>& drive) const;
  /// Any channels.
  [[nodiscard]] Response response(const std::vector<double>& drive, const std::vector<model::Channel>& channels) const;
  [[nodiscard]] Response response(const model::RigParameters<double>& rig, const std::vector<double>& drive,
                                  const std::vector<model::Channel>& channels) const;

  /// Frequency responses channel/drive at the bins of a transform of `length` samples: of the rig without its corners,
  /// from its answer to a small pulse that holds all frequencies up to a quarter of the sample rate.
  [[nodiscard]] std::vector<std::vector<std::complex<double>>> linear_response(std::size_t length) const;

 private:
  [[nodiscard]] SimulationInput input_of(const std::vector<double>& drive) const;

  model::RigParameters<double> rig_;
  double period_;
  std::vector<model::Channel> channels_;
};

/// The rig with its corners (dry friction, stops, play, limits of speed) at `share` of their size; 0: without them.
[[nodiscard]] model::RigParameters<double> with_corners(const model::RigParameters<double>& rig, double share);

}  // namespace host_sim::replicate
