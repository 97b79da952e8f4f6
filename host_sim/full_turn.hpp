// 2π, between a frequency and its angle.
#pragma once

#include <numbers>

namespace host_sim {

inline constexpr double full_turn = 2.0 * std::numbers::pi;  ///< [rad]: ω = full_turn · f

}  // namespace host_sim
