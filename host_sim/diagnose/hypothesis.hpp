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

/// A rig with effects, and the state in which each recording begins.
struct Hypothesis {
  model::RigParameters<double> rig;  ///< explained_part()
  std::vector<InitialState> starts;  ///< by recording
};

/// One number to be found, as a coordinate u of the search:
///
///   value = centre + scale · u      tolerated parameters, signed effect parameters, start states
///   value = scale · e^u             effect parameters that are positive
struct Unknown {
  enum class Role : unsigned char { tolerated, effect, start } role;
  std::string path;         ///< of tolerated and effect parameters
  std::size_t recording{};  ///< of start states
  int state{};              ///< of start states: z_w, ż_w, z_b, ż_b, y, ẏ
  double centre{}, scale{};
  bool logarithmic = false;
  double lower{}, upper{};  ///< bounds of u
  double step{};            ///< of u, for differences

  [[nodiscard]] double value(double u) const;
  [[nodiscard]] double coordinate(double value) const;
  void put(Hypothesis& hypothesis, double u) const;
  [[nodiscard]] double get(const Hypothesis& hypothesis) const;  ///< u
};

/// The tolerated parameters, within their bounds.
[[nodiscard]] std::vector<Unknown> tolerated_unknowns(const RigDescription& description);

/// The states at the beginnings of recordings that do not begin at rest.
[[nodiscard]] std::vector<Unknown> start_unknowns(const RigDescription& description,
                                                  const std::vector<Evidence>& evidence);

/// The parameters of an effect that is in the hypothesis.
[[nodiscard]] std::vector<Unknown> effect_unknowns(const PlacedEffect& effect);

/// "effects.sensor_lag.F.time_constant"
[[nodiscard]] std::string effect_path(const PlacedEffect& effect, std::size_t parameter);

}  // namespace host_sim::diagnose
