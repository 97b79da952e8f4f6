// Stability of the loop of a description with [compensation].
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/compensation/compensated_loop.hpp"
#include "host_sim/compensation/delay_mismatch.hpp"

namespace host_sim::compensation {

using firmware::compensation::Kind;

/// Roots and margins of the sampled loop with its compensator, exactly: CompensatedLoop is one period of the code that
/// runs, and the delay is no approximation in it.
///
/// The loop of adaptive_time_series is judged twice, with the coefficients that it begins with and with those that it
/// arrives at; `roots`, margins and map are of the latter. adaptive_virtual_damping counts with its whole damping.
struct CompensatedStability {
  Kind kind{};
  Settings settings;                 ///< as the description says
  double assumed_delay{};            ///< of the assumed machine at low frequencies, a₁/a₀ [s]
  double delay{};                    ///< of the described one, with the delays outside it [s]
  double pure_delay{};               ///< part of it without lag and resonance [s]
  bool stable = false;               ///< both, for adaptive_time_series
  double spectral_radius{};          ///< the larger one of both
  std::vector<Complex> roots;        ///< ln λ/h [1/s], Im ≥ 0, rightmost first
  DelayMismatch mismatch;            ///< of the machine's delay
  std::optional<double> upper_gain;  ///< smallest factor above 1 of the measured force that is unstable, up to 100
  std::optional<double> lower_gain;  ///< largest factor below 1 that is, down to 1/100
};

/// Of a hil rig with [compensation], for the number of ducts that it opens first. `delay_outside`: delays that no
/// effect models [s], at the machine.
[[nodiscard]] CompensatedStability compensated_stability(const firmware::RigDescription& description,
                                                         double delay_outside);

/// "stable; the true delay may be 1.14 ms longer or 1.31 ms shorter than described", or how it is unstable.
[[nodiscard]] std::string in_words(const CompensatedStability& stability);

/// The largest spectral radius, as CompensatedStability::spectral_radius, at another delay outside the machine.
[[nodiscard]] double compensated_radius(const firmware::RigDescription& description, double delay_outside);

/// Numbers of ducts that a run opens.
[[nodiscard]] std::set<int> duct_counts(const firmware::RigDescription& description);

/// InputError, at the line of [compensation], with the margin that is missing, where a simulated run of this
/// description would be unstable: no delays but those of its effects, at every number of ducts that its run opens.
/// Nothing happens for a description without [compensation].
void refuse_unstable_compensation(const firmware::RigDescription& description);

/// Growth over the assumed and the true pure delay of the machine.
struct MismatchMap {
  std::vector<double> assumed, actual;  ///< [s]
  std::vector<double> growth;           ///< ln(spectral radius)/h [1/s], row after row of one actual delay
};
/// Both from 0 to twice the larger of the two delays, as far as the lines of the loop reach.
[[nodiscard]] MismatchMap mismatch_map(const firmware::RigDescription& description, double delay_outside,
                                       const std::function<void(double)>& progress = {});

}  // namespace host_sim::compensation
