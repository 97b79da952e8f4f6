// SHA-256 of a text.
#pragma once

#include <string>
#include <string_view>

namespace firmware {

/// 64 hexadecimal digits, by FIPS 180-4 (2015). Sixty lines of our own: no library that rig_controller links has it,
/// and a board gets no further package for it. It identifies texts; nothing secret depends on it.
[[nodiscard]] std::string sha256(std::string_view text);

}  // namespace firmware
