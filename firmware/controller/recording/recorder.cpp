#include "firmware/controller/recording/recorder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/sha256.hpp"
#include "firmware/recording/recording.hpp"

namespace firmware::controller {
namespace {

constexpr double standing_rows = 1.0;  // [s] of standing still in safe that are recorded; waiting may take hours

/// The file's text as comments, with its hash. Empty if it is gone.
std::string as_comments(std::string_view what, const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) return {};
  std::string comments = "# " + std::string(what) + ": " + one_line(file) + ", SHA-256 " + sha256(text.str()) +
                         "; its text, behind '|':\n";
  std::istringstream lines(text.str());
  for (std::string line; std::getline(lines, line);) comments += "# | " + line + "\n";
  return comments;
}

/// Opens a new file; an existing one only if it may be overwritten, or is no regular file (a pipe, /dev/null).
int open_new(const std::string& file, bool overwrite) {
  struct stat status {};
  const bool replaces = ::stat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode);
  if (replaces && !overwrite) {
    errno = EEXIST;
    return -1;
  }
  return ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

}  // namespace

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string part_name(const std::string& file, std::uint64_t part) {
  if (part <= 1) return file;
  const std::filesystem::path whole(file);
  char number[32];
  std::snprintf(number, sizeof number, "-%04llu", static_cast<unsigned long long>(part));
  return (whole.parent_path() / (whole.stem().string() + number + whole.extension().string())).string();
}

Recorder::Recorder(const Setup& setup, const RigDescription& rig, const hal::SensorSetup& sensors, std::string& trouble)
    : setup_(setup), columns_(rig, sensors), description_(as_comments("description", rig.source)) {
  for (const std::filesystem::path& file : referenced_files(rig)) description_ += as_comments("table", file.string());
  if (!setup.programme.empty()) description_ += as_comments("programme", setup.programme);
  if (open_part() && flush()) return;
  trouble = setup_.file + ": " + std::strerror(error()) +
            (error() == EEXIST ? ", expected a new name or --overwrite" : ", expected a file that can be written");
}

Recorder::~Recorder() {
  if (file_ >= 0) ::close(file_);
}

bool Recorder::open_part() {
  const std::uint64_t part = parts_.load() + 1;
  const std::string file = part_name(setup_.file, part);
  if (file_ >= 0) {
    buffer_ += "# continued in " + part_name(setup_.file, part) + ", " + utc_now() + "\n";
    if (!sync()) return false;
    ::close(file_);
  }
  file_ = open_new(file, setup_.overwrite);
  if (file_ < 0) {
    error_ = errno;
    return false;
  }
  parts_ = part;
  length_ = 0;
  part_rows_ = 0;
  has_run_ = false;
  buffer_ += "# " + std::string(recording_mark) + "\n";
  for (const std::string& comment : setup_.comments) buffer_ += "# " + one_line(comment) + "\n";
  buffer_ += "# part " + std::to_string(part) + ", begun " + utc_now() + "\n";
  buffer_ += "# mode: " + mode_legend() + "\n# reason: " + reason_legend() + "\n" + description_;
  buffer_ += "t";
  for (const RunColumns::Column& column : columns_.columns()) {
    buffer_ += "," + column.name;
    if (!column.unit.empty()) buffer_ += " [" + column.unit + "]";
  }
  if (setup_.place) buffer_ += ",block";
  if (setup_.place || setup_.cycle_samples > 0) buffer_ += ",cycle";
  buffer_ += '\n';
  return true;
}

void Recorder::number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  buffer_.append(text, end.ptr);
}

/// Columns block and cycle, where the run has them.
void Recorder::place(const Record& record) {
  if (!setup_.place && setup_.cycle_samples == 0) return;
  if (record.sample == 0) run_samples_ = 0;
  ProgrammeReference::Place there{0, 0};
  if (in_run(record.mode)) {
    there = setup_.place ? setup_.place(run_samples_)
                         : ProgrammeReference::Place{1, 1 + run_samples_ / setup_.cycle_samples};
  }
  if (setup_.place) {
    buffer_ += ',';
    number(static_cast<double>(there.block));
  }
  buffer_ += ',';
  number(static_cast<double>(there.cycle));
  if (record.mode == Mode::running) ++run_samples_;
}

bool Recorder::worth_a_row(const Record& record) {
  if (record.mode == Mode::idle) return false;
  const bool stands = record.mode == Mode::safe && mode_ == Mode::safe && record.command == stands_;
  standing_ = stands ? standing_ + 1 : 0;
  stands_ = record.command;
  return static_cast<double>(standing_) * columns_.period() <= standing_rows;
}

void Recorder::take(const Record& record) {
  const bool row = worth_a_row(record);
  const bool begins = mode_ == Mode::idle && record.mode != Mode::idle;
  mode_ = record.mode;
  if (!row || error() != 0) {
    lost_ += row ? 1 : 0;
    return;
  }
  const bool full = setup_.rows_per_part > 0 && part_rows_ >= setup_.rows_per_part;
  if (begins && has_run_) begin_ = hal::never;
  if ((full || (begins && has_run_)) && !open_part()) {
    ++lost_;
    return;
  }
  has_run_ = has_run_ || in_run(record.mode);
  if (begin_ == hal::never) begin_ = record.due;
  number((record.due - begin_).seconds());
  for (const RunColumns::Column& column : columns_.columns()) {
    buffer_ += ',';
    number(RunColumns::value(column, record));
  }
  place(record);
  buffer_ += '\n';
  ++collected_;
  ++part_rows_;
}

void Recorder::mark(const std::string& text) { buffer_ += "# mark: " + one_line(text) + ", " + utc_now() + "\n"; }

bool Recorder::flush() {
  if (error() != 0) {
    lost_ += collected_;
    collected_ = 0;
    buffer_.clear();
    return false;
  }
  std::size_t done = 0;
  while (done < buffer_.size()) {
    const ssize_t written = ::write(file_, buffer_.data() + done, buffer_.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
    } else if (written < 0 && errno != EINTR) {
      error_ = errno;
      break;
    }
  }
  std::uint64_t missing = 0;
  if (error() != 0) {  // back to the end of the last whole row
    const std::size_t end = buffer_.rfind('\n', done == 0 ? 0 : done - 1);
    const std::size_t whole = done == 0 || end == std::string::npos ? 0 : end + 1;
    for (std::size_t i = whole; i < buffer_.size(); ++i) missing += buffer_[i] == '\n' ? 1 : 0;
    done = whole;
    static_cast<void>(!::ftruncate(file_, length_ + static_cast<off_t>(whole)));
  }
  length_ += static_cast<std::int64_t>(done);
  rows_ += collected_ > missing ? collected_ - missing : 0;
  lost_ += missing < collected_ ? missing : collected_;
  collected_ = 0;
  buffer_.clear();
  return error() == 0;
}

bool Recorder::sync() {
  if (!flush()) return false;
  if (::fdatasync(file_) != 0 && errno != EINVAL && errno != EROFS) error_ = errno;  // a pipe has nothing to sync
  return error() == 0;
}

void Recorder::end(const std::string& why) {
  if (error() != 0) return;
  buffer_ += "# ended by " + one_line(why) + ", " + utc_now() + "\n";
  sync();
}

}  // namespace firmware::controller
