// A parameter that may move in a fit, as a coordinate with bounds and a trust radius.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/predict/hypothesis.hpp"

namespace host_sim::identification {

/// Whether an effect holds values: its period is read off the recording (hold_period()) and is not fitted.
[[nodiscard]] bool is_hold(const firmware::CatalogueEntry& entry);

/// A number to be found, by its coordinate u:
///
///   (1)  value = centre + scale · u      tolerated parameters, signed effect parameters, start states
///   (2)  value = scale · e^u             effect parameters that are positive
struct FreeParameter {
  enum class Role : unsigned char { tolerated, effect, start, fault, law } role;
  std::string path;                        ///< of tolerated and effect parameters
  std::size_t recording{};                 ///< of start states
  int state{};                             ///< of start states: z_w, ż_w, z_b, ż_b, y, ẏ
  std::optional<model::Channel> sensor{};  ///< of a sensor effect: only this channel's readings depend on it
  double centre{}, scale{};
  bool logarithmic = false;
  bool is_linear = false;                  ///< residuals are linear in it: a step of any length is trusted
  double lower{}, upper{};                 ///< bounds of u
  double difference{};                     ///< of u, for the Jacobian
  std::size_t fault{}, number{};           ///< of a fault: which of Hypothesis::faults, which of its values
  std::size_t law{};                       ///< which of Hypothesis::laws; `number`: which of its values
  std::vector<model::Channel> readings{};  ///< of a fault that costs no simulation: only these channels depend on it

  [[nodiscard]] double value(double u) const;
  [[nodiscard]] double coordinate(double value) const;
  /// How far from u the Jacobian is trusted: a factor of e, twice the value, three times the motion for a start state;
  /// without limit for what enters a channel linearly, or has narrow bounds.
  [[nodiscard]] double trust_radius(double u) const;
  /// Bounds of a step from u: those of u and a share `trust` of the trust radius. They always hold 0, also where
  /// another fit, with bounds of its own, has left u outside.
  struct StepBounds {
    double lower, upper;
  };
  [[nodiscard]] StepBounds step_bounds(double u, double trust) const;
  /// Whether another value asks for a simulation, and not only for other readings of what was simulated.
  [[nodiscard]] bool simulates() const { return !sensor && readings.empty(); }
  void put(Hypothesis& hypothesis, double u) const;
  [[nodiscard]] double get(const Hypothesis& hypothesis) const;  ///< u
  [[nodiscard]] bool at_bound(const Hypothesis& hypothesis) const;
};

/// The tolerated parameters of the explained part, within their bounds.
[[nodiscard]] std::vector<FreeParameter> tolerated_parameters(const firmware::RigDescription& description);

/// Every parameter of the explained part that is not 0, within a factor thresholds::parameter_range of what is
/// described.
[[nodiscard]] std::vector<FreeParameter> suspect_parameters(const firmware::RigDescription& description);
[[nodiscard]] std::vector<FreeParameter> parameters_of_part(const model::RigParameters<double>& explained);

/// The states at the beginnings of fitted recordings that do not begin at rest.
[[nodiscard]] std::vector<FreeParameter> start_parameters(const firmware::RigDescription& description,
                                                          const std::vector<PreparedRecording>& recordings);

/// True for a parameter of either sign that is no shape: what the effect does is proportional to its distance from
/// `neutral`, all else being as it is.
[[nodiscard]] bool is_proportional(const model::EffectParameter& card);

/// The range in which a parameter of an effect is fitted: the bounds of its card; of a factor on a reading no further
/// than thresholds::largest_factor from what changes nothing.
struct FitRange {
  double lower, upper;
};
[[nodiscard]] FitRange fit_range(const model::EffectParameter& card);

/// The parameters of an effect that is in the hypothesis, those that are to be fitted.
[[nodiscard]] std::vector<FreeParameter> effect_parameters(const firmware::PlacedEffect& effect);

/// The values of the faults of a recording that are to be fitted, in the order of the faults.
[[nodiscard]] std::vector<FreeParameter> fault_parameters(const std::vector<PlacedFault>& faults);

/// The values of learned laws, in the order of the laws.
[[nodiscard]] std::vector<FreeParameter> law_parameters(const std::vector<PlacedLaw>& laws);

/// What all models of a search share: where they begin and what is free in each of them.
struct SearchSpace {
  Hypothesis given;                       ///< the rig as described
  std::vector<FreeParameter> tolerated;   ///< first in every fit
  std::vector<FreeParameter> common;      ///< tolerated parameters, then start states
  std::vector<FreeParameter> suspects{};  ///< every parameter of the explained part, bound by no tolerance
};
[[nodiscard]] SearchSpace search_space(const firmware::RigDescription& description,
                                       const std::vector<PreparedRecording>& recordings, Hypothesis given);

}  // namespace host_sim::identification
