// Requests of a page to the controller's socket.
#pragma once

#include <string>
#include <string_view>

namespace host_sim::watch {

/// What is wrong with a request, in words; empty: the socket of rig_controller knows it. A level is a number from 0 to
/// 1.5, a mark at most 200 bytes on one line.
[[nodiscard]] std::string request_objection(std::string_view request);

struct Answer {
  bool heard = false;  ///< the controller has answered, with yes or no
  std::string text;    ///< its line of JSON; else what is wrong, in words
};

/// Sends one line to the Unix domain socket at `path` and waits for its answer, at most 2 s. The controller decides;
/// nothing is sent twice.
[[nodiscard]] Answer ask_controller(const std::string& path, std::string_view request);

}  // namespace host_sim::watch
