// A search on a bench of which all is known.
#pragma once

#include <utility>
#include <vector>

#include "host_sim/identification/select/search.hpp"
#include "tests/host_sim/identification/sample_problem.hpp"

namespace sample {

/// A bench against a recording of 8 s, its last quarter held out.
struct Bench {
  explicit Bench(const firmware::RigDescription& truth, double seconds = 8.0)
      : Bench(sample::prepared(sample::bench(), truth, host_sim::identification::Use::shared, seconds)) {}

  host_sim::identification::Hypothesis given;
  host_sim::identification::IdentificationProblem problem;
  host_sim::identification::SearchSpace space;

 private:
  explicit Bench(std::vector<host_sim::identification::PreparedRecording> recordings)
      : given(described_hypothesis(sample::bench(), recordings)),
        problem(std::move(recordings), given),
        space(search_space(sample::bench(), problem.samples(), given)) {}
};

}  // namespace sample
