// broken COUNT NAME… -- plays the fault campaign with one broken safety function after the other, until a scenario of COUNT notices it.
#include <sys/wait.h>
#include <unistd.h>

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
  for (int broken = 1; broken <= functions; ++broken) {
    std::fflush(stdout);
    const pid_t child = ::fork();  // a broken function may end the program: that is noticed as well
    if (child == 0) {
      rigtwin_break = broken;
      std::string violation;
      std::uint64_t seed = 0;
      while (violation.empty() && seed < count) violation = faults::Trial(++seed).play();
      const std::string where = "seed " + std::to_string(seed) + ": " + violation.substr(0, violation.find(" ["));
      std::printf("%-40s %s\n", argv[broken + 1], violation.empty() ? "not noticed" : where.c_str());
      std::fflush(stdout);
      ::_exit(violation.empty() ? 1 : 0);
    }
    int status = -1;
    ::waitpid(child, &status, 0);
    noticed += status == 0 || WIFSIGNALED(status) ? 1 : 0;
    if (WIFSIGNALED(status)) std::printf("%-40s ended by signal %d\n", argv[broken + 1], WTERMSIG(status));
  }
  std::printf("%d of %d noticed by %llu scenarios\n", noticed, functions, static_cast<unsigned long long>(count));
  return 10 * noticed >= 7 * functions ? 0 : 1;
}
