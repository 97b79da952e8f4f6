#include "host_sim/closed_loop/trace.hpp"

#include <bit>
#include <string_view>

namespace host_sim {

std::uint64_t trace_hash(const firmware::Recording& recording) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&hash](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (unsigned shift = 0; shift < 64; shift += 8) hash = (hash ^ ((bits >> shift) & 0xffU)) * 0x100000001b3U;
  };
  for (std::size_t k = 0; k < recording.size(); ++k) {
    add(recording.time[k]);
    for (const auto& column : recording.channels) {
      if (!column.empty()) add(column[k]);
    }
    for (const auto& column : recording.ducts) {
      if (!column.empty()) add(column[k]);
    }
    for (const auto& column : recording.extra) add(column.values[k]);
  }
  return hash;
}

std::string hexadecimal(std::uint64_t value) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (int shift = 60; shift >= 0; shift -= 4) text += digits[(value >> static_cast<unsigned>(shift)) & 0xfU];
  return text;
}

}  // namespace host_sim
