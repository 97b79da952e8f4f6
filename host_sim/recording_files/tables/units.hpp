// Units as measurement programs write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "firmware/description/text/quantity.hpp"

namespace host_sim {

enum class Dimension : unsigned char { none, time, length, velocity, acceleration, force, pressure, frequency };

/// value in SI = scale × value in the unit.
struct Unit {
  Dimension dimension;
  double scale;
};

/// The unit that a text names: "mm", "kN", "m/s²" in all its spellings, "g" (standard gravity, 9.80665 m/s²), "bar",
/// "Sec", "10 mm" (a factor before the unit). nullopt: not a unit of this list. Case counts where it decides (mN, MN);
/// otherwise "KN" and "Mm" in upper-case files are kN and mm.
[[nodiscard]] std::optional<Unit> find_unit(std::string_view text);

/// The dimension of a recorded quantity, and the name of its SI unit.
[[nodiscard]] Dimension dimension_of(firmware::Quantity quantity);
[[nodiscard]] std::string_view si_unit(Dimension dimension);

/// A heading taken apart: "Weg Rad [mm]", "Weg Rad (mm)", "Weg Rad / mm", "Weg Rad in mm", "Weg Rad, mm", "Weg_Rad_mm"
/// and "Weg Rad mm" all have the name "Weg Rad" (with its own punctuation) and the unit "mm". A unit without brackets
/// counts only if it is one of find_unit(); single letters only after "/", "in" and ",".
struct NameAndUnit {
  std::string name;
  std::string unit;  ///< empty: none
};
[[nodiscard]] NameAndUnit split_heading(std::string_view heading);

}  // namespace host_sim
