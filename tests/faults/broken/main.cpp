// broken COUNT NAME… -- plays the fault campaign with one broken safety function after the other, until a scenario of COUNT notices it.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/faults/broken/broken.hpp"
#include "tests/faults/campaign.hpp"

int rigtwin_break = 0;

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 300;
  const int functions = argc - 2;
  int wrong = 0, noticed = 0;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const std::string violation = faults::Trial(seed).play();
    if (violation.empty()) continue;
    std::printf("the sound loop, seed %llu: %s\n", static_cast<unsigned long long>(seed), violation.c_str());
    ++wrong;
  }
  if (wrong > 0 || functions < 1) return 1;
  for (rigtwin_break = 1; rigtwin_break <= functions; ++rigtwin_break) {
    std::string violation;
    std::uint64_t seed = 0;
    while (violation.empty() && seed < count) violation = faults::Trial(++seed).play();
    noticed += violation.empty() ? 0 : 1;
    const std::string where = "seed " + std::to_string(seed) + ": " + violation.substr(0, violation.find(" ["));
    std::printf("%-40s %s\n", argv[rigtwin_break + 1], violation.empty() ? "not noticed" : where.c_str());
  }
  std::printf("%d of %d noticed by %llu scenarios\n", noticed, functions, static_cast<unsigned long long>(count));
  return 10 * noticed >= 7 * functions ? 0 : 1;
}
