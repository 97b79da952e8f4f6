// What repeats of the difference between rig and model.
#pragma once

#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/replicate/band_inverse.hpp"
#include "host_sim/replicate/drive_model.hpp"
#include "host_sim/replicate/run_record.hpp"
#include "host_sim/replicate/target.hpp"

namespace host_sim::replicate {

/// Iterative learning on the non-linear model. d_r = measured − predicted of run r, with its own drive; the estimate of
/// what repeats:
///
///   (1)  d̂_r = d̂_{r−1} + α (d_r − d̂_{r−1}),   d̂_0 = 0
///   (2)  α(f) = max(0, 1 − S_n/S_i)
///
/// S_i: power of the innovation d_r − d̂_{r−1} near f, S_n: of the sensor's noise, as declared ([noise]). Where nothing
/// is declared: of half of the difference of the last two innovations' spectra that is not coherent, from the second
/// run on; before, α = 1. So noise enters with the share that it has, and less with every run. Source: H.-S. Ahn, Y.
/// Chen, K. Moore, Iterative Learning Control, 2007, ch. 1 (learning gain); the Wiener gain is (2).
class Correction {
 public:
  Correction(const firmware::RigDescription& description, const Target& target, const BandInverse& inverse)
      : description_(description), target_(target), inverse_(inverse) {}

  /// The next run, `predicted` by the present model for its drive.
  void take(const RunRecord& run, const DriveModel::Answer& predicted);

  [[nodiscard]] const std::vector<std::vector<double>>& offset() const {
    return offset_;
  }  ///< d̂; empty before the first run
  /// rms of d̂'s last innovation that was taken for noise, ÷ rms of the target, by channel.
  [[nodiscard]] const std::vector<double>& noise() const { return noise_; }

 private:
  const firmware::RigDescription& description_;
  const Target& target_;
  const BandInverse& inverse_;
  std::vector<std::vector<double>> offset_, last_;
  std::vector<double> noise_;
};

}  // namespace host_sim::replicate
