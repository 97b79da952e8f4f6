#include "tests/confusion/plan.hpp"

#include <map>

#include "tests/support/part_of.hpp"
#include "tests/truth/truth.hpp"

namespace confusion {

std::vector<Asked> plan(std::uint64_t first_seed) {
  const std::map<std::string, std::uint64_t> seeds{{"pair", 12}, {"triple", 4}, {"none", 10}};
  std::vector<Asked> all;
  for (const std::string& group : truth::groups()) {
    const std::string what = Asked{group}.what();
    const auto several = seeds.find(what);
    const std::uint64_t count = several == seeds.end() ? 1 : several->second;
    for (std::uint64_t k = 0; k < count; ++k) all.push_back({group, first_seed + k});
  }
  return all;
}

std::vector<Asked> part_of(const std::vector<Asked>& all, unsigned part, unsigned parts) {
  std::vector<Asked> chosen;
  for (const Asked& asked : all) {
    if (support::is_in_part(asked.id(), part - 1, parts)) chosen.push_back(asked);
  }
  return chosen;
}

}  // namespace confusion
