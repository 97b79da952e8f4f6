// Statements of the paper's text, each checked against a computed number.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host_sim/paper/experiments.hpp"

namespace host_sim::paper {

/// One statement of the paper. `agrees` follows from `computed` alone.
struct Statement {
  std::string id;        ///< "table_1_unstable"
  std::string paper;     ///< statement of the text
  std::string finding;   ///< computed result as a sentence
  double computed{};     ///< the number that is compared
  std::string expected;  ///< condition for agreement, for example "> 4"
  std::string unit;
  bool agrees{};
};

/// In the order of the figures.
[[nodiscard]] std::vector<Statement> statements(const Experiments& experiments);

/// Deviation of a measured wheel load from the simulated one between 1 and 25 Hz.
struct WheelLoadError {
  double largest{};     ///< largest | |measured/simulated| − 1 |, as a plot of magnitudes shows [1]
  double hz{};          ///< its frequency [Hz]
  double with_phase{};  ///< largest |measured/simulated − 1| [1]
};
[[nodiscard]] WheelLoadError wheel_load_error(const TransferEstimate& measured, const TransferEstimate& simulated);

}  // namespace host_sim::paper
