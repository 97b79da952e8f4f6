// rigtwin_faults [COUNT [FIRST SEED]] -- plays scenarios of the fault campaign and prints each violation. Every tenth
// is played through a session of rig_controller as well, for its status and its recording, every other one of these with
// an operator and all checks of arming. From the root of the tree.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/faults/campaign.hpp"
#include "tests/faults/session_trial.hpp"

int main(int argc, char** argv) {
  const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 2000;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::array<unsigned, static_cast<std::size_t>(firmware::last_reason) + 1> reasons{};
  decltype(reasons) session_reasons{};
  unsigned violated = 0, runs = 0, sessions = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    faults::Trial trial(seed);
    const std::string violation = trial.play();
    if (!violation.empty()) std::printf("seed %llu: %s\n", static_cast<unsigned long long>(seed), violation.c_str());
    violated += violation.empty() ? 0 : 1;
    runs += trial.has_run() ? 1 : 0;
    ++reasons[static_cast<std::size_t>(trial.reason())];
    if (seed % 10 != 0) continue;
    const faults::SessionEnd end = faults::play_session(seed, seed % 20 == 0);
    if (!end.violated.empty()) {
      std::printf("seed %llu, session: %s\n", static_cast<unsigned long long>(seed), end.violated.c_str());
    }
    violated += end.violated.empty() ? 0 : 1;
    ++sessions;
    ++session_reasons[static_cast<std::size_t>(end.reason)];
  }
  std::printf("  %-24s scenarios  sessions\n", "ended by");
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    if (reasons[i] == 0 && session_reasons[i] == 0) continue;
    std::printf("  %-24s %9u %9u\n", std::string(name(static_cast<firmware::Reason>(i))).c_str(), reasons[i],
                session_reasons[i]);
  }
  std::printf("%llu scenarios, %u with a run, %u sessions, %u violations\n", static_cast<unsigned long long>(count),
              runs, sessions, violated);
  return violated == 0 ? 0 : 1;
}
