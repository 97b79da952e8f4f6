// A stretch of samples, and a recording cut down to one.
#pragma once

#include <cstddef>

#include "firmware/recording/recording.hpp"

namespace host_sim::identification {

/// The samples from … to − 1.
struct Window {
  std::size_t from = 0, to = 0;
  [[nodiscard]] std::size_t size() const { return to - from; }
};

/// A recording of the window alone. Copies the window only: of an hour, the whole is half a gigabyte.
[[nodiscard]] firmware::Recording cut(const firmware::Recording& whole, Window window);

}  // namespace host_sim::identification
