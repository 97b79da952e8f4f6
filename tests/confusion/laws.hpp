// Laws that no catalogue holds: which answer is right, and a line of figures for each law.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/identification/assess/diagnosis_result.hpp"
#include "tests/confusion/outcome.hpp"
#include "tests/truth/truth.hpp"

namespace confusion {

/// Every law of the generator on every kind of rig, `count` of each from 100 · seed on; as many rigs without any, and
/// each effect of the component once.
[[nodiscard]] std::vector<Asked> laws_plan(std::uint64_t seed, std::size_t count);

/// Completes an outcome of judged() by what is said of the law: README.
void judge_law(Outcome& outcome, const truth::Truth& truth, const host_sim::identification::Diagnosis& diagnosis);

/// For people: a line for each law, and one for each recording whose law is not recognised or leaves a rest.
[[nodiscard]] std::string laws_text(const std::vector<Outcome>& outcomes);

}  // namespace confusion
