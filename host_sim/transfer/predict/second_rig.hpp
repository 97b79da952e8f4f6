// The second rig, driven by its road or by its own recordings.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/simulation/road.hpp"
#include "host_sim/identification/diagnosis.hpp"
#include "host_sim/transfer/predict/outcome.hpp"

namespace host_sim::transfer {

/// What drives the second rig, what disturbs its readings, and how they are analysed.
struct SecondRig {
  firmware::RigDescription description;
  std::vector<identification::PreparedRecording> drives;  ///< with F_w, z̈_b and dz_b as channels
  std::vector<InitialState> starts;
  std::vector<Response> measured;  ///< of each drive; empty: it runs over a road
  /// Noise of F_w, z̈_b and dz_b at the lines, that of the input as the rig passes it on included [unit²/Hz].
  std::array<std::vector<double>, 3> noise_density;
  std::array<double, 3> noise_variance{};  ///< of the same channels [unit²]
  std::optional<Analysis> analysis;
  std::vector<std::string> remarks;

  [[nodiscard]] bool is_measured() const { return !measured.empty(); }
  /// Readings of the second rig with these numbers, a run for each drive.
  [[nodiscard]] std::vector<std::vector<Response>> run(const std::vector<model::RigParameters<double>>& rigs) const;
};
inline constexpr std::array<model::Channel, 3> outcome_channels{model::Channel::F_w, model::Channel::zdd_b,
                                                                model::Channel::dz_b};

/// Over a road motion, from rest.
[[nodiscard]] SecondRig on_road(const firmware::RigDescription& to, const firmware::FootPointMotion& motion);

/// On the input of its own recordings, as diagnose prepares and weights them.
[[nodiscard]] SecondRig on_recordings(const firmware::RigDescription& to, const identification::Identified& second);

}  // namespace host_sim::transfer
