// A confidence as text.
#pragma once

#include <string>

#include "host_sim/report/formatted.hpp"

namespace host_sim::identification {

/// "0.83", "below 0.001": a confidence is known no better.
[[nodiscard]] inline std::string confidence_text(double confidence) {
  constexpr double none = 0.001;
  return confidence < none ? "below 0.001" : formatted("%.3g", confidence);
}

}  // namespace host_sim::identification
