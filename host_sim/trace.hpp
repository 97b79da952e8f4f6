// One number for a whole run: the same on every machine.
#pragma once

#include <cstdint>
#include <string>

#include "host_sim/recording.hpp"

namespace host_sim {

/// FNV-1a, 64 bit, over the bit patterns of all values row by row: t, channels, ducts, extra columns, in that order.
[[nodiscard]] std::uint64_t trace_hash(const Recording& recording);

/// Sixteen hexadecimal digits.
[[nodiscard]] std::string hexadecimal(std::uint64_t value);

}  // namespace host_sim
