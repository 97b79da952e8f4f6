// Compares a recording with the simulation of its own input.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/comparison/static_value.hpp"
#include "host_sim/signal/bands.hpp"

namespace host_sim {

/// One third-octave band of one channel.
struct BandError {
  Band band;
  double error_rms;  ///< of simulated − measured [unit of the channel]
  double data_rms;   ///< of measured
};

/// One channel. nrmse = rms(simulated − measured) ÷ rms(measured − its mean); a channel that never moves has none
/// (NaN).
struct ChannelComparison {
  model::Channel channel;
  double nrmse;
  double error_rms;         ///< [unit of the channel]
  double data_rms;          ///< about the mean
  std::size_t clipped = 0;  ///< samples at or beyond the measuring range: left out of everything above
  std::vector<BandError> bands;
};

/// One recording.
struct RecordingComparison {
  std::string source;
  double duration;       ///< [s]
  model::Channel input;  ///< that drove the simulation
  bool started_at_rest;
  std::vector<ChannelComparison> channels;
  std::size_t missing = 0;           ///< samples of each channel that were not recorded: left out as well
  std::string remark;                ///< a line on them; empty: none
  std::vector<StaticValue> tared{};  ///< constants that were taken off before
};

/// How the state at the first sample is found.
enum class StartChoice { automatic, rest, estimated };

/// Input noise and recorder, applied to a simulation before it is compared.
struct RecordedAs {
  /// The input as the rig has had it, without the noise of its sensor. `simulated`: the recording with a sample for
  /// each step of the simulation.
  std::function<void(const firmware::Recording& recorded, const firmware::Recording& simulated, SimulationInput& input)>
      moved{};
  /// The rig whose parameters change over `samples`, `period` [s] apart.
  std::function<RigVariation(const model::RigParameters<double>& rig, std::size_t samples, double period)> varied{};
  /// Simulated channels become recorded ones, in the place of those of `measured`; both at one rate.
  std::function<void(const firmware::Recording& measured, model::Channel input, Response& channels)> recorded{};
};

/// A recording with its input prepared and its start chosen; its simulations differ in the rig's parameters only.
class ComparedRecording {
 public:
  /// InputError when the input is missing, or nothing measured could be compared.
  ComparedRecording(const firmware::RigDescription& description, firmware::Recording recording, StartChoice choice,
                    RecordedAs recorder = {});

  /// Simulation with these parameters; a start that is estimated is estimated with them.
  [[nodiscard]] Response simulate(const model::RigParameters<double>& rig) const;

  /// Residuals of all channels, sample by sample, with weights that make the squares of a channel sum up to nrmse²:
  ///   (1)  r_k = (simulated_k − measured_k) / (rms(measured − mean) √samples)
  /// A channel that never moves is left out.
  void residuals(const Response& response, std::vector<double>& out) const;
  [[nodiscard]] std::size_t residual_count() const;

  [[nodiscard]] RecordingComparison compare(const Response& response) const;
  [[nodiscard]] const firmware::Recording& recording() const { return recording_; }

 private:
  struct Judged {
    model::Channel channel;
    double data_rms;            ///< about the mean
    std::vector<bool> trusted;  ///< empty: all samples
    std::size_t clipped = 0;
    double count = 0.0;  ///< of the samples that are trusted
  };
  [[nodiscard]] bool trusted(const Judged& judged, std::size_t k) const {
    return judged.trusted.empty() || judged.trusted[k];
  }

  firmware::Recording recording_;
  std::size_t step_;                 ///< model steps for each sample, of which only the recorded instants are compared
  firmware::MeasuringRanges range_;  ///< of the tared samples
  std::vector<StaticValue> tared_;
  firmware::Recording simulated_;  ///< the recording at the model's rate
  SimulationInput input_;
  int fine_;  ///< steps for each of these where forces bend (fine_steps.hpp)
  RecordedAs recorder_;
  bool at_rest_ = false;
  std::vector<Judged> judged_;
};

}  // namespace host_sim
