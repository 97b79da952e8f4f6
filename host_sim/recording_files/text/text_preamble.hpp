// What the lines above a table say of its rate and its columns.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace host_sim {

/// The sampling rate that a line states: "Sampling Rate: 1000", "Abtastrate;1 kHz", "dt = 0.001 s", "X_Delta\t0,001",
/// "Sampling Interval:  0.001", "Messrate 500 Hz", "Abtastintervall [ms]: 2".
struct StatedRate {
  double rate;       ///< [Hz]
  std::string text;  ///< the line, shortened
};

/// The first of the lines that states a rate; nullopt: none does.
[[nodiscard]] std::optional<StatedRate> find_rate(const std::vector<std::string_view>& preamble);

}  // namespace host_sim
