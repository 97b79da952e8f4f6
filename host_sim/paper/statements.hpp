// What the paper's text says, held against what comes out here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host_sim/paper/experiments.hpp"

namespace host_sim::paper {

/// One statement of the paper. Whether it agrees is decided by the numbers, here.
struct Statement {
  std::string id;        ///< "table_1_unstable"
  std::string paper;     ///< what the text says
  std::string finding;   ///< what comes out here, with its numbers
  double computed{};     ///< the number that decides
  std::string expected;  ///< what it would have to be, "> 4"
  std::string unit;
  bool agrees{};
};

/// In the order of the figures.
[[nodiscard]] std::vector<Statement> statements(const Experiments& experiments);

/// How far a measured wheel load is from the simulated one, from 1 to 25 Hz.
struct WheelLoadError {
  double largest{};     ///< of | |measured/simulated| − 1 |, what a plot of magnitudes shows [1]
  double hz{};          ///< where
  double with_phase{};  ///< largest |measured/simulated − 1| [1]
};
[[nodiscard]] WheelLoadError wheel_load_error(const TransferEstimate& measured, const TransferEstimate& simulated);

}  // namespace host_sim::paper
