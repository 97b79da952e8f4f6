// A recording against the simulation of its own input.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "host_sim/bands.hpp"
#include "host_sim/recording.hpp"
#include "host_sim/response.hpp"
#include "host_sim/rig_description.hpp"

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
  std::size_t missing = 0;  ///< samples of each channel that were not recorded: left out as well
  std::string remark;       ///< a line on them; empty: none
};

/// How the state at the first sample is found.
enum class StartChoice { automatic, rest, estimated };

/// A recording with its input prepared and its start chosen; its simulations differ in the rig's parameters only.
class ComparedRecording {
 public:
  /// InputError when the input is missing, or nothing measured could be compared.
  ComparedRecording(const RigDescription& description, Recording recording, StartChoice choice);

  /// Simulation with these parameters; a start that is estimated is estimated with them.
  [[nodiscard]] Response simulate(const model::RigParameters<double>& rig) const;

  /// rms(simulated − measured) ÷ rms(measured − mean) per sample, √(samples) beneath: the squares of all residuals of a
  /// channel sum up to nrmse². Channels that never move are left out.
  void residuals(const Response& response, std::vector<double>& out) const;
  [[nodiscard]] std::size_t residual_count() const;

  [[nodiscard]] RecordingComparison compare(const Response& response) const;
  [[nodiscard]] const Recording& recording() const { return recording_; }

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

  Recording recording_;
  Drive drive_;
  MeasuringRanges range_;
  bool at_rest_ = false;
  std::vector<Judged> judged_;
};

/// Fits all parameters under [tolerance] inside their bounds value · (1 ± tolerance), never below a thousandth of the
/// value: least squares of the normalised errors of all channels of all recordings, trust region with bounds (Ceres).
/// The best of three starts wins: as described, half way to the lower bounds, half way to the upper ones.
struct Refit {
  model::RigParameters<double> rig;
  std::map<std::string, double> parameters;        ///< fitted, by path
  std::vector<std::string> at_bound;               ///< paths of those that ended at a bound
  double pooled_before = 0.0, pooled_after = 0.0;  ///< √(mean of nrmse²) over channels and recordings
};
/// `progress` is told after each iteration the share of the work that is done at most, and the error so far.
[[nodiscard]] Refit refit(const RigDescription& description, const std::vector<ComparedRecording>& recordings,
                          const std::function<void(double share, double pooled_error)>& progress = {});

}  // namespace host_sim
