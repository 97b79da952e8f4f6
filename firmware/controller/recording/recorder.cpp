#include "firmware/controller/recording/recorder.hpp"

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

#include "firmware/controller/recording/output_claim.hpp"
#include "firmware/controller/recording/trip_text.hpp"
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
    : setup_(setup), rig_(rig), columns_(rig, sensors), description_(as_comments("description", rig.source)) {
  for (const std::filesystem::path& file : referenced_files(rig)) description_ += as_comments("table", file.string());
  if (!setup.programme.empty()) description_ += as_comments("programme", setup.programme);
  if (trouble = taken_part(); !trouble.empty()) return;
  if (open_part() && flush()) return;
  trouble = claim_trouble(setup_.file, error());
}

Recorder::~Recorder() {
  if (file_ >= 0) ::close(file_);
  if (first_ >= 0 && first_ != file_) ::close(first_);
}

/// Why a name that this recording may need is not free; empty: all are.
std::string Recorder::taken_part() const {
  if (setup_.rows_per_part == 0 && !setup_.several_runs) return {};
  for (const std::string& part : present_parts(setup_.file)) {
    if (leads_to_one_of(part, setup_.inputs)) return claim_trouble(part, ETXTBSY);
    if (!setup_.overwrite) return claim_trouble(part, EEXIST);
  }
  return {};
}

/// The next name that is free: somebody may have taken one since the start, which must not end a run.
bool Recorder::open_part() {
  constexpr std::uint64_t most_tries = 1000;
  ClaimedFile next{-1, EEXIST};
  std::uint64_t number = number_;
  const bool first = file_ < 0;
  for (std::uint64_t tries = 0; next.descriptor < 0 && tries < most_tries; ++tries) {
    const std::string name = part_name(setup_.file, ++number);
    next = claim_file(name, setup_.overwrite, setup_.inputs);
    // What cannot be written and is not there, as on a full disk, is no reason for another name.
    std::error_code none;
    const bool taken = std::filesystem::exists(std::filesystem::symlink_status(name, none));
    if (first || !taken) break;
  }
  if (next.descriptor < 0) {
    error_ = next.error;
    return false;
  }
  if (!first) {
    buffer_ += "# continued in " + part_name(setup_.file, number) + ", " + utc_now() + "\n";
    if (!sync()) {
      ::close(next.descriptor);
      return false;
    }
    if (file_ != first_) ::close(file_);
  }
  file_ = next.descriptor;
  struct stat opened {};
  if (first) {
    first_ = file_;
    has_parts_ = ::fstat(file_, &opened) == 0 && S_ISREG(opened.st_mode);
  }
  number_ = number;
  begin_part();
  return true;
}

void Recorder::begin_part() {
  const std::uint64_t part = parts_.load() + 1;
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

/// The reason of a record, once; with what may stand behind the next run's first row.
void Recorder::note_reason(const Record& record) {
  const bool another = record.trip.reason != reason_ || record.trip.time != reason_time_;
  const bool first = another && record.trip.reason != Reason::none;
  const bool then = record.second != second_ && record.second != Reason::none;
  reason_ = record.trip.reason;
  reason_time_ = record.trip.time;
  second_ = record.second;
  if (first) {
    ended_by_ = trip_text(record.trip, rig_);
    news_ = (is_fault(record.trip.reason) ? "SAFE STOP: " : "safe: ") + ended_by_;
  }
  if (then) {
    ended_by_ += ", then " + std::string(name(record.second));
    news_ += (news_.empty() ? "then " : ", then ") + std::string(name(record.second));
    if (takes_heartbeat(record.second)) news_ += ": the drive has power that nobody gave";
  }
}

std::string Recorder::news() {
  std::string text;
  text.swap(news_);
  return text;
}

void Recorder::take(const Record& record) {
  const bool row = worth_a_row(record);
  const bool begins = mode_ == Mode::idle && record.mode != Mode::idle;
  if (begins && !ended_by_.empty()) {
    buffer_ +=
        (has_run_ ? "# ended by " : "# an earlier arming ended by ") + one_line(ended_by_) + ", " + utc_now() + "\n";
    ended_by_.clear();
  }
  note_reason(record);
  mode_ = record.mode;
  if (!row || error() != 0) {
    lost_ += row ? 1 : 0;
    return;
  }
  const bool full = setup_.rows_per_part > 0 && part_rows_ >= setup_.rows_per_part;
  const bool another_run = begins && has_run_;
  if (has_parts_ && another_run) begin_ = hal::never;
  if (has_parts_ && (full || another_run) && !open_part()) {
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
