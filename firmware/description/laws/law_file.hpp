// A curve from a file: two columns, as data sheets of dampers, bump stops and bushes have them.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "model/laws/law_tables.hpp"

namespace firmware {

/// Points of a curve, ascending, in SI units.
struct LawPoints {
  std::vector<double> at, value;
};

/// Reads two columns, first what the law is a function of, then its force (a sensor: its reading). Separated by comma,
/// semicolon, tab or blanks; with semicolons or tabs the decimals may have a comma. Lines with # and empty lines are
/// skipped, one header line is allowed. Units stand in the header, `velocity [mm/s]; force (kN)`, in the spellings of
/// text/units.hpp; without one the numbers are SI. Rows may descend; they come out ascending.
///
/// InputError, with the line: not two numbers, a unit that does not belong to the column, values that repeat or turn
/// back, fewer than 2 or more than 33 rows.
[[nodiscard]] LawPoints read_law_file(const std::filesystem::path& file, model::LawPlace place, model::LawOver over);

/// Where the table of a law lies: `file` as the description names it, relative to the description.
[[nodiscard]] std::filesystem::path law_file_path(std::string_view description, std::string_view file);

}  // namespace firmware
