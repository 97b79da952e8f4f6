// Text files in the encodings of measurement programs, as UTF-8.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace host_sim {

/// The bytes as UTF-8 without byte order mark: UTF-8, UTF-16 of either byte order (by its mark, or by the zero bytes of
/// its Latin letters), else Windows-1252, of which Latin-1 is a part. Ill-formed UTF-16 becomes U+FFFD.
[[nodiscard]] std::string to_utf8(std::string bytes);

/// The same without a copy of what is UTF-8 already; else the text is in `converted`.
[[nodiscard]] std::string_view as_utf8(std::string_view bytes, std::string& converted);

/// Appends a character by its number.
void append_utf8(std::string& text, std::uint32_t code);

/// Whether the bytes look like text in one of these encodings: no control characters but tab, line ends and form feed
/// in the first 4 kB.
[[nodiscard]] bool looks_like_text(std::string_view bytes);

}  // namespace host_sim
