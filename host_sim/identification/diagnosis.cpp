#include "host_sim/identification/diagnosis.hpp"

#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "host_sim/identification/assess/assess.hpp"
#include "host_sim/identification/learn/learn_laws.hpp"
#include "host_sim/identification/parity/parity_residual.hpp"
#include "host_sim/identification/select/budget.hpp"
#include "host_sim/identification/select/external_event.hpp"
#include "host_sim/identification/select/rival_parameters.hpp"
#include "host_sim/identification/select/select_model.hpp"

namespace host_sim::identification {
namespace {

/// InputError where the simulation of the rig as described does not stay finite: nothing can be held against it.
void require_finite(const firmware::RigDescription& description, const PreparedData& data, const Hypothesis& given) {
  for (std::size_t i = 0; i < data.recordings.size(); ++i) {
    const PreparedRecording& r = data.recordings[i];
    const Response readings = read_channels(given, r, r.input, given.starts[i], 0, {r.substeps});
    if (stays_finite(r, readings)) continue;
    throw firmware::InputError(description.source, 0, "its simulation grows without bound on " + r.recording.source,
                               "a rig that is stable on the recorded input");
  }
}

/// InputError where a recording holds nothing but noise.
void require_motion(const IdentificationProblem& problem) {
  for (const ProblemRecording& r : problem.recordings()) {
    if (r.holds_motion()) continue;
    throw firmware::InputError(r.samples->recording.source, 0,
                               "holds nothing but noise: no channel moves by half of its noise",
                               "a recording in which the rig is excited");
  }
}

/// Events and laws for what the effects leave. An event explains whatever it covers: where a law is found beside
/// events, it may be what they were, since a law that is missing shows where the motion is largest. Learned from
/// everything, it takes their place if it leaves nothing but noise.
Learned explain_rest(const firmware::RigDescription& description, IdentificationProblem& problem,
                     const SearchSpace& space, const ProgressCallback& progress, SearchResult& found) {
  if (!may_begin(problem, "events from outside and laws")) return {};
  if (!leaves_a_rest(problem, found)) return learn_laws(problem, space, progress, found);
  IdentificationProblem whole = problem;
  SearchResult without_events = found;
  leave_out_events(description, problem, space, progress, found);  // select/
  Learned learned = learn_laws(problem, space, progress, found);   // learn/
  if (!learned.found || found.events.empty()) return learned;
  Learned from_all = learn_laws(whole, space, progress, without_events);
  if (!from_all.found || leaves_a_rest(whole, without_events)) return learned;
  problem = std::move(whole);
  found = std::move(without_events);
  return from_all;
}

}  // namespace

Identified identify(const firmware::RigDescription& description, std::vector<Record> records,
                    const ProgressCallback& progress) {
  PreparedData data = prepare(description, std::move(records));                 // prepare/
  const Hypothesis given = described_hypothesis(description, data.recordings);  // predict/
  require_finite(description, data, given);
  IdentificationProblem problem(std::move(data.recordings), given);  // noise/
  require_motion(problem);
  std::vector<ParityResidual> relations = parity_residuals(description, problem.samples());         // parity/
  SearchSpace space = search_space(description, problem.samples(), given);                          // estimate/
  SearchResult found = select_model(problem, space, progress);                                      // select/
  Learned learned = explain_rest(description, problem, space, progress, found);                     // learn/
  if (may_begin(problem, "parameters as rivals")) find_rival_parameters(problem, space, found);     // select/
  Diagnosis diagnosis = assess(description, problem, space, std::move(relations), found, learned);  // assess/
  diagnosis.remarks.insert(diagnosis.remarks.begin(), data.remarks.begin(), data.remarks.end());
  return {std::move(problem), std::move(space), std::move(found), std::move(learned), std::move(diagnosis)};
}

Diagnosis diagnose(const firmware::RigDescription& description, std::vector<Record> records,
                   const ProgressCallback& progress) {
  return identify(description, std::move(records), progress).diagnosis;  // report/ writes it down
}

}  // namespace host_sim::identification
