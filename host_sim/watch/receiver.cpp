#include "host_sim/watch/receiver.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <vector>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::watch {
namespace {

sockaddr_in internet_address(const ReceiveAddress& address) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(static_cast<std::uint16_t>(address.port));
  if (::inet_pton(AF_INET, address.host.c_str(), &result.sin_addr) != 1) {
    throw firmware::UsageError("--receive " + firmware::in_quotes(address.host) +
                               " does not fit, expected localhost or an IPv4 address in numbers");
  }
  return result;
}

std::string text_of(const sockaddr_in& address) {
  char host[INET_ADDRSTRLEN] = "";
  ::inet_ntop(AF_INET, &address.sin_addr, host, sizeof host);
  return std::string(host) + ":" + std::to_string(ntohs(address.sin_port));
}

}  // namespace

ReceiveAddress parse_receive_address(const std::string& text) {
  ReceiveAddress address;
  const std::size_t colon = text.rfind(':');
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  if (colon != std::string::npos && text.substr(0, colon) != "localhost") address.host = text.substr(0, colon);
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), address.port);
  if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() || address.port < 0 || address.port > 65535) {
    throw firmware::UsageError("--receive " + firmware::in_quotes(text) + " does not fit, expected HOST:PORT or PORT");
  }
  static_cast<void>(internet_address(address));
  return address;
}

Receiver::Receiver(const ReceiveAddress& address, Feed& feed) : feed_(feed) {
  constexpr int wanted_buffer = 4 << 20;  // [bytes]: a second and more of datagrams, as far as the kernel allows it
  sockaddr_in own = internet_address(address);
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  static_cast<void>(::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &wanted_buffer, sizeof wanted_buffer));
  if (socket_ < 0 || ::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0) {
    const std::string why = std::strerror(errno);
    if (socket_ >= 0) ::close(socket_);
    throw firmware::UsageError("--receive " + text_of(own) + ": " + why +
                               ", expected a free port: another program (PlotJuggler?) may listen there; "
                               "rig_controller --publish HOST:PORT sends to another one");
  }
  socklen_t size = sizeof own;
  static_cast<void>(::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size));
  port_ = ntohs(own.sin_port);
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
    pollfd readable{socket_, POLLIN, 0};
    if (::poll(&readable, 1, pause_ms) != 1) continue;
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got = ::recvfrom(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0) continue;
    const double now = duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    const auto wall =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch());
    feed_.take({bytes.data(), static_cast<std::size_t>(got)}, text_of(from), now, wall.count());
  }
}

}  // namespace host_sim::watch
