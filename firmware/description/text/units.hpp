// Units as measurement programs write them.
#pragma once

#include <optional>
#include <string_view>

#include "firmware/description/text/quantity.hpp"

namespace firmware {

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

/// Whether the text is a unit of a quantity that no channel has: V, A, °C, Nm, rpm, l/min, kg … Such a column has a
/// unit and is kept in it.
[[nodiscard]] bool is_unit_of_no_channel(std::string_view text);

/// A unit of either kind, other than those of a bare number ("-", "1").
[[nodiscard]] bool is_unit(std::string_view text);

/// The dimension of a recorded quantity, and the name of its SI unit.
[[nodiscard]] Dimension dimension_of(Quantity quantity);
[[nodiscard]] std::string_view si_unit(Dimension dimension);

}  // namespace firmware
