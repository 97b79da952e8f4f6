// The inverse of the linearised rig within the bands of the target.
#pragma once

#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "host_sim/replicate/drive_model.hpp"
#include "host_sim/replicate/target.hpp"
#include "host_sim/signal/spectrum.hpp"

namespace host_sim::replicate {

/// Weighted least squares, frequency by frequency. With b_c the weight of channel c's band and w_c = weight²/rms² of
/// its target there:
///
///   (1)  M(f) = Σ_c w_c b_c² |H_c|²                                 what a drive makes
///   (2)  u(f) = Σ_c w_c b_c² H_c* e_c / (M + ρ),   ρ = thresholds::inverse_floor · largest M within an octave
///   (3)  unreachable_c = rms(b_c (t_c − H_c u)) / rms(b_c t_c)      what one drive cannot make of several targets, for
///   the linearised
///                                                                   rig: √(1 − γ²), γ² their multiple coherence with
///                                                                   one drive
class BandInverse {
 public:
  BandInverse(const DriveModel& model, const Target& target);
  /// With measured frequency responses in place of the model's, at the bins of a transform of that length.
  BandInverse(std::size_t length, std::vector<std::vector<std::complex<double>>> responses, const Target& target);

  /// Length of the transforms for a target: with room for what an inverse does before and after it.
  [[nodiscard]] static std::size_t transform_length(const Target& target);

  /// (2) of errors over time.
  [[nodiscard]] std::vector<double> drive(const std::vector<std::vector<double>>& errors) const;
  /// A channel's signal in its band.
  [[nodiscard]] std::vector<double> in_band(std::size_t channel, const std::vector<double>& signal) const;
  [[nodiscard]] const std::vector<double>& unreachable() const { return unreachable_; }  ///< (3)
  [[nodiscard]] double weight(std::size_t channel) const { return weights_[channel]; }   ///< w_c
  [[nodiscard]] double target_rms(std::size_t channel) const {
    return rms_[channel];
  }                                                                            ///< in its band, over its events
  [[nodiscard]] const std::vector<double>& metric() const { return metric_; }  ///< M of each bin
  /// M/(M + ρ) of a bin: what of a wish (2) grants.
  [[nodiscard]] double share(std::size_t bin) const {
    return metric_[bin] > 0.0 ? metric_[bin] / (metric_[bin] + floor_[bin]) : 0.0;
  }
  /// Fades a drive in from rest and out to it.
  void end_at_rest(std::vector<double>& drive) const;
  [[nodiscard]] RealTransform& transform() const { return *transform_; }
  [[nodiscard]] double frequency_step() const { return step_; }  ///< [Hz]

 private:
  void prepare(const Target& target);

  std::unique_ptr<RealTransform> transform_;
  double step_;
  std::size_t size_;
  std::vector<std::vector<std::complex<double>>> responses_;
  std::vector<std::vector<double>> bands_;  ///< b_c of each bin
  std::vector<double> weights_, rms_, metric_, floor_, unreachable_;
};

/// rms over the events of a target.
[[nodiscard]] double rms_over(const std::vector<Part>& events, std::span<const double> values);

}  // namespace host_sim::replicate
