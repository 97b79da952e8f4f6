// Candidate effects, and where a fit of each begins.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/predict/hypothesis.hpp"

namespace host_sim::identification {

/// Typical sizes in the recordings and in a simulation of them [SI], of which starts are shares.
struct Scales {
  std::array<double, model::channel_count> rms{}, peak{};
  model::MotionScales motion{};  ///< its `channel` is set for each channel
};

[[nodiscard]] Scales scales_of(const std::vector<PreparedRecording>& recordings, const Hypothesis& hypothesis,
                               const std::vector<Response>& responses);

/// Where a fit may begin.
struct Start {
  std::vector<double> values;  ///< of the effect's parameters
  HoldClock clock{};           ///< of a hold
};

/// An effect of the catalogue that has a place on this rig and whose parameters can be seen, with values to start from.
struct Candidate {
  const firmware::CatalogueEntry* entry;
  std::optional<model::Channel> channel;
  std::vector<Start> starts;
  const firmware::CatalogueEntry* replaces = nullptr;  ///< an effect of the rig that this one contains
};

/// All candidates for a rig. Left out are those already in `hypothesis`, and those that one of these contains.
[[nodiscard]] std::vector<Candidate> candidates(const std::vector<PreparedRecording>& recordings,
                                                const Hypothesis& hypothesis, const Scales& scales);

}  // namespace host_sim::identification
