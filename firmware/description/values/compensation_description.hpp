// [compensation] of a rig description, as it was given.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "firmware/loop/compensation/settings.hpp"

namespace firmware {

/// The keys that the description has; every other number follows from the rig (compensation_setup).
struct CompensationDescription {
  compensation::Kind kind{};
  std::map<std::string, double, std::less<>> numbers;             ///< key → value; `order` is one of them
  std::map<std::string, std::vector<double>, std::less<>> lists;  ///< coefficients, lowest, highest
};

}  // namespace firmware
