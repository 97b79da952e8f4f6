// Which recordings the confusion matrix is made of.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace confusion {

/// A recording of the truth generator: what is asked for, and the seed.
struct Asked {
  std::string group;
  std::uint64_t seed = 1;

  [[nodiscard]] std::string id() const { return group + ":" + std::to_string(seed); }
  /// "single", "pair", "triple", "none", "unknown"
  [[nodiscard]] std::string what() const { return group.substr(0, group.find(':')); }
};

/// All groups with the first seed; of each kind of rig pairs with 12 seeds, triples with 4 and rigs without any effect
/// with 10, one after the other from the first on: 235 recordings.
[[nodiscard]] std::vector<Asked> plan(std::uint64_t first_seed);

/// Those whose id hashes (FNV-1a) to part − 1 modulo `parts`: a part stays what it is when groups are added.
[[nodiscard]] std::vector<Asked> part_of(const std::vector<Asked>& all, unsigned part, unsigned parts);

}  // namespace confusion
