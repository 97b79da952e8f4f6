#include "host_sim/watch/access.hpp"

#include <sys/random.h>

#include <array>
#include <cstddef>
#include <stdexcept>

#include "firmware/description/text/internet_address.hpp"

namespace host_sim::watch {

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("the kernel gives no random numbers");
  }
  constexpr std::string_view digits = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) {
    token += digits[byte >> 4U];
    token += digits[byte & 0xfU];
  }
  return token;
}

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference = static_cast<unsigned char>(difference | static_cast<unsigned char>(a[i] ^ b[i]));
  }
  return difference == 0;
}

bool is_own_host(std::string_view host, std::string_view address, int port) {
  const std::string end = ":" + std::to_string(port);
  const auto is = [&](const std::string& name) { return host == name + end || (port == 80 && host == name); };
  const bool bracketed = address.find(':') != std::string_view::npos;
  if (is(bracketed ? "[" + std::string(address) + "]" : std::string(address))) return true;
  return is_loopback(address) && is("localhost");
}

bool is_own_origin(std::string_view origin, std::string_view address, int port) {
  constexpr std::string_view scheme = "http://";
  return origin.starts_with(scheme) && is_own_host(origin.substr(scheme.size()), address, port);
}

bool is_loopback(std::string_view address) {
  const auto parsed = firmware::parse_host(address);
  return parsed && parsed->loopback;
}

}  // namespace host_sim::watch
