#include "host_sim/identification/diagnosis.hpp"

#include <utility>

#include "host_sim/identification/assess/assess.hpp"
#include "host_sim/identification/parity/parity_residual.hpp"
#include "host_sim/identification/select/select_model.hpp"

namespace host_sim::identification {

Diagnosis diagnose(const firmware::RigDescription& description, std::vector<Record> records,
                   const ProgressCallback& progress) {
  PreparedData data = prepare(description, std::move(records));                                       // prepare/
  const Hypothesis given = described_hypothesis(description, data.recordings);                        // predict/
  IdentificationProblem problem(std::move(data.recordings), given);                                   // noise/
  std::vector<ParityResidual> relations = parity_residuals(description, problem.samples());           // parity/
  const SearchSpace space = search_space(description, problem.samples(), given);                      // estimate/
  SearchResult found = select_model(problem, space, progress);                                        // select/
  Diagnosis diagnosis = assess(description, problem, space, std::move(relations), std::move(found));  // assess/
  diagnosis.remarks.insert(diagnosis.remarks.begin(), data.remarks.begin(), data.remarks.end());
  return diagnosis;  // report/ writes it down
}

}  // namespace host_sim::identification
