// Tests whether a fit leaves more than noise.
#pragma once

#include <string>

#include "host_sim/identification/estimate/fit.hpp"
#include "host_sim/identification/estimate/residual_over_time.hpp"
#include "host_sim/identification/estimate/unexplained_residual.hpp"

namespace host_sim::identification {

/// Both tests of what is left. What only held-out windows leave may be what the others did not say of the parameters: a
/// sine that excites a resonance for the first time. So it must be there after a fit to all windows, too.
struct LeftByFit {
  UnexplainedResidual by_band;
  Rest by_time;

  [[nodiscard]] bool any() const { return by_band.significant || by_time.found(); }
  [[nodiscard]] std::string words() const;  ///< empty: nothing is left
};
[[nodiscard]] LeftByFit left_by(const IdentificationProblem& problem, const Fit& fitted);

}  // namespace host_sim::identification
