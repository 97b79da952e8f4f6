// The even grid on which the rows of a recording lie, for formats that store no time stamps.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace host_sim {

/// Equally spaced rows, of which some may be missing.
struct RowGrid {
  double period;                  ///< [s]
  std::vector<std::size_t> rows;  ///< of each sample
};

/// nullopt: the stamps lie on no grid within 10⁻³ of its period, or more than half of its rows are missing.
[[nodiscard]] std::optional<RowGrid> find_row_grid(const std::vector<double>& time);

}  // namespace host_sim
