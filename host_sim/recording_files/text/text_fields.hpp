// The fields of one line of text.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace host_sim {

/// Splits lines into views of their fields, without quotes and blanks around them; quoted fields may hold separators.
/// Text behind a closing quote belongs to the field, which then keeps its quotes ("Force"|"N"|100). The views are valid
/// until the next line.
class FieldSplitter {
 public:
  /// `column`: the separator; ' ' stands for any run of blanks and tabs.
  const std::vector<std::string_view>& split(std::string_view line, char column);

 private:
  std::string_view quoted_field(std::string_view line, std::size_t& i, char column);

  std::vector<std::string_view> fields_;
  std::deque<std::string> unquoted_;  // fields with doubled quotes
};

}  // namespace host_sim
