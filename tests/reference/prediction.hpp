// What a rig with some causes would have recorded: the model's own simulation, then its sensors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/comparison/simulation.hpp"

namespace reference {

using Rig = model::RigParameters<double>;
using Cause = firmware::PlacedEffect;

/// The described rig, but for the values of its tolerated parameters and the causes that were added.
struct Model {
  std::vector<double> tolerated;  ///< in units of the tolerance, −1 … 1, in the order of the description's table
  std::vector<Cause> causes;
};

/// A recording, ready to be compared.
struct Measured {
  firmware::Recording recording;
  host_sim::SimulationInput input;
  std::vector<model::Channel> channels;  ///< compared
  std::size_t from = 0, to = 0;          ///< samples that are compared
  /// Of a held channel: when each value was taken [samples], t_n = t_0 + n P, and the sample from which on it shows.
  struct Renewal {
    double taken;
    std::size_t shows;
  };
  std::array<std::vector<Renewal>, model::channel_count> renewals{};

  [[nodiscard]] double hold_period(model::Channel channel) const;  ///< P [s]; 0: not held
};

/// `seconds`: how many are compared, at most. A recording that begins in motion is simulated from rest and compared when
/// that is forgotten (`settling` [s]).
inline constexpr double settling = 6.0;
[[nodiscard]] Measured measured(const firmware::RigDescription& description, firmware::Recording recording,
                                double seconds);

[[nodiscard]] Rig rig_of(const firmware::RigDescription& description, const Model& model);

/// Every compared channel from the first sample on. Of a hil rig the component with its machine, driven by the recorded
/// x_cmd, and the virtual tyre, (1). What drives a quarter car is itself compared with its accelerometer, (2).
///
///   (1)  F_w = laws(k_t dz_w + b_t ḋz_w),  dz_w = z_r − z_w as recorded
///   (2)  z̈_r = (−z₋₂ + 16 z₋₁ − 30 z₀ + 16 z₁ − z₂)/12h²  of the z_r that drives, below 90 Hz
///
/// Sensors are the model's own, but for a hold, which is renewed when the recording was. Of what is no rig all is NaN.
[[nodiscard]] host_sim::Response predicted(const firmware::RigDescription& description, const Model& model,
                                           const Measured& measured);

}  // namespace reference
