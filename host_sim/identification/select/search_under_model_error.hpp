// The search repeated for a rig that the catalogue does not hold as a whole.
#pragma once

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// In units of noise, details of what cannot be explained outweigh the effects that matter. Here the covariance of the
/// residuals (noise/whitening.hpp, ε_c) allows for an error of the model as large as the pooled error e of `found`:
///
///   1  on 24 s, the rig's own effects first; a model with a pooled error below 0.98 e replaces `found`
///   2  then with effects of sensors, which must leave a quarter less: several sensors bend any channel into place,
///      while what a rig does has one cause for all channels
///
/// Faults of the recording are no candidates here: they bend channels into place as sensors do.
///
/// A model that sensors would make and that is better, but not by a quarter, becomes a remark. true: `found` was
/// replaced. The problem keeps the input noise of what was found, without the model error.
[[nodiscard]] bool search_under_model_error(IdentificationProblem& problem, const SearchSpace& space,
                                            const ProgressCallback& progress, SearchResult& found);

}  // namespace host_sim::identification
