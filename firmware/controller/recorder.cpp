#include "firmware/controller/recorder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>

#include "host_sim/recording.hpp"
#include "host_sim/recording_columns.hpp"
#include "host_sim/simulated_rig.hpp"

namespace firmware::controller {

using model::Channel;
using model::RigKind;

hal::Time oldest_sample(const Record& record) {
  hal::Time oldest = record.time;
  for (const hal::Time taken : record.taken) {
    if (taken != hal::never && taken < oldest) oldest = taken;
  }
  return oldest;
}

Recorder::Recorder(const std::string& file, const host_sim::RigDescription& rig, const hal::SensorSetup& sensors,
                   const std::vector<std::string>& comments, std::string& trouble) {
  const RigKind kind = rig.rig.kind;
  estimates_ = kind == RigKind::quarter_car;
  ducts_ = rig.rig.has_fdva ? static_cast<std::size_t>(rig.rig.fdva.ducts) : 0;
  for (const auto& comment : std::vector<std::string>{std::string(host_sim::recording_mark)}) {
    buffer_ += "# " + comment + "\n";
  }
  for (const std::string& comment : comments) buffer_ += "# " + comment + "\n";
  buffer_ += "t";
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const Channel channel = model::channel_at(i);
    const bool computed =
        kind == RigKind::hil && !host_sim::is_hardware_channel(kind, channel) && channel != Channel::F_act;
    kept_[i] = sensors[i].fitted || computed || (kind == RigKind::component_bench && channel == Channel::x_cmd);
    if (kept_[i]) buffer_ += "," + std::string(model::name(channel)) + " [" + std::string(model::unit(channel)) + "]";
  }
  for (std::size_t j = 0; j < ducts_; ++j) buffer_ += ",duct_" + std::to_string(j + 1);
  if (estimates_) buffer_ += ",F_w_c [N],v_r [m/s],v_w [m/s],v_b [m/s]";
  buffer_ += ",late [s],age [s]";
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    fitted_[i] = sensors[i].fitted;
    if (fitted_[i]) buffer_ += "," + host_sim::age_name(model::channel_at(i)) + " [s]";
  }
  buffer_ += '\n';
  file_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0 || !flush()) {
    trouble = file + ": " + std::strerror(file_ < 0 ? errno : error_) + ", expected a file that can be written";
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
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!kept_[i]) continue;
    buffer_ += ',';
    number(record.values[i]);
  }
  for (std::size_t j = 0; j < ducts_; ++j) buffer_ += record.openings.is_open(j) ? ",1" : ",0";
  if (estimates_) {
    for (const double v :
         {record.wheel_load, record.velocities.foot_point, record.velocities.wheel, record.velocities.body}) {
      buffer_ += ',';
      number(v);
    }
  }
  for (const hal::Time span : {record.late, record.time - oldest_sample(record)}) {
    buffer_ += ',';
    number(span.seconds());
  }
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (!fitted_[i]) continue;
    buffer_ += ',';
    number(record.taken[i] == hal::never ? std::numeric_limits<double>::quiet_NaN()
                                         : (record.time - record.taken[i]).seconds());
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
