// Where the values of a run are published.
#pragma once

#include <string>
#include <string_view>

namespace firmware::controller {

/// PlotJuggler's UDP server listens there.
inline constexpr std::string_view usual_publish_address = "localhost:9870";

/// What is wrong with publishing there (parse_host_port), in one line; empty: nothing. An address of another machine
/// needs `remote`.
[[nodiscard]] std::string publish_objection(const std::string& address, bool remote);

}  // namespace firmware::controller
