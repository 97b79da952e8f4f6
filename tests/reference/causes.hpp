// The hypothesis space: causes that may be missing, where a fit of each begins, how widely it was spread before.
#pragma once

#include <vector>

#include "tests/reference/prediction.hpp"

namespace reference {

/// −ln prior of a cause: one of thirty effects. A positive parameter is spread over four decades, one of either sign over
/// two of the sizes at which its fit starts.
inline constexpr double log_prior_of_cause = 3.4, width_of_logarithm = 9.2, width_in_sizes = 2.0;

/// A number that is fitted, by its coordinate u:
///
///   (9)  tolerated: in units of the tolerance;   positive: value = e^u;   of either sign: value = neutral + size · u
struct Parameter {
  std::size_t cause, number;  ///< of a model's causes; of a tolerated one `number` alone counts
  bool tolerated = false, logarithmic = false;
  double neutral = 0.0, size = 1.0, lower = -1.0, upper = 1.0;  ///< bounds of u

  [[nodiscard]] double width() const;
  [[nodiscard]] double get(const Model& model) const;
  void put(Model& model, double u) const;
};

/// The tolerated parameters, then those of the causes.
[[nodiscard]] std::vector<Parameter> parameters_of(const Model& model, const Measured& measured,
                                                   const model::MotionScales& scales);

/// How large things are in a recording and the rig's prediction of it, in which cards give starts.
[[nodiscard]] model::MotionScales scales_of(const Rig& rig, const Measured& measured, const host_sim::Response& predicted);

/// Every cause that has a place on the rig, with each of its card's starts.
[[nodiscard]] std::vector<Cause> candidates(const Rig& rig, const Measured& measured, const model::MotionScales& scales);

}  // namespace reference
