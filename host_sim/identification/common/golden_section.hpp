// The lowest point of a function with one valley.
#pragma once

namespace host_sim::identification {

struct LowestPoint {
  double at, value;
};

/// Golden section: one value a round, each round leaves 0.618 of the range.
template <class Function>
[[nodiscard]] LowestPoint golden_section(const Function& value_at, double from, double to, int rounds) {
  constexpr double golden = 0.6180339887498949;  // (√5 − 1)/2
  const auto at_share = [&](double share) {
    const double at = from + share * (to - from);
    return LowestPoint{at, value_at(at)};
  };
  LowestPoint left = at_share(1.0 - golden), right = at_share(golden);
  for (int i = 0; i < rounds; ++i) {
    if (left.value < right.value) {
      to = right.at;
      right = left;
      left = at_share(1.0 - golden);
    } else {
      from = left.at;
      left = right;
      right = at_share(golden);
    }
  }
  return left.value < right.value ? left : right;
}

}  // namespace host_sim::identification
