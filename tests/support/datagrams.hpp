// UDP datagrams on this machine, for tests of both ends.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace support {

/// Takes datagrams on a port of 127.0.0.1 that was free.
class DatagramInbox {
 public:
  DatagramInbox() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    EXPECT_EQ(::bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
    EXPECT_EQ(::getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size), 0);
    port_ = ntohs(own.sin_port);
  }
  DatagramInbox(const DatagramInbox&) = delete;
  DatagramInbox& operator=(const DatagramInbox&) = delete;
  ~DatagramInbox() { ::close(socket_); }

  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

  /// The next datagram; empty: none came within the patience, which only ends a test that hangs.
  [[nodiscard]] std::string next(int patience_ms = 20'000) const {
    pollfd readable{socket_, POLLIN, 0};
    if (::poll(&readable, 1, patience_ms) != 1) return {};
    std::vector<char> bytes(65'536);
    const ssize_t got = ::recv(socket_, bytes.data(), bytes.size(), 0);
    return got > 0 ? std::string(bytes.data(), static_cast<std::size_t>(got)) : std::string();
  }

 private:
  int socket_;
  int port_ = 0;
};

/// Sends datagrams to a port of 127.0.0.1, always from the same one of its own.
class DatagramOutbox {
 public:
  explicit DatagramOutbox(int port) : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to_.sin_port = htons(static_cast<std::uint16_t>(port));
  }
  DatagramOutbox(const DatagramOutbox&) = delete;
  DatagramOutbox& operator=(const DatagramOutbox&) = delete;
  ~DatagramOutbox() { ::close(socket_); }

  void send(const std::string& text) const {
    EXPECT_EQ(::sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_),
              static_cast<ssize_t>(text.size()));
  }

 private:
  int socket_;
  sockaddr_in to_{};
};

}  // namespace support
