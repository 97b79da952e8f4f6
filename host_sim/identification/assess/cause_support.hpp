// Whether the recordings bear out each cause of a model: how much of the error it explains, whether its size is known.
#pragma once

#include <vector>

#include "host_sim/identification/assess/named_effect.hpp"
#include "host_sim/identification/estimate/uncertainty.hpp"
#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// Error over all channels on held-out data, or the pooled error of the fitted windows where nothing is held out:
///
///   (1)  ln e = mean over channels of ½ ln(Σ(simulated − measured)²/Σ measured²)
///
/// A share of what is left counts alike in every channel, as in (2) of estimate/evidence.hpp far above the noise. In a
/// mean of squares the channel that no model explains would decide about all others: about the delay of a machine the
/// force of a component whose law is another one.
[[nodiscard]] double error_of_prediction(const IdentificationProblem& problem, Hypothesis hypothesis);

/// For each effect of a model the share of the held-out error (1) that goes when it is added, e_i: of the model without
/// it, all else refitted:
///
///   (2)  share_i = 1 − e/e_i                         negative where the effect raises the error
struct CauseSupport {
  std::vector<double> shares;  ///< of each effect
  /// That a cause which is none had explained as much of what is left anywhere (chance_of_share.hpp); 0 without a rest.
  std::vector<double> chances;
  std::vector<std::string> left_out;  ///< causes that left the model
};

/// Shares (2) of the effects of `found.best`. Beside a rest, causes that raise the held-out error by more than
/// thresholds::raises_error leave the model first, the worst before the others, all else refitted: what explains a
/// recording and spoils the next one is no explanation. `whole`: the problem on which errors are judged, machine and
/// component as one.
[[nodiscard]] CauseSupport support_of_causes(const IdentificationProblem& problem, const IdentificationProblem& whole,
                                             const SearchSpace& space, bool beside_a_rest, SearchResult& found);

/// The causes of a model with a parameter whose 95 % interval reaches both of its bounds: nothing is known of its size,
/// so it has no name. They leave the model, and all else is refitted. `known`: of `found.best.fit`.
[[nodiscard]] std::vector<Undetermined> leave_out_undetermined(const IdentificationProblem& problem,
                                                               const SearchSpace& space, const Uncertainty& known,
                                                               SearchResult& found);

}  // namespace host_sim::identification
