// What the lines above a table say of its rate.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace host_sim {

/// The sampling rate that a line states: "Sampling Rate: 1000", "Abtastrate;1 kHz", "dt = 0.001 s", "X_Delta\t0,001",
/// "Sampling Interval:  0.001", "Messrate 500 Hz", "Abtastintervall [ms]: 2".
struct StatedRate {
  double rate;           ///< [Hz]
  std::string text;      ///< the line, shortened
  std::string conflict;  ///< another line that states another rate with the same right; empty: none
};

/// What helps to decide which of several numbers is the rate.
struct RateHints {
  char decimal = '.';       ///< of the table: "1,000 Hz" is one kilohertz beside "0.5"
  std::size_t samples = 0;  ///< rows of the table; 0: not known
};

/// The rate that the lines state. All statements of all lines are collected, several of one line as well ("# Config:
/// data_rate = 2000.0 Hz, filter = 488 Hz"). A word of sampling (sample, Abtast, scan, data, fs, dt …) goes before a
/// bare one (rate, frequency, period). No rate: an excitation's, filter's or test's frequency, a duration ("Messzeit"),
/// a clock ("14:22:10"), a unit that is neither frequency nor time ("kBit/s", "mm/s"). Of two that differ, the one that
/// agrees with a stated duration and number of samples counts; where none does, `conflict` names the other. Without
/// a rate the number of samples over a stated duration counts, where it is whole. nullopt: no line states a rate.
[[nodiscard]] std::optional<StatedRate> find_rate(const std::vector<std::string_view>& preamble, RateHints hints = {});

}  // namespace host_sim
