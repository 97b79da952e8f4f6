// What might be missing, and where a fit of it may begin.
#pragma once

#include <array>
#include <vector>

#include "host_sim/catalogue.hpp"
#include "host_sim/diagnose/fit.hpp"

namespace host_sim::diagnose {

/// How large things are in the recordings, from a simulation of them [SI].
struct Scales {
  std::array<double, model::channel_count> rms{}, peak{};
  double deflection = 0.0, deflection_peak = 0.0;  ///< of the component: dz_b, x_act
  double velocity = 0.0, velocity_peak = 0.0;      ///< of it
  double force = 0.0;                              ///< of the component, rms
  double tyre_deflection = 0.0, tyre_force = 0.0;
  double foot_acceleration = 0.0;
};

[[nodiscard]] Scales scales_of(const Case& all, const Hypothesis& hypothesis, const std::vector<Response>& responses);

/// Where a fit may begin.
struct Start {
  std::vector<double> values;  ///< of the effect's parameters
  HoldClock clock{};           ///< of a hold
};

/// An effect of the catalogue that has a place on this rig and whose parameters can be seen, with values to start from.
struct Candidate {
  const CatalogueEntry* entry;
  std::optional<model::Channel> channel;
  std::vector<Start> starts;
};

/// All candidates for a rig, those already in `hypothesis` left out.
[[nodiscard]] std::vector<Candidate> candidates(const Case& all, const Hypothesis& hypothesis, const Scales& scales);

}  // namespace host_sim::diagnose
