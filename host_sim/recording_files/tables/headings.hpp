// Headings of other programs, taken apart into name and unit.
#pragma once

#include <string>
#include <string_view>

namespace host_sim {

/// A heading taken apart: "Weg Rad [mm]", "Weg Rad (mm)", "Weg Rad / mm", "Weg Rad in mm", "Weg Rad, mm", "Weg_Rad_mm"
/// and "Weg Rad mm" all have the name "Weg Rad" (with its own punctuation) and the unit "mm". A unit without brackets
/// counts only if it is one of firmware::find_unit(); single letters only after "/", "in" and ",".
struct NameAndUnit {
  std::string name;
  std::string unit;  ///< empty: none
};
[[nodiscard]] NameAndUnit split_heading(std::string_view heading);

}  // namespace host_sim
