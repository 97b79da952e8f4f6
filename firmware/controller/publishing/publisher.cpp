#include "firmware/controller/publishing/publisher.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "hal/linux/clock.hpp"

namespace firmware::controller {

namespace {
constexpr hal::Time publishing_pause = hal::milliseconds(5);  // a page is drawn 25 times a second
}

DatagramSocket::DatagramSocket(const InternetAddress& to, std::string& trouble)
    : to_(to), socket_(::socket(to.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  if (socket_ >= 0) return;
  trouble = "--publish: no socket (" + std::string(std::strerror(errno)) +
            "), expected the right to use the network: as a service by the drop-in publish.conf";
}

DatagramSocket::~DatagramSocket() {
  if (socket_ >= 0) ::close(socket_);
}

// Not connected: the kernel does not tell it that nobody listens, so a reader may come and go.
bool DatagramSocket::send(const std::string& datagram) const {
  return ::sendto(socket_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL, to_.raw(), to_.length) ==
         static_cast<ssize_t>(datagram.size());
}

Publisher::Publisher(const cpu_set_t& cpus, LiveTap& tap, const DatagramWriter& writer, const DatagramSocket& socket,
                     double rate)
    : tap_(tap),
      writer_(writer),
      socket_(socket),
      setup_every_(rate > 1.0 ? static_cast<std::uint64_t>(rate) : 1),
      thread_(cpus, [this] { publish(); }) {}

void Publisher::finish() {
  end_.store(true);
  thread_.join();
}

void Publisher::say_end(const std::string& why) { send(writer_.end(time_, numbers(), why)); }

void Publisher::publish() {
  hal::linux::MonotonicClock clock;
  for (bool last = false; !last;) {
    last = end_.load();
    send_waiting();
    if (!last) clock.sleep_until(clock.now() + publishing_pause);
  }
}

void Publisher::send_waiting() {
  for (auto record = tap_.pop(); record; record = tap_.pop()) {
    time_ = record->time;
    const bool with_setup = record->period >= next_setup_;
    if (with_setup) next_setup_ = record->period + setup_every_;
    send(writer_.period(*record, numbers(), with_setup));
  }
}

void Publisher::send(const std::string& datagram) {
  if (socket_.send(datagram)) {
    ++sequence_;
    sent_.fetch_add(1);
  } else {
    unsent_.fetch_add(1);
  }
}

}  // namespace firmware::controller
