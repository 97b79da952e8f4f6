// Values as TOML writes them.
#pragma once

#include <string>
#include <string_view>

namespace firmware {

/// A basic string, in quotes.
[[nodiscard]] std::string toml_string(std::string_view text);

/// A float with the fewest digits that read back to the same bits: 40 is a whole number to TOML, 40.0 is not.
[[nodiscard]] std::string toml_float(double value);

}  // namespace firmware
