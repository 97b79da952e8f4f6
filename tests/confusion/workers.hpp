// Many recordings at once, each in a process of its own.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "tests/confusion/outcome.hpp"

namespace confusion {

/// Outcomes in the order of `asked`. A process that ends by itself, or takes more than `most_seconds`,
/// is a failure of that recording and of no other. `tell` hears of each as it is done.
[[nodiscard]] std::vector<Outcome> run_all(const std::vector<Asked>& asked, const truth::Wanted& wanted,
                                           std::size_t jobs, unsigned most_seconds,
                                           const std::function<void(const Outcome&)>& tell,
                                           bool compare_models = false);

}  // namespace confusion
