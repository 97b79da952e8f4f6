// The share of the cases that one process computes.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace host_sim::sweep {

/// One of `count` processes that share the cases of a sweep. Process i computes the cases
///
///   (1)  id mod count = i mod count
///
/// so a shard may be counted from 0 or from 1: 0/7 … 6/7 and 1/7 … 7/7 are the same seven shards.
struct Shard {
  std::uint64_t index = 0;  ///< below `count`
  std::uint64_t count = 1;

  [[nodiscard]] bool holds(std::uint64_t id) const { return id % count == index; }
  [[nodiscard]] std::string text() const { return std::to_string(index) + "/" + std::to_string(count); }
};

/// At most so many shards: a cluster's largest arrays have 10⁴ to 10⁵ tasks. Half would exclude some of them, twice
/// would only lengthen the message of a mistyped number.
inline constexpr std::uint64_t most_shards = 1'000'000;

/// "i/n" with n = 1 … most_shards and i ≤ n. UsageError otherwise.
[[nodiscard]] Shard parse_shard(std::string_view text);

/// Value of an environment variable, nullopt when it is not set.
using Environment = std::function<std::optional<std::string>(const char* name)>;
[[nodiscard]] std::optional<std::string> process_environment(const char* name);

/// The shard that a cluster's engine gave this process, nullopt outside of one.
///
///   array task   SLURM_ARRAY_TASK_ID, _MIN, _COUNT, _STEP; SGE_TASK_ID, _FIRST, _LAST, _STEPSIZE;
///                PBS_ARRAY_INDEX or PBS_ARRAYID with RIGTWIN_SHARDS, because PBS does not tell how many there are
///   MPI rank     OMPI_COMM_WORLD_RANK and _SIZE; PMI_RANK and PMI_SIZE
///
/// In an array task of several MPI ranks both count: index = task · ranks + rank. GNU parallel passes --shard {#}/n.
/// UsageError for a variable that is no number, and for a PBS array without RIGTWIN_SHARDS.
[[nodiscard]] std::optional<Shard> shard_of_engine(const Environment& environment);

}  // namespace host_sim::sweep
