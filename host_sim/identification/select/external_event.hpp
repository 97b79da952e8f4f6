// Something acted on the rig from outside for a moment: a push, a knock.
#pragma once

#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// Looked for only where the best model leaves a rest (estimate/residual_over_time.hpp). A stretch of the recording
/// whose residuals stand far above those of all others, of a channel or of all together, is marked as not recorded,
/// until the motion that it left has died away; then the next one beside it, at most thresholds::most_events. Each must
/// be worth its own price in (1): beside a strong event nothing would be too weak to be one more. Slow motion is weak
/// in every short stretch: as long as a rest is left, thresholds::event_tail more is left out behind each, in the end
/// until no band of the whole record shows it. If that takes most of what the best model leaves away
/// (thresholds::left_beside_events), the model is selected again; and once more, with the stretches that a rig without
/// effects finds, where that leaves a rest: effects may have been bent to explain an event. The events are believed
/// where that is better by more than they cost,
///
///   (1)  χ²_again + penalties + Σ (n + effect + parameter · (2 + 2 B d)) < χ² + penalties
///   (2)  and where nothing but noise is left outside of them
///
/// n: residuals left out, which a free force explains; d: duration of the event; B: thresholds::event_bandwidth, so
/// that a force of any shape has 2 B d parameters. An effect that acts once (a stop that closes once) is cheaper and
/// keeps its name. (2): a law that is missing is loudest where the motion is, and quieter, but still there, elsewhere.
/// Events in a part that is held out are believed by (2) alone. When they were, the balances between channels say, of
/// what the new model leaves (parity/disturbed_span.hpp); where all of them hold, nothing acted from outside, and
/// where they fail more often than thresholds::most_events, it is the rig's own. `found`
/// and the problem become those without the events; they are added to `found.events`.
void leave_out_events(const firmware::RigDescription& description, IdentificationProblem& problem,
                      const SearchSpace& space, const ProgressCallback& progress, SearchResult& found);

}  // namespace host_sim::identification
