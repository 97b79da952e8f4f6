// What rig_controller --publish sends, read again.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace host_sim::watch {

/// One datagram; its keys are described at firmware::controller::DatagramWriter.
struct Datagram {
  double timestamp = 0.0;  ///< on the controller's clock [s]
  std::uint64_t sequence = 0;
  std::uint64_t lost = 0;  ///< periods that the controller could not publish, so far
  std::string instance;    ///< which program sends it; empty: an older one
  std::string state, reason, second_reason, trip;
  std::string failed_checks;                           ///< of an arming that was refused; empty: none
  std::vector<std::pair<std::string, double>> values;  ///< every other number, by key [SI]
  nlohmann::json setup;                                ///< object, or null: none in this datagram
  std::optional<std::string> ended;                    ///< why the session has ended

  /// NaN: there is no value of that name.
  [[nodiscard]] double value(std::string_view name) const;
};

/// Nothing: the text is no such datagram. Anybody on this machine can send one, so it is bounded: at most 96 numbers,
/// keys of 40 and texts of 300 bytes, and nothing of it is used before all of it has been read.
[[nodiscard]] std::optional<Datagram> parse_datagram(std::string_view text);

}  // namespace host_sim::watch
