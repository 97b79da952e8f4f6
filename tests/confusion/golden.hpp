// What was right when it was last recorded, and whether it still is.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tests/confusion/outcome.hpp"
#include "tests/confusion/table.hpp"

namespace confusion {

/// How a run was asked for: seed of the first records, their length [s], weak effects.
struct Run {
  std::uint64_t seed = 1;
  truth::Wanted wanted;
};

/// Date, run, table, and one short entry for each recording.
[[nodiscard]] nlohmann::ordered_json golden_copy(const Run& run, const std::string& date, const Table& table,
                                                 const std::vector<Outcome>& outcomes);

/// What got worse against the golden copy, over the recordings that are in both: fewer right in a category (single,
/// pair, none, unknown), more wrong names above 0.5. Empty: nothing. Another run than the golden copy's says so.
[[nodiscard]] std::vector<std::string> regressions(const Run& run, const std::vector<Outcome>& outcomes,
                                                   const nlohmann::ordered_json& golden);

/// Where no golden copy is: fewer than nine of ten right in a category with ten recordings or more, or four of five in
/// one with fewer.
[[nodiscard]] std::vector<std::string> shortfalls(const Table& table);

}  // namespace confusion
