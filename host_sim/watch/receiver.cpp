#include "host_sim/watch/receiver.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <vector>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::watch {
Receiver::Receiver(const firmware::InternetAddress& address, Feed& feed) : feed_(feed), address_(address) {
  constexpr int wanted_buffer = 4 << 20;  // [bytes]: a second and more of datagrams, as far as the kernel allows it
  socket_ = ::socket(address.storage.ss_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  static_cast<void>(::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &wanted_buffer, sizeof wanted_buffer));
  if (socket_ < 0 || ::bind(socket_, address.raw(), address.length) != 0) {
    const std::string why = std::strerror(errno);
    if (socket_ >= 0) ::close(socket_);
    throw firmware::UsageError("--receive " + address.text() + ": " + why +
                               ", expected a free port: another program (PlotJuggler?) may listen there; "
                               "rig_controller --publish HOST:PORT sends to another one");
  }
  sockaddr_storage own{};
  socklen_t size = sizeof own;
  static_cast<void>(::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size));
  address_ = firmware::internet_address(own, size);
  thread_ = std::thread([this] { receive(); });
}

Receiver::~Receiver() {
  end_.store(true);
  thread_.join();
  ::close(socket_);
}

void Receiver::receive() {
  using std::chrono::duration;
  constexpr int pause_ms = 100;
  std::vector<char> bytes(std::size_t{64} * 1024);
  while (!end_.load()) {
    sockaddr_storage from{};
    socklen_t size = sizeof from;
    const ssize_t got = ::recvfrom(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0) {  // a publisher sends several at once: the next one is asked for before the kernel is asked to wait
      pollfd readable{socket_, POLLIN, 0};
      static_cast<void>(::poll(&readable, 1, pause_ms));
      continue;
    }
    const double now = duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    const auto wall =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch());
    feed_.take({bytes.data(), static_cast<std::size_t>(got)}, firmware::internet_address(from, size).text(), now,
               wall.count());
  }
}

}  // namespace host_sim::watch
