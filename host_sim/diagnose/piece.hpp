// A stretch of a recording.
#pragma once

#include "host_sim/recording.hpp"

namespace host_sim::diagnose {

/// The samples from … to of everything that is recorded.
[[nodiscard]] Recording cut(const Recording& whole, std::size_t from, std::size_t to);

}  // namespace host_sim::diagnose
