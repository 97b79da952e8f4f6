// Recordings, ready to be explained.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "host_sim/recording.hpp"
#include "host_sim/response.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// A stretch of samples.
struct Window {
  std::size_t from = 0, to = 0;
  [[nodiscard]] std::size_t size() const { return to - from; }
};

/// rms of the noise that the driving motion carries [SI]; 0: none, or not known.
struct InputNoise {
  double position = 0.0, acceleration = 0.0;
};

/// A recording with its input prepared, split into what is fitted and what is held out.
///
/// A hil rig is explained block by block: its test machine and component are driven by the recorded x_cmd, which is a
/// number of the real-time program without noise, as on a component_bench. The noise that went round the loop is in
/// x_cmd already, so that what is left over is the noise of the sensors alone.
struct Evidence {
  Recording recording;
  Drive drive;
  bool at_rest = false;                              ///< begins at rest; else the state at the first sample is unknown
  std::vector<model::Channel> channels;              ///< measured, to be explained
  std::array<double, model::channel_count> noise{};  ///< rms [SI], given or estimated
  std::array<std::vector<bool>, model::channel_count> clipped{};  ///< samples not to be trusted; empty: none
  Window fit, judge;
  InputNoise input_noise;
  /// Of z_r and zdd_r, per sample, about 1 where they tell of one motion; 0 where only one of them is recorded. Where
  /// they agree the foot point moves on what both say together, else on z_r alone.
  double disagreement = 0.0;

  [[nodiscard]] std::size_t size() const { return recording.size(); }
};

/// The rig as far as recordings of its kind are explained: a hil rig becomes the component_bench that its test machine
/// is, without the car.
[[nodiscard]] model::RigParameters<double> explained_part(const model::RigParameters<double>& rig);

/// `held_out`: the whole recording is for judging; `shared`: its last quarter is; else nothing is.
enum class Use { fitted, shared, held_out };

/// InputError where the recording does not hold what is needed: the input, something measured, 5 s.
[[nodiscard]] Evidence evidence_of(const RigDescription& description, Recording recording, Use use);

/// rms of the white noise in samples of a smooth signal: their sixth differences, median over stretches of the signal,
/// where a signal below a tenth of the sample rate leaves less than 4e-3 of its amplitude.
[[nodiscard]] double estimated_noise(const std::vector<double>& samples);

}  // namespace host_sim::diagnose
