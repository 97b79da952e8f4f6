// How wrong may a compensator's assumed delay be?
#pragma once

#include <optional>
#include <vector>

#include "firmware/loop/compensation/settings.hpp"
#include "model/rig/rig_parameters.hpp"

namespace host_sim::compensation {

using Rig = model::RigParameters<double>;
using firmware::compensation::Settings;

/// The delay of the machine at low frequencies: delay, lag and resonance [s].
[[nodiscard]] double machine_delay(const Rig& rig);
/// The pure part of it [s].
[[nodiscard]] double pure_delay(const Rig& rig);
/// The same rig with a machine whose pure delay is `change` longer [s]; not below none.
[[nodiscard]] Rig with_delay_change(Rig rig, double change);

/// The loop while the true delay of its machine changes and the assumed one stays.
struct DelayMismatch {
  std::vector<double> error;             ///< true delay less the described one [s], ascending, 0 among them
  std::vector<double> radius;            ///< spectral radius there
  std::optional<double> later, earlier;  ///< smallest change of each sign that is unstable [s]; none found
  std::optional<double> nearest_stable;  ///< of an unstable loop: the smallest change that makes it stable [s]
  [[nodiscard]] std::optional<double> smallest() const;  ///< of later and earlier, |change| [s]
};

/// `rig` is linear (stability::linear_part). Changes reach 1.5 times the machine's delay to each side, in steps of an
/// eighth of it; borders are bisected to 1/4096 of a step.
/// \param settings  nullptr: no compensation
[[nodiscard]] DelayMismatch delay_mismatch(const Rig& rig, double period, const Settings* settings);

}  // namespace host_sim::compensation
