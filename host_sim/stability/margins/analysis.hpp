// The analysis behind `rigtwin stability`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/stability/margins/affine_family.hpp"
#include "host_sim/stability/margins/crossings.hpp"
#include "host_sim/stability/margins/interface_location.hpp"
#include "host_sim/stability/margins/margins.hpp"
#include "host_sim/stability/margins/sampled_margins.hpp"
#include "host_sim/stability/margins/sensitivity.hpp"
#include "host_sim/stability/margins/varying_delay.hpp"
#include "host_sim/stability/roots/characteristic_roots.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "host_sim/stability/roots/sampled_loop.hpp"
#include "host_sim/stability/roots/sides_of_rest.hpp"

namespace host_sim::stability {

/// One contribution to the loop delay.
struct DelayPart {
  std::string name;
  double seconds{};
  bool in_loop_delay{};  ///< part of τ of the verdict; half a step and the group delay of lags are not
};

/// The delay of the loop, part by part.
///
/// The loop delay τ of roots, verdict and margins is the sum of the delays among the effects of the rig description and
/// of the entries of [delay_budget]. A description without that table gives τ = effects.actuator_delay alone.
/// The hold of the sampled loop adds about half a step, a machine whose delay varies its swing and jitter. `total`
/// includes both and is to be compared with the critical delay; the sampled loop treats the hold exactly. Lags are part
/// of P and Q. Their delay at the critical frequency is shown but not added, because the critical delay already
/// includes it.
struct DelayBalance {
  std::vector<DelayPart> parts;
  double total{};              ///< τ, swing, jitter and half a step [s]
  std::optional<double> left;  ///< critical delay − total [s]
};

struct StabilityAnalysis {
  LinearRig rig;
  double delay{};          ///< τ [s]
  double machine_delay{};  ///< part of τ between x_cmd and x_act [s]
  bool stable{};           ///< in continuous time, at τ
  RootSet roots;
  Margins margins;
  SensitivityPeak sensitivity;
  std::vector<PadeResult> pade;               ///< orders 1 … 5
  std::vector<AxisValue> virtual_dampings;    ///< in 0 … most_virtual_damping with a root on the axis, at τ
  std::optional<AxisValue> critical_damping;  ///< the border that lies nearest to the given damping
  Complex critical_root;  ///< the root that reaches the axis at the critical delay, at the given delay; else the
                          ///< rightmost [1/s]
  std::vector<ParameterSensitivity> parameters;  ///< sorted by effect on the critical root, largest first
  std::optional<SampledLoop> sampled;  ///< the loop that the controller runs; none: the delay exceeds the delay line
  std::optional<SampledMargins> sampled_margins;         ///< of it
  std::optional<DampingBorder> sampled_damping;          ///< critical_damping of it
  std::optional<SampledOverDelays> sampled_over_delays;  ///< of it, where the machine's delay varies
  std::optional<double> delay_left;  ///< of the loop that runs, up to its next border: > 0 to be added, < 0 to be taken
                                     ///< away [s]; without `sampled`: delay_margin less half a step of hold
  std::optional<VaryingDelay> varying;  ///< where the machine's delay varies
  std::vector<LocationMap> locations;   ///< the same rig cut elsewhere (compare_locations); empty: not asked for
  DelayBalance balance;
  std::string side;                ///< of a rest that is a kink: this analysis is of the worse side; empty: smooth
  std::vector<FoundOnSide> sides;  ///< what was found on each

  [[nodiscard]] DelayEquation equation() const { return rig.equation(delay); }
  /// The loop at its given delay: sampled and in continuous time; the worse decides.
  [[nodiscard]] bool stable_as_run() const { return stable && (!sampled || sampled->stable()) && !past_border(); }
  /// Without a sampled loop: half a step of hold takes what is left.
  [[nodiscard]] bool past_border() const { return !sampled && stable && delay_left && *delay_left <= 0.0; }
  /// Every constant delay of the range that the machine's delay has.
  [[nodiscard]] bool stable_over_delays() const {
    return (!varying || varying->stable) && (!sampled_over_delays || sampled_over_delays->stable);
  }
};

inline constexpr double usual_line = -60.0;               ///< roots right of it are listed [1/s]
inline constexpr double most_virtual_damping = 10'000.0;  ///< [N s/m]

/// Throws InputError for a rig that is not a hil rig or whose loop is not retarded. Throws CountMismatch or another
/// std::logic_error where two independent methods disagree: the roots found and the argument principle; both and the
/// crossings counted from zero delay; the matrix of a step and the model's step.
[[nodiscard]] StabilityAnalysis analyse(const firmware::RigDescription& description, double line = usual_line);

}  // namespace host_sim::stability
