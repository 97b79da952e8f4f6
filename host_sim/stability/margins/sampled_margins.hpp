// Margins of the loop as the controller runs it: sampled, with the force held for a period.
#pragma once

#include <optional>

#include "host_sim/stability/margins/margins.hpp"
#include "host_sim/stability/margins/varying_delay.hpp"
#include "host_sim/stability/roots/sampled_loop.hpp"

namespace host_sim::stability {

/// The sampled loop, cut at the received force:
///
///   (1)  1 + L(z) = det(z − A)/det(z − A₀),  z = e^{jωT}
///
/// A: matrix of a step, A₀ the same with the column of the received force set to zero. A factor g on the force is a
/// factor on that column, in which the determinant is affine: a pair of eigenvalues is on the unit circle where
/// g L = −1. Margins as in Margins, from a loop that is stable; one that is not has only a sensitivity peak.
struct SampledMargins {
  std::optional<GainMargin> upper_gain, lower_gain;
  std::optional<double> phase_margin;  ///< [rad]
  double phase_margin_omega{};         ///< [rad/s]
  SensitivityPeak sensitivity;
};
[[nodiscard]] SampledMargins sampled_margins(const StepMatrix& step, double period, bool stable);

/// The virtual damping at which the eigenvalue next to e^{jωT} reaches the unit circle, from a start value near by.
struct DampingBorder {
  double value{}, omega{};  ///< [N s/m], [rad/s]
};
[[nodiscard]] std::optional<DampingBorder> sampled_damping_border(const model::RigParameters<double>& rig,
                                                                  double period, double delay,
                                                                  const DampingBorder& start);

/// The sampled loop over the delays `lowest` … `highest` [s] of its machine and budget.
struct SampledOverDelays {
  bool stable{};          ///< at every constant delay that was looked at
  double worst_delay{};   ///< [s]
  double worst_radius{};  ///< spectral radius there
  std::optional<double>
      at_any_speed;  ///< (1) of VaryingDelay with the sampled loop's T [s]; none: unstable at `lowest`
  [[nodiscard]] bool stable_at_any_speed(double range) const {
    return stable && at_any_speed && *at_any_speed >= range;
  }
};
[[nodiscard]] SampledOverDelays sampled_over_delays(const model::RigParameters<double>& rig, double period,
                                                    double lowest, double highest);

}  // namespace host_sim::stability
