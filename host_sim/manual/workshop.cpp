#include "host_sim/manual/workshop.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <system_error>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::manual {
namespace {

namespace fs = std::filesystem;

constexpr int not_started = 127;

[[noreturn]] void run_shell(const fs::path& folder, const Workshop::Setting& setting, const std::string& commands,
                            int output) {
  const char* const path = std::getenv("PATH");
  ::setenv("PATH", (setting.programs.string() + ":" + (path == nullptr ? "/usr/bin:/bin" : path)).c_str(), 1);
  ::setenv("LC_ALL", "C.UTF-8", 1);
  for (const std::string& variable : setting.variables) {
    const std::size_t equals = variable.find('=');
    ::setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
  }
  if (::chdir(folder.c_str()) != 0 || ::dup2(output, STDOUT_FILENO) < 0 || ::dup2(output, STDERR_FILENO) < 0) {
    ::_exit(not_started);
  }
  ::execl("/bin/sh", "sh", "-e", "-c", commands.c_str(), static_cast<char*>(nullptr));
  ::_exit(not_started);
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t got = ::read(descriptor, part.data(), part.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

Workshop::Workshop(const Setting& setting) : setting_(setting) {
  setting_.programs = fs::absolute(setting_.programs);
  std::string name = (fs::temp_directory_path() / "rigtwin_manual_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw firmware::OutputError(name, "cannot be made", "a folder for the commands of the manual");
  }
  folder_ = name;
}

Workshop::~Workshop() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

Workshop::Ended Workshop::run(const std::string& commands) {
  std::array<int, 2> pipe{};
  if (::pipe(pipe.data()) != 0) throw std::system_error(errno, std::generic_category(), "no pipe for a command");
  const pid_t id = ::fork();
  if (id < 0) throw std::system_error(errno, std::generic_category(), "no process for a command");
  if (id == 0) {
    ::close(pipe[0]);
    run_shell(folder_, setting_, commands, pipe[1]);
  }
  ::close(pipe[1]);
  Ended ended;
  ended.output = read_all(pipe[0]);
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(id, &status, 0) < 0 && errno == EINTR) {
  }
  ended.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return ended;
}

}  // namespace host_sim::manual
