// Where the values of a run are published.
#pragma once

#include <sys/socket.h>

#include <optional>
#include <string>
#include <string_view>

namespace firmware::controller {

/// PlotJuggler's UDP server listens there.
inline constexpr std::string_view usual_publish_address = "localhost:9870";

struct PublishAddress {
  sockaddr_storage address{};
  socklen_t length = 0;
  bool loopback = false;  ///< this machine: 127.0.0.0/8 or ::1
};

/// "localhost:9870", "127.0.0.1:9870", "[::1]:9870", "192.168.1.7:9870". Names other than localhost are not looked up:
/// a lookup may wait, and may lead elsewhere tomorrow. Nothing: the text is no such address.
[[nodiscard]] std::optional<PublishAddress> parse_publish_address(std::string_view text);

/// What is wrong with publishing there, in one line; empty: nothing. An address of another machine needs `remote`.
[[nodiscard]] std::string publish_objection(const std::string& address, bool remote);

}  // namespace firmware::controller
