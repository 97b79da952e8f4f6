// A recording, ready to be compared with simulations.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/values/effects_by_name.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/prepare/recording_window.hpp"
#include "host_sim/identification/prepare/sample_faults.hpp"
#include "host_sim/identification/prepare/sample_hold.hpp"
#include "host_sim/identification/prepare/sampled_recording.hpp"
#include "host_sim/identification/prepare/sensor_noise.hpp"
#include "host_sim/identification/prepare/spent_work.hpp"

namespace host_sim::identification {

/// Level of the noise of a recorded sample of the measured input [SI]; 0: none, or not known.
struct InputNoise {
  double position = 0.0;      ///< of z_r or z_w; 0: the motion is an acceleration, integrated twice
  double acceleration = 0.0;  ///< of the accelerometer beside it, or alone
  NoiseColour position_colour{}, acceleration_colour{};
  double sample_period = 1e-3;  ///< [s] of the colours
  [[nodiscard]] bool any() const { return position > 0.0 || acceleration > 0.0; }
};

/// A recording with its input prepared, split into what is fitted and what is held out.
///
/// A hil rig is identified block by block: its test machine and component are driven by the recorded x_cmd, which the
/// real-time program computed and which carries no noise, as on a component_bench. Sensor noise that went round the
/// loop is contained in x_cmd, so only the sensors' own noise remains.
struct PreparedRecording {
  firmware::Recording recording;
  SimulationInput input;
  /// Samples of the simulation for each one that was recorded and is compared; windows begin and end at such.
  std::size_t step = 1;
  bool at_rest = false;  ///< begins at rest; else the state at the first sample is unknown
  /// Wholly held out, of a machine without an FDVA, and not from rest: its state is known when the window begins
  /// (thresholds::forgets_start), while that of a car is only estimated.
  bool settles = false;
  std::vector<model::Channel> channels;              ///< measured, to be explained
  std::array<double, model::channel_count> noise{};  ///< level of compared samples [SI], declared or estimated
  ChannelNoises channel_noise{};                     ///< the same with its colour; inputs too
  std::array<std::optional<double>, model::channel_count> declared_noise{};  ///< rms [SI]
  firmware::MeasuringRanges range{};                                         ///< of the sensors
  std::optional<NoiseColour> expected_colour{};                              ///< of the recorder: noise_spectrum.hpp
  /// How much louder the noise is than declared; nullopt: not known. Of all channels with samples, inputs too.
  std::array<std::optional<NoiseFactor>, model::channel_count> noise_factor{};
  std::array<std::vector<bool>, model::channel_count> clipped{};  ///< samples not to be used; empty: none
  std::size_t stuck = 0;  ///< of those, samples of F while the command of a hil rig stands still
  /// Of those, samples at the knocks of the present hypothesis (noise/identification_problem.hpp).
  std::array<std::vector<std::size_t>, model::channel_count> knocks{};
  std::array<Outliers, model::channel_count> outliers{};                 ///< mended and not used; inputs too
  std::array<double, model::channel_count> rounding{};                   ///< step [SI] that makes noise louder; 0: none
  std::array<std::optional<Renewals>, model::channel_count> renewals{};  ///< of held channels
  Window fitted, held_out;
  InputNoise input_noise;
  /// Machine and component are judged apart (noise/identification_problem.hpp): the effects of this machine move the
  /// component, those of a hypothesis x_act alone. nullopt: the hypothesis's own do both.
  std::optional<std::vector<firmware::PlacedEffect>> machine{};
  /// The input is an integrated acceleration: its mean was removed, (ż(T) − ż(0))/T of which was motion, and with it
  /// what a channel is on average. At 0 Hz accelerations alone are compared (noise/whitening.hpp, 7).
  bool mean_unknown = false;
  /// Constants that were taken off channels: of their means nothing is known, so they are not compared.
  std::vector<StaticValue> tared{};
  /// z_r and zdd_r contradict each other: the foot point moves on z_r alone and zdd_r is one of the channels.
  bool inputs_disagree = false;
  bool inputs_fused = false;  ///< they agree: the foot point moves on the fusion of both
  /// Where z_r alone gives z̈_r: the frequency [Hz] up to which z_r is above its noise. 0: not needed.
  double acceleration_known = 0.0;
  double input_edge = 0.0;  ///< [Hz] the input is smoothed above (smoothed_input.hpp); 0: it is as recorded
  /// Model steps per sample where friction, free play or stops act (comparison/fine_steps.hpp).
  int substeps = 1;
  /// Of all that is done with it; copies and parts count together, and so do the recordings of one problem.
  std::shared_ptr<SpentWork> work = std::make_shared<SpentWork>();

