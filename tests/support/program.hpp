// The program rigtwin as a user's shell meets it: arguments in, exit status and two streams out.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/json_schema.hpp"
#include "tests/support/temporary_folder.hpp"

namespace support {

/// How a program ended.
struct Ended {
  int status = -1;     ///< exit status; −n: by signal n
  std::string output;  ///< standard output
  std::string errors;  ///< standard error

  [[nodiscard]] std::ptrdiff_t error_lines() const { return std::count(errors.begin(), errors.end(), '\n'); }
};

/// A program that runs, its streams going to files of `folder`, or its output to `output` instead.
class RunningProgram {
 public:
  RunningProgram(const TemporaryFolder& folder, const std::vector<std::string>& arguments,
                 const std::filesystem::path& output = {}, const char* program = RIGTWIN_PROGRAM)
      : output_(output.empty() ? folder / "stdout.txt" : output), errors_(folder / "stderr.txt") {
    std::vector<std::string> words{program};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    id_ = ::fork();
    if (id_ < 0) throw std::runtime_error("no process");
    if (id_ == 0) {
      const int out = ::open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      const int err = ::open(errors_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      if (out < 0 || err < 0 || ::dup2(out, STDOUT_FILENO) < 0 || ::dup2(err, STDERR_FILENO) < 0) ::_exit(126);
      ::execv(program, argv.data());
      ::_exit(127);
    }
  }

  [[nodiscard]] pid_t id() const { return id_; }

  [[nodiscard]] bool running() {
    if (!ended_) ended_ = ::waitpid(id_, &wait_status_, WNOHANG) == id_;
    return !ended_;
  }

  [[nodiscard]] Ended wait() {
    if (!ended_) ended_ = ::waitpid(id_, &wait_status_, 0) == id_;
    Ended ended;
    ended.status = WIFEXITED(wait_status_) ? WEXITSTATUS(wait_status_) : -WTERMSIG(wait_status_);
    if (std::filesystem::is_regular_file(output_)) ended.output = TemporaryFolder::read(output_);
    ended.errors = TemporaryFolder::read(errors_);
    return ended;
  }

 private:
  std::filesystem::path output_;
  std::filesystem::path errors_;
  pid_t id_ = -1;
  bool ended_ = false;
  int wait_status_ = 0;
};

/// A program that does not outlive its test, however the test ends.
class GuardedProgram : public RunningProgram {
 public:
  using RunningProgram::RunningProgram;
  GuardedProgram(const GuardedProgram&) = delete;
  GuardedProgram& operator=(const GuardedProgram&) = delete;
  ~GuardedProgram() {
    if (!running()) return;
    ::kill(id(), SIGKILL);
    static_cast<void>(wait());
  }
};

/// Runs the program to its end. What it then writes as --json agrees with its schema.
inline Ended rigtwin(const std::vector<std::string>& arguments, const std::filesystem::path& output = {}) {
  const TemporaryFolder streams;
  Ended ended = RunningProgram(streams, arguments, output).wait();
  const auto json = std::find(arguments.begin(), arguments.end(), "--json");
  if (ended.status == 0 && json != arguments.end() && json + 1 != arguments.end()) {
    if (json[1] == "-") {
      expect_schema(ended.output);
    } else if (std::filesystem::is_regular_file(json[1])) {
      expect_schema(TemporaryFolder::read(json[1]));
    }
  }
  return ended;
}

}  // namespace support
