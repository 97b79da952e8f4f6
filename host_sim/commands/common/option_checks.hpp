// Checks of option values that CLI11 does not make as needed.
#pragma once

#include <CLI/CLI.hpp>

namespace host_sim {

/// A number from `lowest` to `highest`; NaN is refused. (CLI::Range accepts NaN, because every comparison is false.)
[[nodiscard]] CLI::Validator number_within(double lowest, double highest);

/// A whole number from 0 to 2⁶⁴ − 1. (CLI11 reads −1 and numbers that are too large as 2⁶⁴ − 1.)
[[nodiscard]] CLI::Validator whole_64_bit_number();

}  // namespace host_sim
