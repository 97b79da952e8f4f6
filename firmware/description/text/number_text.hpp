// Numbers as text.
#pragma once

#include <string>

namespace firmware {

/// The number with the fewest digits that read back to the same bits: "0.1", "1e-05".
[[nodiscard]] std::string shortest(double value);

}  // namespace firmware
