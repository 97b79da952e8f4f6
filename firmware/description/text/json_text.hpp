// Text as JSON.
#pragma once

#include <string>
#include <string_view>

namespace firmware {

/// The text as a JSON string, in quotes. Control characters become blanks. Text that is not UTF-8 (a file name may hold
/// any bytes) has its bytes beyond ASCII replaced by '?', because a parser would refuse the whole document.
[[nodiscard]] std::string json_text(std::string_view text);

}  // namespace firmware
