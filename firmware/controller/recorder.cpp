#include "firmware/controller/recorder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "firmware/recording/recording.hpp"

namespace firmware::controller {

Recorder::Recorder(const std::string& file, const RigDescription& rig, const hal::SensorSetup& sensors,
                   const std::vector<std::string>& comments, std::string& trouble)
    : columns_(rig, sensors) {
  buffer_ += "# " + std::string(recording_mark) + "\n";
  for (const std::string& comment : comments) buffer_ += "# " + comment + "\n";
  buffer_ += "t";
  for (const RunColumns::Column& column : columns_.columns()) {
    buffer_ += "," + column.name;
    if (!column.unit.empty()) buffer_ += " [" + column.unit + "]";
  }
  buffer_ += '\n';
  file_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0 || !flush()) {
    trouble = file + ": " + std::strerror(file_ < 0 ? errno : error()) + ", expected a file that can be written";
  }
}

Recorder::~Recorder() {
  if (file_ >= 0) ::close(file_);
}

void Recorder::number(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  buffer_.append(text, end.ptr);
}

void Recorder::take(const Record& record) {
  if (record.mode != Mode::running) return;
  if (begin_ == hal::never || record.sample == 0) begin_ = record.due;
  number((record.due - begin_).seconds());
  for (const RunColumns::Column& column : columns_.columns()) {
    buffer_ += ',';
    number(RunColumns::value(column, record));
  }
  buffer_ += '\n';
  ++collected_;
}

bool Recorder::flush() {
  if (error_ != 0) {
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
  if (error_ != 0) {  // back to the end of the last whole row
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
  return error_ == 0;
}

bool Recorder::sync() {
  if (!flush()) return false;
  if (::fdatasync(file_) != 0 && errno != EINVAL && errno != EROFS) error_ = errno;  // a pipe has nothing to sync
  return error_ == 0;
}

}  // namespace firmware::controller
