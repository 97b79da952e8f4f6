// A rig that might explain the recordings, with the state in which each begins.
#pragma once

#include <array>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "host_sim/comparison/simulation.hpp"
#include "host_sim/identification/predict/placed_law.hpp"
#include "host_sim/identification/predict/recording_faults.hpp"
#include "host_sim/identification/prepare/prepared_recording.hpp"

namespace host_sim::identification {

struct Hypothesis {
  model::RigParameters<double> rig;  ///< explained_part(), with effects
  std::vector<InitialState> starts;  ///< by recording
  /// Of a channel with a hold: at which of the instants that its renewals allow it takes its value.
  std::array<HoldClock, model::channel_count> clocks{};
  std::vector<PlacedFault> faults{};    ///< of the recordings, the same in all
  std::vector<PlacedLaw> laws{};        ///< learned; their tables stand in `rig`, too
  std::vector<PlacedFault> recorder{};  ///< the description's [recording]: always there, never a candidate

  [[nodiscard]] std::vector<PlacedFault> all_faults() const;  ///< `recorder`, then `faults`
};

/// The rig and the recorder as described; recordings that do not begin at rest start in the state that their first
/// seconds show. Of described hum each recording has a phase of its own, so it is left to the search where there are
/// several.
[[nodiscard]] Hypothesis described_hypothesis(const firmware::RigDescription& description,
                                              const std::vector<PreparedRecording>& recordings);

/// The starts of recordings that are wholly held out, estimated with this hypothesis' rig: no fit has moved them.
void estimate_held_out_starts(Hypothesis& hypothesis, const std::vector<PreparedRecording>& recordings);

}  // namespace host_sim::identification
