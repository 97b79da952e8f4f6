// HOST:PORT of command lines.
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace firmware {

/// An address of one machine, in numbers, with a port.
struct InternetAddress {
  sockaddr_storage storage{};
  socklen_t length = 0;
  bool loopback = false;  ///< this machine: 127.0.0.0/8 or ::1

  [[nodiscard]] const sockaddr* raw() const { return reinterpret_cast<const sockaddr*>(&storage); }
  [[nodiscard]] std::uint16_t port() const;
  [[nodiscard]] std::string host() const;  ///< "127.0.0.1", "::1"
  [[nodiscard]] std::string text() const;  ///< "127.0.0.1:9870", "[::1]:9870"
};

/// The address that the kernel left in a sockaddr_storage (recvfrom, getsockname).
[[nodiscard]] InternetAddress internet_address(const sockaddr_storage& storage, socklen_t length);

/// localhost (127.0.0.1) or a numeric address, an IPv6 one with or without brackets. Other names are not looked up: a
/// lookup may wait, and may lead elsewhere tomorrow. nullopt: no such address, or all addresses of a machine at once
/// (0.0.0.0, ::).
[[nodiscard]] std::optional<InternetAddress> parse_host(std::string_view host, std::uint16_t port = 0);

/// What a command takes beside HOST:PORT.
struct HostPortRule {
  bool port_alone = false;  ///< "9870" is localhost:9870
  bool any_port = false;    ///< port 0: one that is free
};

/// "localhost:9870", "192.168.1.7:9870", "[::1]:9870". UsageError, in one line that begins with `option`: no port, a
/// port that is no number of 1 … 65535, no host in numbers, an IPv6 address without brackets.
[[nodiscard]] InternetAddress parse_host_port(std::string_view option, std::string_view text, HostPortRule rule = {});

}  // namespace firmware
