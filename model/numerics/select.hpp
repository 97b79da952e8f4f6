// Choosing between two values, for one number and for several side by side.
#pragma once

#include <cstddef>
#include <limits>

namespace model {

/// Code that is a template on its scalar chooses with these instead of `?:` and `if`. For a number, a comparison is a
/// bool and they are what they say. For Lanes (lanes.hpp) a comparison holds in some lanes and not in others.

/// The number of values that stand side by side in a scalar.
template <class S>
inline constexpr std::size_t lane_count = 1;

/// a where the condition holds, else b.
template <class Value>
[[nodiscard]] constexpr Value select(bool condition, const Value& a, const Value& b) {
  return condition ? a : b;
}
[[nodiscard]] constexpr bool any_lane(bool condition) { return condition; }   ///< it holds in some lane
[[nodiscard]] constexpr bool all_lanes(bool condition) { return condition; }  ///< it holds in every lane

/// A condition on parameters, which is the same in every lane: what a rig consists of.
[[nodiscard]] constexpr bool same(bool condition) { return condition; }

/// The largest number, in every lane.
template <class S>
[[nodiscard]] constexpr S largest_number() {
  if constexpr (lane_count<S> == 1) {
    return std::numeric_limits<S>::max();
  } else {
    constexpr double largest = std::numeric_limits<double>::max();
    return S(largest);
  }
}

/// Bits of the number, without its sign.
template <class S>
[[nodiscard]] constexpr S absolute(S value) {
  return value < S(0) ? -value : value;
}

}  // namespace model
