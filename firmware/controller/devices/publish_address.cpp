#include "firmware/controller/devices/publish_address.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <charconv>
#include <cstdint>
#include <cstring>

#include "firmware/description/text/input_error.hpp"

namespace firmware::controller {
namespace {

template <class Address>
PublishAddress stored(const Address& address, bool loopback) {
  PublishAddress result;
  static_assert(sizeof address <= sizeof result.address);
  std::memcpy(&result.address, &address, sizeof address);
  result.length = sizeof address;
  result.loopback = loopback;
  return result;
}

std::optional<PublishAddress> ipv4(const std::string& host, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  const std::string numbers = host == "localhost" ? "127.0.0.1" : host;
  if (::inet_pton(AF_INET, numbers.c_str(), &address.sin_addr) != 1 || address.sin_addr.s_addr == INADDR_ANY) {
    return std::nullopt;
  }
  return stored(address, (ntohl(address.sin_addr.s_addr) >> 24U) == 127U);
}

std::optional<PublishAddress> ipv6(const std::string& host, std::uint16_t port) {
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_port = htons(port);
  if (::inet_pton(AF_INET6, host.c_str(), &address.sin6_addr) != 1 || IN6_IS_ADDR_UNSPECIFIED(&address.sin6_addr)) {
    return std::nullopt;
  }
  return stored(address, IN6_IS_ADDR_LOOPBACK(&address.sin6_addr));
}

}  // namespace

std::optional<PublishAddress> parse_publish_address(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return std::nullopt;
  const std::string_view digits = text.substr(colon + 1);
  std::uint16_t port = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() || port == 0) return std::nullopt;
  const std::string_view host = text.substr(0, colon);
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  return bracketed ? ipv6(std::string(host.substr(1, host.size() - 2)), port) : ipv4(std::string(host), port);
}

std::string publish_objection(const std::string& address, bool remote) {
  const auto parsed = parse_publish_address(address);
  if (!parsed) {
    return "--publish " + in_quotes(address) +
           " does not fit, expected HOST:PORT, HOST localhost or an address in numbers";
  }
  if (parsed->loopback || remote) return {};
  return "--publish " + address +
         " is another machine: the values would leave this one unprotected, and a busy network takes time from the "
         "loop; expected an address of this machine, or --publish-remote as well";
}

}  // namespace firmware::controller
