#include "firmware/description/text/internet_address.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

#include "firmware/description/text/input_error.hpp"

namespace firmware {
namespace {

template <class Address>
InternetAddress stored(const Address& address) {
  sockaddr_storage storage{};
  static_assert(sizeof address <= sizeof storage);
  std::memcpy(&storage, &address, sizeof address);
  return internet_address(storage, sizeof address);
}

template <class Address>
Address as(const InternetAddress& address) {
  Address result{};
  std::memcpy(&result, &address.storage, sizeof result);
  return result;
}

bool is_six(const InternetAddress& address) { return address.storage.ss_family == AF_INET6; }

std::optional<std::uint16_t> read_port(std::string_view digits, bool any) {
  std::uint16_t port = 0;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (read.ec != std::errc() || read.ptr != digits.data() + digits.size() || (port == 0 && !any)) return std::nullopt;
  return port;
}

}  // namespace

std::uint16_t InternetAddress::port() const {
  return ntohs(is_six(*this) ? as<sockaddr_in6>(*this).sin6_port : as<sockaddr_in>(*this).sin_port);
}

std::string InternetAddress::host() const {
  std::array<char, INET6_ADDRSTRLEN> host{};
  const auto six = as<sockaddr_in6>(*this);
  const auto four = as<sockaddr_in>(*this);
  const void* const numbers = is_six(*this) ? static_cast<const void*>(&six.sin6_addr) : &four.sin_addr;
  const char* const text = ::inet_ntop(storage.ss_family, numbers, host.data(), host.size());
  return text == nullptr ? "" : text;
}

std::string InternetAddress::text() const {
  return (is_six(*this) ? "[" + host() + "]" : host()) + ":" + std::to_string(port());
}

InternetAddress internet_address(const sockaddr_storage& storage, socklen_t length) {
  InternetAddress address{storage, length};
  const auto six = as<sockaddr_in6>(address);
  address.loopback = is_six(address) ? IN6_IS_ADDR_LOOPBACK(&six.sin6_addr) != 0
                                     : (ntohl(as<sockaddr_in>(address).sin_addr.s_addr) >> 24U) == 127U;
  return address;
}

std::optional<InternetAddress> parse_host(std::string_view host, std::uint16_t port) {
  const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
  const std::string numbers(host == "localhost" ? "127.0.0.1" : bracketed ? host.substr(1, host.size() - 2) : host);
  sockaddr_in four{};
  four.sin_family = AF_INET;
  four.sin_port = htons(port);
  if (!bracketed && ::inet_pton(AF_INET, numbers.c_str(), &four.sin_addr) == 1) {
    return four.sin_addr.s_addr == INADDR_ANY ? std::nullopt : std::optional(stored(four));
  }
  sockaddr_in6 six{};
  six.sin6_family = AF_INET6;
  six.sin6_port = htons(port);
  if (::inet_pton(AF_INET6, numbers.c_str(), &six.sin6_addr) != 1) return std::nullopt;
  return IN6_IS_ADDR_UNSPECIFIED(&six.sin6_addr) ? std::nullopt : std::optional(stored(six));
}

InternetAddress parse_host_port(std::string_view option, std::string_view text, HostPortRule rule) {
  const auto fail = [&](const std::string& why) -> UsageError {
    return UsageError(std::string(option) + " " + in_quotes(text) + " does not fit: " + why + ", expected HOST:PORT" +
                      (rule.port_alone ? " or PORT" : "") + ", such as localhost:9870 or [::1]:9870");
  };
  const std::size_t colon = text.rfind(':');
  const bool six_alone = std::count(text.begin(), text.end(), ':') > 1 && text.front() != '[';
  if (six_alone) throw fail("an IPv6 address stands in brackets");
  const bool in_brackets = colon != std::string_view::npos && text.find(']', colon) != std::string_view::npos;
  if ((colon == std::string_view::npos && !rule.port_alone) || in_brackets) throw fail("there is no port");
  const std::string_view digits = colon == std::string_view::npos ? text : text.substr(colon + 1);
  const auto port = read_port(digits, rule.any_port);
  if (!port) {
    throw fail("the port " + in_quotes(digits) + " is no number from " + (rule.any_port ? "0" : "1") + " to 65535");
  }
  const std::string_view host = colon == std::string_view::npos ? "localhost" : text.substr(0, colon);
  const auto address = parse_host(host, *port);
  if (!address) {
    throw fail("the host " + in_quotes(host) + " is neither localhost nor the address of one machine in numbers");
  }
  return *address;
}

}  // namespace firmware
