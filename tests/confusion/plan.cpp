#include "tests/confusion/plan.hpp"

#include "tests/truth/truth.hpp"

namespace confusion {

std::vector<Asked> plan(std::uint64_t first_seed) {
  constexpr std::uint64_t seeds_of_pairs = 12, seeds_of_none = 10;
  std::vector<Asked> all;
  for (const std::string& group : truth::groups()) {
    const std::string what = Asked{group}.what();
    const std::uint64_t seeds = what == "pair" ? seeds_of_pairs : (what == "none" ? seeds_of_none : 1);
    for (std::uint64_t k = 0; k < seeds; ++k) all.push_back({group, first_seed + k});
  }
  return all;
}

std::vector<Asked> part_of(const std::vector<Asked>& all, unsigned part, unsigned parts) {
  std::vector<Asked> chosen;
  for (const Asked& asked : all) {
    std::uint64_t hash = 0xCBF29CE484222325U;
    for (const char c : asked.id()) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3U;
    if ((hash >> 32U) % parts == part - 1) chosen.push_back(asked);
  }
  return chosen;
}

}  // namespace confusion
