// Recordings, ready to be explained.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "host_sim/recording.hpp"
#include "host_sim/response.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// When a held channel takes its value: with the sample at which it shows, or by a clock of its own, inside of what
/// the renewals allow: `place` −1 … 1 from the earliest to the latest.
struct HoldClock {
  bool own = false;
  double place = 0.0;
};

/// A stretch of samples.
struct Window {
  std::size_t from = 0, to = 0;
  [[nodiscard]] std::size_t size() const { return to - from; }
};

/// Where the acceleration of z_r alone is cut off, above what is known of it: the filter falls over ± 10 Hz.
inline constexpr double acceleration_edge = 1.5;
/// And to either side of a sample how far that filter reaches [s].
inline constexpr double acceleration_reach = 0.1;

/// rms of the noise that the driving motion carries [SI]; 0: none, or not known.
struct InputNoise {
  double position = 0.0, acceleration = 0.0;
};

/// The renewals of a channel that repeats itself exactly in between.
///
/// A sensor with a clock of its own, t_n = t_0 + n P, shows what it took at t_n from the next sample k_n on:
///
///   (1)  k_n − 1 < t_0 + n P ≤ k_n    [samples]
///
/// (1) for all n leaves t_0 and P little room. Whether the sensor took its value at t_n or at the sample k_n (one that
/// is triggered by the recorder, or simulated) only the values tell.
struct Renewals {
  std::vector<std::size_t> at;      ///< k_n
  std::vector<double> turn;         ///< n, with those left out that brought the same value again
  double period = 0.0;              ///< P [samples]
  double period_slack = 0.0;        ///< half width of what (1) allows
  double first = 0.0, slack = 0.0;  ///< t_0, and half width of what (1) allows, at this P
  bool regular = false;             ///< (1) can be met
};
[[nodiscard]] std::optional<Renewals> renewals_of(const std::vector<double>& samples);

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
  std::array<std::vector<bool>, model::channel_count> clipped{};         ///< samples not to be trusted; empty: none
  std::array<std::optional<Renewals>, model::channel_count> renewals{};  ///< of channels that repeat themselves
  Window fit, judge;
  InputNoise input_noise;
  /// z_r and zdd_r do not tell of one motion: the foot point moves on z_r alone and zdd_r is one of the channels. Where
  /// they agree it moves on what both say together.
  bool inputs_disagree = false;
  /// Where z_r alone tells its acceleration: up to which frequency [Hz] it is above its noise. 0: not needed.
  double acceleration_known = 0.0;
  /// Steps of the model in a sample where contacts stick or free play ends: inside of a step it knows that only at the
  /// step's end, an error ∝ h that would be taken for an effect. A quarter of a millisecond each.
  int fine = 1;

  /// Where in a window a channel can be explained: not z̈_r at the ends of a recording, where its filter lacks samples.
  [[nodiscard]] Window known(model::Channel channel, Window window) const {
    if (channel != model::Channel::zdd_r || !(acceleration_known > 0.0)) return window;
    const auto margin = static_cast<std::size_t>(acceleration_reach / drive.period);
    window.from = std::max(window.from, margin);
    window.to = std::max(window.from, std::min(window.to, size() - std::min(size(), margin)));
    return window;
  }
  [[nodiscard]] bool explains(model::Channel channel) const {
    return std::find(channels.begin(), channels.end(), channel) != channels.end();
  }
  [[nodiscard]] std::size_t size() const { return recording.size(); }
};

/// The rig as far as recordings of its kind are explained: a hil rig becomes the component_bench that its test machine
/// is, without the car.
[[nodiscard]] model::RigParameters<double> explained_part(const model::RigParameters<double>& rig);

/// `held_out`: the whole recording is for judging; `shared`: its last quarter is; else nothing is.
enum class Use { fitted, shared, held_out };

/// Whether a recording holds z_r and zdd_r and they do not tell of one motion (foot_point.hpp).
[[nodiscard]] bool inputs_disagree(const RigDescription& description, const Recording& recording);

/// InputError where the recording does not hold what is needed: the input, something measured, 5 s. `disagree`: whether
/// z_r and zdd_r are taken not to tell of one motion.
[[nodiscard]] Evidence evidence_of(const RigDescription& description, Recording recording, Use use, bool disagree);

/// The time from renewal to renewal of a channel that repeats itself, and the half width of what its instants, rounded
/// to samples, allow [s]. nullopt: it does not repeat itself.
struct HoldPeriod {
  double value, half_width;
};
[[nodiscard]] std::optional<HoldPeriod> hold_period(const std::vector<Evidence>& evidence, model::Channel channel);

/// rms of the white noise in samples of a smooth signal: their sixth differences, median over stretches of the signal,
/// where a signal below a tenth of the sample rate leaves less than 4e-3 of its amplitude.
[[nodiscard]] double estimated_noise(const std::vector<double>& samples);

/// rms of a channel's noise [SI]: as the rig description gives it, else estimated; of a channel that repeats itself
/// from the values that are new.
[[nodiscard]] double noise_of(const RigDescription& description, const Recording& recording, model::Channel channel);

}  // namespace host_sim::diagnose
