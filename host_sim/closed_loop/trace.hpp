// A 64-bit hash of a recording, to compare runs of different machines bit by bit.
#pragma once

#include <cstdint>
#include <string>

#include "firmware/recording/recording.hpp"

namespace host_sim {

/// FNV-1a, 64 bit, over the bit patterns of all values row by row: t, channels, ducts, extra columns, in that order.
[[nodiscard]] std::uint64_t trace_hash(const firmware::Recording& recording);

/// Sixteen hexadecimal digits.
[[nodiscard]] std::string hexadecimal(std::uint64_t value);

}  // namespace host_sim
