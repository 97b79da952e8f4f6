// rigtwin_faults [COUNT [FIRST SEED]] -- plays scenarios of the fault campaign and prints each violation.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/faults/campaign.hpp"

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 2000;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::array<unsigned, static_cast<std::size_t>(firmware::last_reason) + 1> reasons{};
  unsigned violated = 0, runs = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    faults::Trial trial(seed);
    const std::string violation = trial.play();
    if (!violation.empty()) std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), violation.c_str());
    violated += violation.empty() ? 0 : 1;
    runs += trial.has_run() ? 1 : 0;
    ++reasons[static_cast<std::size_t>(trial.reason())];
  }
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    if (reasons[i] == 0) continue;
    std::printf("  %-24s %u\n", std::string(name(static_cast<firmware::Reason>(i))).c_str(), reasons[i]);
  }
  std::printf("%llu scenarios, %u with a run, %u violations\n", static_cast<unsigned long long>(count), runs, violated);
  return violated == 0 ? 0 : 1;
}
