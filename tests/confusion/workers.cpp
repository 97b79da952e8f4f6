#include "tests/confusion/workers.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace confusion {
namespace {

struct Worker {
  std::size_t which;
  int pipe;
};

/// An outcome as text fits into a pipe (64 KiB), so the child can write it and end before anyone reads.
std::pair<pid_t, int> begin(const Asked& asked, const truth::Wanted& wanted, unsigned most_seconds,
                            bool compare_models) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  const pid_t id = ::fork();
  if (id < 0) throw std::runtime_error("no process");
  if (id > 0) {
    ::close(ends[1]);
    return {id, ends[0]};
  }
  ::close(ends[0]);
  ::alarm(most_seconds);
  const std::string text = to_json(run(asked, wanted, compare_models)).dump();
  const bool written = ::write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size());
  ::_exit(written ? 0 : 1);
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> block{};
  for (ssize_t n = 0; (n = ::read(descriptor, block.data(), block.size())) > 0;) {
    text.append(block.data(), static_cast<std::size_t>(n));
  }
  ::close(descriptor);
  return text;
}

Outcome outcome_of(const Asked& asked, const std::string& text, int status) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return outcome_from(nlohmann::ordered_json::parse(text));
  Outcome failed;
  failed.asked = asked;
  failed.failure = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM ? "took too long" : "the program ended";
  return failed;
}

}  // namespace

std::vector<Outcome> run_all(const std::vector<Asked>& asked, const truth::Wanted& wanted, std::size_t jobs,
                             unsigned most_seconds, const std::function<void(const Outcome&)>& tell,
                             bool compare_models) {
  std::vector<Outcome> outcomes(asked.size());
  std::map<pid_t, Worker> working;
  std::size_t next = 0;
  while (next < asked.size() || !working.empty()) {
    if (next < asked.size() && working.size() < jobs) {
      std::fflush(nullptr);
      const auto [id, pipe] = begin(asked[next], wanted, most_seconds, compare_models);
      working[id] = {next++, pipe};
      continue;
    }
    int status = 0;
    const pid_t id = ::waitpid(-1, &status, 0);
    const auto it = working.find(id);
    if (it == working.end()) throw std::runtime_error("lost a process");
    const Worker worker = it->second;
    working.erase(it);
    outcomes[worker.which] = outcome_of(asked[worker.which], read_all(worker.pipe), status);
    if (tell) tell(outcomes[worker.which]);
  }
  return outcomes;
}

}  // namespace confusion
