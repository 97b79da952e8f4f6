// Results are there complete or not at all, whatever interrupts or hinders the writing.
#include "firmware/recording/output_file.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/recording/recording.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;
using firmware::OutputError;
using firmware::OutputFile;
using firmware::write_file;
using support::TemporaryFolder;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const OutputError& error) {
    return error.what();
  }
  return "no error";
}

// The wait status of a forked copy of this process after the action.
int status_of_child(const std::function<void()>& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    action();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

// A disk of `bytes` bytes, for this process: more is refused with EFBIG, as a full one refuses it with ENOSPC.
void limit_file_size(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

// The purpose: nothing under the final name until all of it, and then nothing beside it.
TEST(OutputFile, AppearsCompleteOnCommit) {
  const TemporaryFolder folder;
  const std::string half(300000, 'x');
  OutputFile file(folder / "run.csv");
  file.write(half);
  file.write("|");
  file.write(half);
  EXPECT_FALSE(fs::exists(folder / "run.csv"));
  EXPECT_EQ(folder.count(), 1U);
  EXPECT_EQ(fs::path(file.temporary()).filename().string().front(), '.');
  file.commit();
  EXPECT_TRUE(TemporaryFolder::read(folder / "run.csv") == half + "|" + half);
  EXPECT_EQ(folder.count(), 1U);
}

// An exception on the way leaves what stood there before.
TEST(OutputFile, LeavesTheOldFileWhenNotCommitted) {
  const TemporaryFolder folder;
  folder.write("run.csv", "old");
  { OutputFile(folder / "run.csv").write("new"); }
  EXPECT_EQ(TemporaryFolder::read(folder / "run.csv"), "old");
  EXPECT_EQ(folder.count(), 1U);
  write_file(folder / "run.csv", "new");
  EXPECT_EQ(TemporaryFolder::read(folder / "run.csv"), "new");
}

// A file is created with the permissions that any program's would have, and a replaced one keeps its own.
TEST(OutputFile, HasTheUsualPermissionsAndKeepsThoseOfAReplacedFile) {
  const TemporaryFolder folder;
  const mode_t before = ::umask(027);
  write_file(folder / "run.csv", "1");
  ::umask(before);
  struct stat status {};
  ASSERT_EQ(::stat((folder / "run.csv").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
  fs::permissions(folder / "run.csv", fs::perms::owner_all);
  write_file(folder / "run.csv", "2");
  ASSERT_EQ(::stat((folder / "run.csv").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0700U);
}

// A link to the place where results are kept stays a link, whether its file exists already or not.
TEST(OutputFile, WritesBehindASymbolicLink) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "store");
  fs::create_symlink("store/run.csv", folder / "run.csv");
  for (const char* text : {"first", "second"}) {
    write_file(folder / "run.csv", text);
    EXPECT_TRUE(fs::is_symlink(folder / "run.csv"));
    EXPECT_EQ(TemporaryFolder::read(folder / "store" / "run.csv"), text);
  }
  EXPECT_EQ(folder.count(), 2U);
}

// The longest name a file may have leaves no room for a suffix.
TEST(OutputFile, TakesTheLongestFileName) {
  const TemporaryFolder folder;
  const std::string name(255, 'n');
  write_file(folder / name, "x");
  EXPECT_EQ(TemporaryFolder::read(folder / name), "x");
}

// The program may go elsewhere between opening and committing.
TEST(OutputFile, KeepsItsPlaceWhenTheWorkingFolderChanges) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  OutputFile file("run.csv");
  file.write("x");
  fs::current_path(before);
  file.commit();
  EXPECT_EQ(TemporaryFolder::read(folder / "run.csv"), "x");
}

// Places where nothing can be written are told at once, before hours of computing.
TEST(OutputFile, RefusesAFolderAMissingFolderAFileAsFolderAndNoName) {
  const TemporaryFolder folder;
  folder.write("file", "x");
  const auto message = [](const fs::path& file) { return message_of([&] { OutputFile{file}; }); };
  EXPECT_EQ(message(folder.path()), folder.path().string() + ": is a directory, expected the name of a file");
  EXPECT_EQ(message(folder.path().string() + "/"),
            folder.path().string() + "/: is a directory, expected the name of a file");
  EXPECT_EQ(message(folder / "none/run.csv"),
            (folder / "none/run.csv").string() +
                ": cannot be created: No such file or directory, expected an existing folder that may be written");
  EXPECT_EQ(message(folder / "file/run.csv"),
            (folder / "file/run.csv").string() +
                ": cannot be created: Not a directory, expected an existing folder that may be written");
  EXPECT_EQ(message(""), "'': cannot write to a file without a name, expected a file name");
  EXPECT_EQ(message("/proc/run.csv").find("/proc/run.csv: cannot be opened: "), 0U);
  EXPECT_EQ(message(folder / std::string(300, 'n')).find("File name too long") != std::string::npos, true);
  EXPECT_EQ(folder.count(), 1U);
}

// A folder or a file that may not be written, as any user but root finds it. Root drops to nobody for this.
TEST(OutputFile, RefusesWhatMayNotBeWritten) {
  const TemporaryFolder folder;
  folder.write("run.csv", "old");
  fs::permissions(folder / "run.csv", fs::perms::owner_read | fs::perms::others_read);
  fs::permissions(folder.path(), fs::perms::owner_all | fs::perms::others_read | fs::perms::others_exec);
  const int status = status_of_child([&] {
    if (::getuid() != 0 || ::setgid(65534) != 0 || ::setuid(65534) != 0) ::_exit(2);
    const std::string present = message_of([&] { OutputFile{folder / "run.csv"}; });
    const std::string absent = message_of([&] { OutputFile{folder / "new.csv"}; });
    const bool right = present.find("cannot be written: Permission denied") != std::string::npos &&
                       absent.find("cannot be created: Permission denied") != std::string::npos;
    ::_exit(right ? 0 : 1);
  });
  if (WEXITSTATUS(status) == 2) GTEST_SKIP() << "cannot become another user";
  EXPECT_EQ(status, 0);
  EXPECT_EQ(TemporaryFolder::read(folder / "run.csv"), "old");
}

// A device is written in place: it must not be replaced by a file. /dev/full is a disk that is always full.
TEST(OutputFile, WritesDevicesInPlaceAndTellsAFullDisk) {
  write_file("/dev/null", "x");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_EQ(message_of([] { write_file("/dev/full", "x"); }),
            "/dev/full: cannot be written: No space left on device, expected room for the whole file");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

// Piping a result on works: /dev/stdout names the pipe that the shell opened.
TEST(OutputFile, WritesToAPipe) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  write_file("/dev/fd/" + std::to_string(pipe[1]), "through");
  std::array<char, 16> text{};
  EXPECT_EQ(::read(pipe[0], text.data(), text.size()), 7);
  EXPECT_STREQ(text.data(), "through");
  ::close(pipe[0]);
  ::close(pipe[1]);
}

// … or the file: what `>> results` appends to is neither replaced nor overwritten.
TEST(OutputFile, AppendsToWhatTheShellOpened) {
  const TemporaryFolder folder;
  folder.write("results", "old");
  const int results = ::open((folder / "results").c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  write_file("/dev/fd/" + std::to_string(results), "new");
  ::close(results);
  EXPECT_EQ(TemporaryFolder::read(folder / "results"), "oldnew");
  EXPECT_EQ(folder.count(), 1U);
}

// A disk that fills up while writing – early, in the middle, with the very last byte – leaves the old file and no rest;
// CSV through our own writing, MATLAB through matio, which itself does not tell.
TEST(OutputFile, LeavesNothingHalfWrittenOnADiskThatFillsUp) {
  firmware::Recording run;
  run.time = firmware::sample_times(40000, 1000.0);
  run[model::Channel::F].assign(run.size(), 0.1);
  for (const char* name : {"run.csv", "run.mat"}) {
    const TemporaryFolder folder;
    host_sim::write_recording(folder / name, run);
    const auto whole = fs::file_size(folder / name);
    const std::string content = TemporaryFolder::read(folder / name);
    for (const auto size : {std::uintmax_t{0}, std::uintmax_t{100}, whole / 2, whole - 4096, whole - 1}) {
      const int status = status_of_child([&] {
        limit_file_size(size);
        const std::string message = message_of([&] { host_sim::write_recording(folder / name, run); });
        ::_exit(message.find(std::string(name) + ": cannot be ") != std::string::npos ? 0 : 1);
      });
      EXPECT_EQ(status, 0) << name << ' ' << size << " of " << whole;
      EXPECT_EQ(folder.count(), 1U) << name << ' ' << size;
      EXPECT_TRUE(TemporaryFolder::read(folder / name) == content) << name << ' ' << size;
    }
  }
}

// Interrupted by the user or the system the program still dies of the signal – its parent sees that – but tidies up.
TEST(OutputFile, IsRemovedByAnInterruptingSignal) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction present {};
    ASSERT_EQ(::sigaction(signal, nullptr, &present), 0);
    if (present.sa_handler == SIG_IGN) continue;  // a shell's background job and SIGINT: the next test's matter
    const TemporaryFolder folder;
    folder.write("run.csv", "old");
    const int status = status_of_child([&] {
      OutputFile first(folder / "run.csv");
      OutputFile second(folder / "report.html");
      first.write("x");
      static_cast<void>(std::raise(signal));
    });
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << signal;
    EXPECT_EQ(folder.count(), 1U) << signal;
    EXPECT_EQ(TemporaryFolder::read(folder / "run.csv"), "old");
  }
}

// A program started with an ignored hang-up (nohup) or with a handler of its own keeps that.
TEST(OutputFile, LeavesTheProgramsOwnSignalHandlingAlone) {
  const TemporaryFolder folder;
  const int status = status_of_child([&] {
    std::signal(SIGINT, SIG_IGN);
    write_file(folder / "run.csv", "x");
    static_cast<void>(std::raise(SIGINT));
    ::_exit(7);
  });
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7);
}

// A forked child that is stopped does not take its parent's files with it.
TEST(OutputFile, SurvivesTheEndOfAForkedChild) {
  const TemporaryFolder folder;
  OutputFile file(folder / "run.csv");
  file.write("x");
  EXPECT_NE(status_of_child([] { static_cast<void>(std::raise(SIGTERM)); }), 0);
  file.commit();
  EXPECT_EQ(TemporaryFolder::read(folder / "run.csv"), "x");
}

// The signal handler's table is finite: beyond it there is an error, and room again afterwards.
TEST(OutputFile, RefusesTooManyAtOnce) {
  const TemporaryFolder folder;
  for (int round = 0; round < 3; ++round) {
    std::vector<std::unique_ptr<OutputFile>> files;
    const std::string message = message_of([&] {
      for (int i = 0; i < 1000; ++i) files.push_back(std::make_unique<OutputFile>(folder / std::to_string(i)));
    });
    EXPECT_NE(message.find("too many files are being written at once, expected at most 32"), std::string::npos);
    EXPECT_EQ(files.size(), 32U);
  }
  EXPECT_EQ(folder.count(), 0U);
}

}  // namespace
