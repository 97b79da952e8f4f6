// The numbers of a column as text, fast where they have few digits.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace firmware {

/// Writes what std::to_chars(value) writes, the shortest decimals that read back to the same bits. A column of a
/// measurement mostly has a few decimals, alike in all rows. With as many as the values so far needed, k:
///
///   (1)  m = round(10ᵏ v),  |m| < 10¹⁵
///   (2)  m / 10ᵏ = v        the quotient of two exact doubles is the double nearest to the decimal
///
/// Decimals of up to 15 digits are told apart by doubles, so that of (2), without zeros at its end, is the shortest.
/// Others, and those that are shorter with an exponent, are left to std::to_chars.
class ColumnPrinter {
 public:
  void print(double value, std::string& text) {
    std::array<char, 32> digits;  // NOLINT(cppcoreguidelines-pro-type-member-init): written before it is read
    char* const end = print_decimal(value, digits.data());
    text.append(digits.data(), end != nullptr ? end : general(value, digits));
  }

 private:
  static constexpr int most_decimals = 9;
  static constexpr std::array<double, most_decimals + 1> powers{1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

  char* general(double value, std::array<char, 32>& digits) {
    char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    const std::string_view text(digits.data(), static_cast<std::size_t>(end - digits.data()));
    const std::size_t point = text.find('.');
    const bool fits = point != std::string_view::npos && text.find('e') == std::string_view::npos;
    const auto decimals = fits ? static_cast<int>(text.size() - point - 1) : 0;
    if (decimals > decimals_ && decimals <= most_decimals) decimals_ = decimals;
    // A column of seventeen digits is not tried again and again.
    misses_ = misses_ < most_misses ? misses_ + 1 : 0;
    return end;
  }

  // The end of the text; nullptr: not such a number.
  char* print_decimal(double value, char* to) {
    if (misses_ > misses_until_pause) return nullptr;
    const double size = std::abs(value);
    const double power = powers[static_cast<std::size_t>(decimals_)];
    const double scaled = size * power;
    if (!(size >= 1e-3 && scaled < 1e15)) {
      if (value != 0.0 || std::signbit(value)) return nullptr;
      *to = '0';
      return to + 1;
    }
    // (1); (2) notices a wrong rounding. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    auto whole = static_cast<std::uint64_t>(scaled + 0.5);
    if (static_cast<double>(whole) / power != size) return nullptr;  // (2)
    int decimals = decimals_;
    while (decimals > 0 && whole % 10 == 0) {
      whole /= 10;
      --decimals;
    }
    if (decimals == 0 && whole % 100000 == 0) return nullptr;  // "1e+05" is shorter
    misses_ = 0;
    if (value < 0.0) *to++ = '-';
    std::array<char, 24> reversed;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    int count = 0;
    for (; whole != 0 || count <= decimals; whole /= 10) {
      reversed[static_cast<std::size_t>(count++)] = static_cast<char>('0' + whole % 10);
    }
    while (count > 0) {
      if (count == decimals) *to++ = '.';
      *to++ = reversed[static_cast<std::size_t>(--count)];
    }
    return to;
  }

  static constexpr int misses_until_pause = 16, most_misses = 1024;
  int decimals_ = 3;
  int misses_ = 0;  // in a row; in a pause it counts on until it begins anew
};

}  // namespace firmware
