#include "host_sim/commands/common/option_checks.hpp"

#include <charconv>
#include <cstdint>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"

namespace host_sim {

CLI::Validator number_within(double lowest, double highest) {
  const auto check = [lowest, highest](const std::string& text) {
    double value = 0.0;
    if (CLI::detail::lexical_cast(text, value) && value >= lowest && value <= highest) return std::string();
    return "is " + firmware::in_quotes(text) + ", expected a number from " + firmware::shortest(lowest) + " to " +
           firmware::shortest(highest);
  };
  return CLI::Validator(check, "");
}

CLI::Validator whole_64_bit_number() {
  const auto check = [](const std::string& text) {
    std::uint64_t value = 0;
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, value);
    if (read.ec == std::errc() && read.ptr == end) return std::string();
    return "is " + firmware::in_quotes(text) + ", expected a whole number from 0 to 18446744073709551615";
  };
  return CLI::Validator(check, "");
}

}  // namespace host_sim
