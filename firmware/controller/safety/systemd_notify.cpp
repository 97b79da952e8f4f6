#include "firmware/controller/safety/systemd_notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace firmware::controller {
namespace {

int notify_socket = -1;
sockaddr_un notify_address{};
socklen_t notify_address_size = 0;

}  // namespace

void open_notify_socket() {
  const char* path = std::getenv("NOTIFY_SOCKET");
  if (notify_socket >= 0 || path == nullptr || std::strlen(path) >= sizeof notify_address.sun_path) return;
  notify_socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  notify_address.sun_family = AF_UNIX;
  std::strcpy(notify_address.sun_path, path);
  if (path[0] == '@') notify_address.sun_path[0] = '\0';  // an abstract socket
  notify_address_size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
}

void notify(const char* message) {
  if (notify_socket < 0) return;
  static_cast<void>(::sendto(notify_socket, message, std::strlen(message), MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&notify_address), notify_address_size) < 0);
}

void extend_timeout(double seconds) {
  char message[64] = "WATCHDOG=1\nEXTEND_TIMEOUT_USEC=";
  char digits[24];
  char* at = digits + sizeof digits;
  *--at = '\0';
  auto left = static_cast<unsigned long long>(seconds * 1e6);
  do {
    *--at = static_cast<char>('0' + left % 10);
    left /= 10;
  } while (left > 0);
  std::strcat(message, at);
  notify(message);
}

}  // namespace firmware::controller
