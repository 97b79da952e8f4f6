// Everything that `rigtwin stability` says about a hil rig.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/rig_description.hpp"
#include "host_sim/stability/affine_family.hpp"
#include "host_sim/stability/characteristic_roots.hpp"
#include "host_sim/stability/crossings.hpp"
#include "host_sim/stability/linear_rig.hpp"
#include "host_sim/stability/margins.hpp"
#include "host_sim/stability/sampled_loop.hpp"
#include "host_sim/stability/sensitivity.hpp"

namespace host_sim::stability {

/// One part of the delay of the loop.
struct DelayPart {
  std::string name;
  double seconds{};
  bool in_loop_delay{};  ///< part of τ of the verdict; half a step and the group delay of lags are not
};

/// The delay of the loop, part by part.
///
/// The loop delay τ of roots, verdict and margins is what the rig description says is there: the delays among its
/// effects and the entries of [delay_budget]. A description without that table gives τ = effects.actuator_delay alone.
/// The hold of the sampled loop adds about half a step; it stands in `total`, which is what to hold against the
/// critical delay, and is treated exactly by the sampled loop. Lags are in P and Q; their delay at the critical
/// frequency is shown and not added, since the critical delay has it in already.
struct DelayBalance {
  std::vector<DelayPart> parts;
  double total{};              ///< τ and half a step [s]
  std::optional<double> left;  ///< critical delay − total [s]
};

struct StabilityAnalysis {
  LinearRig rig;
  double delay{};          ///< τ [s]
  double machine_delay{};  ///< of it between x_cmd and x_act [s]
  bool stable{};
  RootSet roots;
  Margins margins;
  SensitivityPeak sensitivity;
  std::vector<PadeResult> pade;               ///< orders 1 … 5
  std::vector<AxisValue> virtual_dampings;    ///< in 0 … most_virtual_damping with a root on the axis, at τ
  std::optional<AxisValue> critical_damping;  ///< the border that lies nearest to the given damping
  Complex critical_root;  ///< which reaches the axis at the critical delay, where it is now; else the rightmost [1/s]
  std::vector<ParameterSensitivity> parameters;  ///< largest effect on the critical root first
  std::optional<SampledLoop> sampled;            ///< none: the delay does not fit the model's delay line
  DelayBalance balance;

  [[nodiscard]] DelayEquation equation() const { return rig.equation(delay); }
};

inline constexpr double usual_line = -60.0;               ///< roots right of it are listed [1/s]
inline constexpr double most_virtual_damping = 10'000.0;  ///< [N s/m]

/// Throws InputError for a rig that is not a hil rig or whose loop is not retarded; CountMismatch and other
/// std::logic_errors where two ways to one number disagree: the roots found against the argument principle, both
/// against the crossings counted from no delay on, the step's matrix against the model's step.
[[nodiscard]] StabilityAnalysis analyse(const RigDescription& description, double line = usual_line);

}  // namespace host_sim::stability
