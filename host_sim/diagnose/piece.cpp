#include "host_sim/diagnose/piece.hpp"

namespace host_sim::diagnose {

Recording cut(const Recording& whole, std::size_t from, std::size_t to) {
  Recording part = whole;
  const auto keep = [&](std::vector<double>& values) {
    if (values.empty()) return;
    values = std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(from),
                                 values.begin() + static_cast<std::ptrdiff_t>(to));
  };
  keep(part.time);
  for (auto& values : part.channels) keep(values);
  for (auto& values : part.ducts) keep(values);
  return part;
}

}  // namespace host_sim::diagnose
