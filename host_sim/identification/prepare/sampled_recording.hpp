// A recording at the rate of its simulation, with what its own samples say of the sensors.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/comparison/static_value.hpp"
#include "host_sim/identification/prepare/sample_faults.hpp"
#include "host_sim/identification/prepare/sample_hold.hpp"
#include "host_sim/identification/prepare/sensor_noise.hpp"

namespace host_sim::identification {

/// A recording comes to a rate of 1 … 2 kHz:
///
///   faster  every n-th sample is kept (thresholds::shortest_period), so an hour at 10 kHz costs what it does at 1 kHz
///   slower  `step` samples for each one, interpolated (comparison/model_rate.hpp). Only each step-th, which is a
///           recorded one, is compared with a simulation
///
/// Nothing is filtered: what a sampling folds, the simulation folds in the same way. Sensors are judged by the samples
/// before the interpolation. Outliers (sample_faults.hpp) are looked for in all samples of the recording; each is
/// replaced by what its neighbours say, so that it drives no simulation, and counts as clipped.
struct SampledRecording {
  firmware::Recording recording;
  std::size_t step = 1;                              ///< samples for each one that is compared
  double slower = 1.0;                               ///< its steps, relative to longest_model_step at most
  std::array<double, model::channel_count> noise{};  ///< level [SI] of a sample that is compared
  ChannelNoises channel_noise{};                     ///< the same with its colour
  std::optional<NoiseColour> expected_colour{};      ///< of the recorder: noise_spectrum.hpp
  std::array<std::optional<NoiseFactor>, model::channel_count> noise_factor{};
  std::array<std::vector<bool>, model::channel_count> clipped{};  ///< not recorded, out of range, outliers; empty: none
  std::array<Outliers, model::channel_count> outliers{};
  std::array<double, model::channel_count> rounding{};  ///< step [SI] that makes its noise louder; 0: none
  std::array<std::optional<Renewals>, model::channel_count> renewals{};
  std::vector<StaticValue> tared{};  ///< constants that were taken off

  /// rms of white noise at every sample with the density of that of a channel's compared samples.
  [[nodiscard]] double noise_at_every_sample(model::Channel channel) const;
};

[[nodiscard]] SampledRecording sampled(const firmware::RigDescription& description, firmware::Recording recording);

/// The samples alone, for a check.
[[nodiscard]] firmware::Recording at_simulated_rate(firmware::Recording recording);

}  // namespace host_sim::identification
