// The columns of a recording in the order in which every format writes them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/recording/recording.hpp"

namespace host_sim {

/// One column: a quantity or an extra column of the recording.
struct ExportColumn {
  std::string name;
  std::string unit;  ///< empty: none
  const std::vector<double>* values;
};

/// t, the channels and ducts present, then the extra columns; valid as long as the recording.
[[nodiscard]] std::vector<ExportColumn> columns_to_export(const firmware::Recording& recording);

/// A text in Latin-1, for formats of bytes without a stated code page; other letters become '?'.
[[nodiscard]] std::string latin_1(std::string_view utf_8);

}  // namespace host_sim
