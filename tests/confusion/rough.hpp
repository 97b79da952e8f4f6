// Rigs that are not as described: what is right there, and a line of figures for each condition.
#pragma once

#include <string>
#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "tests/confusion/outcome.hpp"
#include "tests/truth/truth.hpp"

namespace confusion {

/// Recordings of the named conditions (empty: all), `count` of each, from 100 · seed on.
[[nodiscard]] std::vector<Asked> rough_plan(std::uint64_t seed, std::size_t count, const std::string& condition);

/// What hides beside the effects, into an outcome that judged() or nobody has filled yet.
void describe_rough(Outcome& outcome, const truth::Truth& truth);

/// Completes an outcome of judged(): parameters off, faults of the recording, and what is right under the condition.
void judge_rough(Outcome& outcome, const truth::Truth& truth, const host_sim::identification::Diagnosis& diagnosis);

/// For people: a line for each condition, and one for each recording that is not right.
[[nodiscard]] std::string rough_text(const std::vector<Outcome>& outcomes);

}  // namespace confusion
