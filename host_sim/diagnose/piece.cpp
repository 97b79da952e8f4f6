#include "host_sim/diagnose/piece.hpp"

namespace host_sim::diagnose {

Recording cut(const Recording& whole, std::size_t from, std::size_t to) {
  Recording part = whole;
  const auto keep = [&](auto& values) {
    if (values.empty()) return;
    values = {values.begin() + static_cast<std::ptrdiff_t>(from), values.begin() + static_cast<std::ptrdiff_t>(to)};
  };
  keep(part.time);
  keep(part.filled);
  for (auto& values : part.channels) keep(values);
  for (auto& values : part.ducts) keep(values);
  return part;
}

}  // namespace host_sim::diagnose
