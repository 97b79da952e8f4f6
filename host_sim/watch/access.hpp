// Who may look, and who may ask.
#pragma once

#include <string>
#include <string_view>

namespace host_sim::watch {

/// 128 bits of the kernel's random numbers as 32 hexadecimal digits. std::runtime_error: there are none.
[[nodiscard]] std::string random_token();

/// Whether two texts are equal, in a time that depends on their lengths alone: the time of an answer must not tell how
/// many characters of a token were right.
[[nodiscard]] bool equal_in_constant_time(std::string_view a, std::string_view b);

/// Whether a request's Host names this server: `address` or, on the loopback interface, localhost, each with the port.
/// A page from elsewhere whose name is led to this machine (DNS rebinding) brings a name of its own.
[[nodiscard]] bool is_own_host(std::string_view host, std::string_view address, int port);

/// Whether a request's Origin is this server's page. A browser sends it with every POST; a request without it comes
/// from no page.
[[nodiscard]] bool is_own_origin(std::string_view origin, std::string_view address, int port);

/// True for 127.0.0.0/8 and ::1.
[[nodiscard]] bool is_loopback(std::string_view address);

}  // namespace host_sim::watch
