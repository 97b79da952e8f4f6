// SHA-256 of a text.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace firmware {

/// 64 hexadecimal digits, by FIPS 180-4 (2015), of a text that comes in pieces. Our own: no library that rig_controller
/// links has it, and a board gets no further package for it. It identifies texts; nothing secret depends on it.
class Sha256 {
 public:
  void take(std::string_view piece);
  /// Of all pieces; nothing may be taken after it.
  [[nodiscard]] std::string digits();

 private:
  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::string rest_;  ///< the beginning of a block of 64 bytes
  std::uint64_t size_ = 0;
};

/// The same of a whole text.
[[nodiscard]] std::string sha256(std::string_view text);

}  // namespace firmware
