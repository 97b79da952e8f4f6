// Records of universal files (SDRC I-DEAS), which programs of modal analysis read.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "firmware/description/text/quantity.hpp"
#include "model/components/channel.hpp"

namespace host_sim::universal {

/// An axis of dataset 58: specific data type, exponents of length and force, label and unit.
struct Axis {
  int type = 0, length = 0, force = 0;
  std::string label = "NONE", unit = "NONE";
};

inline const Axis time_axis{17, 0, 0, "Time", "s"};
inline const Axis frequency_axis{18, 0, 0, "Frequency", "Hz"};

/// The axis for a unit: displacement [m], velocity [m/s], acceleration [m/s²], force [N], else of unknown kind.
[[nodiscard]] Axis axis_for(std::string_view unit, std::string_view label = "NONE");

/// Where a channel belongs: 1 foot point, 2 wheel, 3 body, 4 tyre, 5 component or machine.
[[nodiscard]] int node_of(model::Channel channel);

enum class FunctionType : int { general = 0, time_response = 1, frequency_response = 4, coherence = 6 };

/// The header of a dataset 58, function at nodal DOF. Directions are 3 (+Z) where there is a node, else 0 (scalar).
struct Function {
  FunctionType type = FunctionType::general;
  int number = 1;
  std::array<std::string, 5> id{"NONE", "NONE", "NONE", "NONE", "NONE"};
  std::string response = "NONE", reference = "NONE";
  int response_node = 0, reference_node = 0;
  bool complex = false;
  bool even = true;                     ///< the abscissa is first + k × increment, else pairs of abscissa and value
  double first = 0.0, increment = 0.0;  ///< 0 where it is not even
  std::size_t points = 0;
  Axis abscissa, ordinate, denominator;
};

/// Dataset 164: SI units.
[[nodiscard]] std::string units_dataset();

/// Dataset 58 in ASCII, double precision: lines of at most 80 columns,
///
///   record 6    2(I5,I10),2(1X,10A1,I10,I4)   type, number, version, load case; response and reference: name, node,
///               direction
///   record 7    3I10,3E13.5                    4 real, 6 complex; points; 1 even, 0 uneven; first, increment
///   record 8–11 I10,3I5,2(1X,20A1)             abscissa, ordinate, denominator, none
///   record 12   4E20.12, uneven 2(E13.5,E20.12)
///
/// in three parts, so that a long one need not lie in memory: header, numbers (`numbers` begins at a multiple of four
/// from the first), end. A number that is not finite is written as NaN.
/// Source: SDRC I-DEAS universal dataset 58, revision of 30 June 1999, and 164.
[[nodiscard]] std::string function_header(const Function& function);
[[nodiscard]] std::string function_numbers(std::span<const double> numbers, bool even = true);
[[nodiscard]] std::string dataset_end();

}  // namespace host_sim::universal
