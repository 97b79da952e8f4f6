// A rig that might explain the recordings, and what in it is unknown.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/catalogue.hpp"
#include "host_sim/diagnose/evidence.hpp"
#include "host_sim/response.hpp"
#include "host_sim/rig_description.hpp"

namespace host_sim::diagnose {

/// Whether an effect's parameter is read off the recording (hold_period()) and is not fitted.
[[nodiscard]] inline bool is_hold(const CatalogueEntry& entry) { return entry.name == "sensor_hold"; }

/// A rig with effects, and the state in which each recording begins.
struct Hypothesis {
  model::RigParameters<double> rig;  ///< explained_part()
  std::vector<InitialState> starts;  ///< by recording
  /// Of a channel with a hold, at which of the instants that its renewals allow it is renewed.
  std::array<HoldClock, model::channel_count> clocks{};
};

/// One number to be found, as a coordinate u of the search:
///
///   value = centre + scale · u      tolerated parameters, signed effect parameters, start states
///   value = scale · e^u             effect parameters that are positive
struct Unknown {
  enum class Role : unsigned char { tolerated, effect, start } role;
  std::string path;                        ///< of tolerated and effect parameters
  std::size_t recording{};                 ///< of start states
  int state{};                             ///< of start states: z_w, ż_w, z_b, ż_b, y, ẏ
  std::optional<model::Channel> sensor{};  ///< of a sensor effect: nothing but this channel's readings depends on it
  double centre{}, scale{};
  bool logarithmic = false;
  double lower{}, upper{};  ///< bounds of u
  double step{};            ///< of u, for differences

  [[nodiscard]] double value(double u) const;
  [[nodiscard]] double coordinate(double value) const;
  /// How far from u a slope may be believed: a factor of e, twice the value, a start not much larger than the motion;
  /// what enters linearly, or has bounds close by, any distance.
  [[nodiscard]] double reach(double u) const;
  /// What a step from u may be: inside the bounds and a share `trust` of reach(u), 0 in any case: another fit, with
  /// bounds of its own, may have left u beyond these.
  struct Room {
    double lower, upper;
  };
  [[nodiscard]] Room room(double u, double trust) const;
  void put(Hypothesis& hypothesis, double u) const;
  [[nodiscard]] double get(const Hypothesis& hypothesis) const;  ///< u
  [[nodiscard]] bool at_bound(const Hypothesis& hypothesis) const;
};

/// The tolerated parameters, within their bounds.
[[nodiscard]] std::vector<Unknown> tolerated_unknowns(const RigDescription& description);

/// The states at the beginnings of recordings that do not begin at rest.
[[nodiscard]] std::vector<Unknown> start_unknowns(const RigDescription& description,
                                                  const std::vector<Evidence>& evidence);

/// The parameters of an effect that is in the hypothesis, those that are to be fitted.
[[nodiscard]] std::vector<Unknown> effect_unknowns(const PlacedEffect& effect);

}  // namespace host_sim::diagnose
