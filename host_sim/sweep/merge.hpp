// The results of all shards as one table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/sweep/result_file.hpp"

namespace host_sim::sweep {

/// Reads the files of all shards side by side, each by ascending ids, and passes on every line, case 0 first. Proves
/// that no case is missing and none is there twice. Time ∝ cases · log(files); memory: one line of each file.
///
/// InputError: no file of results, files of different plans, a damaged line, a case that two files hold, missing cases
/// (how many, the first, and the shards that hold them). Nothing is passed on before all of this has been checked.
CaseSet merge(const std::filesystem::path& folder, const std::function<void(const ResultReader::Line&)>& take);

/// Mean, spread and range of one number over the cases.
struct Spread {
  std::string name;
  std::uint64_t count = 0;
  double mean = 0.0, squares = 0.0;  ///< Σ (x − mean)², by Welford's recursion
  double lowest = 0.0, highest = 0.0;

  void add(double value);
  [[nodiscard]] double standard_deviation() const;
};

struct Merged {
  CaseSet cases;
  std::uint64_t failed = 0;
  std::string first_failure;    ///< why, of the first case that failed
  std::vector<Spread> numbers;  ///< of every numeric key but id and seed, in the order of the lines
  std::filesystem::path json, csv;
};

/// merge() into folder/results.jsonl (the lines) and folder/results.csv (a row a case, a column a key; a cell that a
/// failed case lacks is empty). Both appear whole or not at all, and their bytes do not depend on the shards.
[[nodiscard]] Merged merge_into_files(const std::filesystem::path& folder);

}  // namespace host_sim::sweep
