// Something acted on the rig from outside for a moment: a push, a knock.
#pragma once

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// Looked for only where the best model leaves a rest (estimate/residual_over_time.hpp). A stretch of the recording
/// whose residuals stand far above those of all others, of a channel or of all together, is marked as not recorded,
/// until the motion that it left has died away, and the model is selected again. The event is believed where that is
/// better by more than it costs,
///
///   (1)  χ²_again + penalties + n + effect + parameter · (2 + 2 B d) < χ² + penalties
///
/// n: residuals left out, which a free force explains; d: duration of the event; B: thresholds::event_bandwidth, so
/// that a force of any shape has 2 B d parameters. An effect that acts once (a stop that closes once) is cheaper and
/// keeps its name. An event in a part that is held out is believed where the rest goes away with it. `found` and the
/// problem become those without the event; it is added to `found.events`. Repeated, at most thresholds::most_events
/// times.
void leave_out_events(const firmware::RigDescription& description, IdentificationProblem& problem,
                      const SearchSpace& space, const ProgressCallback& progress, SearchResult& found);

}  // namespace host_sim::identification
