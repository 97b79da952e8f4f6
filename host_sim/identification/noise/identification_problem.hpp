// The identification problem: recordings, what of them is fitted, and how residuals are weighted.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "host_sim/identification/noise/input_noise_covariance.hpp"
#include "host_sim/identification/noise/whitening.hpp"
#include "host_sim/identification/predict/sensor_readings.hpp"

namespace host_sim::identification {

/// A recording as one problem uses it. The samples belong to all problems together.
struct ProblemRecording {
  const PreparedRecording* samples;
  Window fitted, held_out;  ///< of the samples; empty: nothing
  int substeps;             ///< model steps per sample where there are corners
  ChannelNoises noise;      ///< of the channels: as prepared, or found in what a hypothesis leaves
  InputNoiseCovariance input_noise;
  std::optional<Whitening> fit_whitening, held_out_whitening;  ///< of the two windows

  [[nodiscard]] bool is_fitted() const { return fit_whitening.has_value(); }
  [[nodiscard]] bool is_held_out() const { return held_out_whitening.has_value(); }
  [[nodiscard]] Resolution resolution() const { return {substeps}; }
  /// Of a sample of a channel by its own noise and by what the input's makes of it [SI²].
  [[nodiscard]] double noise_variance(model::Channel channel) const;
  /// Whether any channel of the fitted window, or of the one that is held out, moves by more than its noise: its
  /// variance is thresholds::least_motion times that of the noise. Where the input does, too, noise is the channel's
  /// own: what the input's noise makes of a stiff component may be larger than its motion.
  [[nodiscard]] bool holds_motion() const;
};

/// Step 2: every residual of the later steps is whitened with what stands here, and nothing else owns a Whitening. A
/// problem that is cut down to a part of the recordings shares their samples.
class IdentificationProblem {
 public:
  /// Without the noise of the input, which depends on a hypothesis: update_input_noise().
  explicit IdentificationProblem(std::vector<PreparedRecording> recordings);

  /// With the noise of the input as this hypothesis passes it on.
  IdentificationProblem(std::vector<PreparedRecording> recordings, const Hypothesis& hypothesis);

  [[nodiscard]] const std::vector<ProblemRecording>& recordings() const { return recordings_; }
  [[nodiscard]] const std::vector<PreparedRecording>& samples() const { return *samples_; }
  [[nodiscard]] const std::vector<model::Channel>& channels() const { return samples_->front().channels; }
  [[nodiscard]] double sample_period() const { return samples_->front().input.period; }
  [[nodiscard]] std::size_t residual_count() const;  ///< of the fitted windows
  [[nodiscard]] std::size_t fitted_count() const;    ///< recordings
  [[nodiscard]] bool has_held_out() const;
  /// Of this problem and of all its copies and parts.
  [[nodiscard]] SpentWork& work() const { return *samples_->front().work; }

  /// Weights residuals anew for what a hypothesis makes of the input's noise, and for the noise of channels that their
  /// own samples did not tell from motion: what the hypothesis leaves of them (sensor_noise.hpp). Where it has free
  /// play, samples at its knocks are left out: where the play ends a force jumps by a hundred times the noise, and a
  /// sample shows either side of the jump by a few microseconds, which the noise of the input alone decides. These are
  /// the samples of a channel on both sides of a step of what is read,
  ///
  ///   (1)  |d_k| > thresholds::knock · max(σ, σ_d),   d_k = Δ_k − (Δ_{k−1} + Δ_{k+1})/2,   Δ_k = y_{k+1} − y_k
  ///
  /// σ_d: what d is anyway, by its median. Not of a channel behind a lag or a filter, which make a slope over several
  /// samples of the jump. Of a held channel the values that were taken there. Not where friction turns: how it turns is
  /// what tells a smooth law from a sharp one. false: nothing changed.
  bool update_input_noise(const Hypothesis& hypothesis);
  /// The same noises as another problem on these samples.
  void take_input_noise(const IdentificationProblem& other);
  /// Allows for an error of the model, relative to the rms of each channel: ε_c of Whitening (2).
  void allow_model_error(double relative);

  /// Samples of a recording that are not used any more, of any channel.
  void leave_out(std::size_t recording, Window left_out);

  /// Whitening of any window of a recording, with the weights of the problem.
  [[nodiscard]] Whitening whitening(std::size_t recording, Window window) const;

  /// The same problem of some of the channels, each with its samples and its noise.
  [[nodiscard]] IdentificationProblem of_channels(const std::vector<model::Channel>& channels) const;
  /// Machine and component apart: F is that of a component which the given machine moves, so that what F leaves says
  /// nothing of the machine. Source of the idea: M. Plummer, Cuts in Bayesian graphical models, Stat. Comput. 25, 2015.
  [[nodiscard]] IdentificationProblem apart(const std::vector<firmware::PlacedEffect>& machine) const;
  [[nodiscard]] bool is_apart() const { return samples_->front().machine.has_value(); }
  /// As it was before apart().
  [[nodiscard]] IdentificationProblem joined() const;

  /// What is held out is fitted, too.
  [[nodiscard]] IdentificationProblem with_all_fitted() const;

  /// The first `share` of each fitted window, nothing held out.
  [[nodiscard]] IdentificationProblem truncated(double share) const;
  /// The same with half of the steps where there are corners.
  [[nodiscard]] IdentificationProblem truncated_and_coarse(double share) const;

 private:
  IdentificationProblem() = default;
  /// Takes other samples of the same recordings; replace_samples() weights residuals anew, too.
  void set_samples(std::vector<PreparedRecording> samples);
  void replace_samples(std::vector<PreparedRecording> samples);
  [[nodiscard]] IdentificationProblem of(std::vector<PreparedRecording> samples) const;
  bool update_channel_noise(const Hypothesis& hypothesis);
  /// Without weighting anew.
  bool update_knocks(const Hypothesis& hypothesis);
  void whiten();

  std::shared_ptr<const std::vector<PreparedRecording>> samples_;
  std::vector<ProblemRecording> recordings_;
  double model_error_ = 0.0;
};

}  // namespace host_sim::identification