  /// The motion that samples of the driving channel say, smoothed as the input is.
  [[nodiscard]] firmware::FootPointMotion motion_of_input(const std::vector<double>& samples) const;
  /// The part of a window where a channel can be compared: not z̈_r at the ends of a recording, where its filter lacks
  /// samples.
  [[nodiscard]] Window comparable(model::Channel channel, Window window) const;
  /// Whether what a channel is on average says nothing.
  [[nodiscard]] bool has_unknown_mean(model::Channel channel) const {
    return mean_unknown || std::any_of(tared.begin(), tared.end(),
                                       [channel](const StaticValue& value) { return value.channel == channel; });
  }
  [[nodiscard]] bool explains(model::Channel channel) const {
    return std::find(channels.begin(), channels.end(), channel) != channels.end();
  }
  /// Whether a parameter, or an effect, moves anything that is simulated: on a prescribed wheel nothing of the tyre
  /// does, what acts on the wheel shows in F_w alone, and a sensor that feels the road's acceleration is not known.
  [[nodiscard]] bool shows(std::string_view parameter_path) const;
  [[nodiscard]] bool shows(const firmware::CatalogueEntry& effect) const;
  /// The channel that alone says how the input moves, so that an error of its sensor shows in all others. nullopt: the
  /// input was computed, two sensors say it, or one other channel is all there is, whose sensor might be wrong as well.
  [[nodiscard]] std::optional<model::Channel> input_sensor() const;
  [[nodiscard]] std::size_t size() const { return recording.size(); }
  /// The first sample from `k` on that was recorded; from there each step-th is.
  [[nodiscard]] std::size_t compared_from(std::size_t k) const { return (k + step - 1) / step * step; }
  [[nodiscard]] double compared_period() const { return input.period * static_cast<double>(step); }  ///< [s]
};

/// The part of a rig that recordings of its kind are explained with: a hil rig without its virtual car, which is the
/// component_bench that its test machine makes. An air spring keeps its skyhook: the recorded body velocity commands
/// its area (SimulationInput::area).
[[nodiscard]] model::RigParameters<double> explained_part(const model::RigParameters<double>& rig);

/// `held_out`: the whole recording is held out; `shared`: its last quarter is; `fitted`: nothing is.
enum class Use { fitted, shared, held_out };

/// True if z_r and zdd_r are both recorded and must not be fused: they contradict each other (input_fusion.hpp), or
/// zdd_r is held, which would make the fused motion late.
[[nodiscard]] bool inputs_disagree(const firmware::RigDescription& description, const SampledRecording& sampled);

/// InputError where the recording does not hold what is needed: the input, a measured channel,
/// thresholds::shortest_recording. `disagree`: whether z_r and zdd_r are treated as contradicting each other.
[[nodiscard]] PreparedRecording prepare_recording(const firmware::RigDescription& description, SampledRecording sampled,
                                                  Use use, bool disagree);
[[nodiscard]] PreparedRecording prepare_recording(const firmware::RigDescription& description,
                                                  firmware::Recording recording, Use use, bool disagree);

/// Takes the noise above its motion from a measured displacement that drives a simulation, as prepare_recording() does,
/// so that `compare` says of a rig what `diagnose` has said of it. `recorded`: as it was read; `simulated`: the same
/// with a sample for each step. An input that is computed, or that a second sensor measures, stays as it is.
void smooth_input(const firmware::RigDescription& description, const firmware::Recording& recorded,
                  const firmware::Recording& simulated, SimulationInput& input);

/// The time from renewal to renewal of a held channel, and the half width of what its instants, rounded to samples,
/// allow [s]. nullopt: it is not held.
struct HoldPeriod {
  double value, half_width;
};
[[nodiscard]] std::optional<HoldPeriod> hold_period(const std::vector<PreparedRecording>& recordings,
                                                    model::Channel channel);

}  // namespace host_sim::identification
