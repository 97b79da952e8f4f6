// The cases of one shard, computed on several processors and written in order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "host_sim/sweep/result_file.hpp"
#include "host_sim/sweep/shard.hpp"

namespace host_sim::sweep {

struct ShardWork {
  std::uint64_t cases = 0;   ///< of the shard
  std::uint64_t before = 0;  ///< of them done earlier, by whichever shard
  std::uint64_t now = 0;     ///< computed now
};

/// The result line of a case, without its end. Called from several threads at once.
using LineOfCase = std::function<std::string(std::uint64_t id)>;

/// Called after each written line with the cases of this shard that are done.
using ShardProgress = std::function<void(const ShardWork&)>;

/// Computes the cases of a shard that no file of the folder holds yet, `jobs` at a time, and appends their lines to the
/// shard's file by ascending id. A process that is killed and started again goes on where it was. Memory: a bit a case,
/// and at most 64 lines that wait for a slower one before them.
/// Errors of ResultFile; what `line_of` throws ends the work after the lines before it are written.
ShardWork run_cases(const CaseSet& cases, const Shard& shard, const std::filesystem::path& folder, std::size_t jobs,
                    const LineOfCase& line_of, const ShardProgress& progress = {});

}  // namespace host_sim::sweep
