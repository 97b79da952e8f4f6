// A surface through a grid of points.
#pragma once

#include <array>
#include <cstddef>

#include "model/inline.hpp"
#include "model/laws/curve.hpp"

namespace model {

/// Force over deflection and velocity: monotone cubics over the velocity in each row (Curve), straight from row to row.
///
///   f(x, v) = (1 − r) f_i(v) + r f_{i+1}(v),   r = (x − x_i)/(x_{i+1} − x_i)
///
/// f is monotone in v where both rows are, and monotone in x where the rows keep their order; a bicubic surface
/// guarantees neither. Beyond the first and last row it goes straight on, beyond the ends of a row, too. Each
/// evaluation takes two curves.
template <class S>
class Surface {
 public:
  Surface() = default;
  explicit Surface(const SurfaceTable<S>& table) : count_(table.rows) {
    for (std::size_t i = 0; i < count_; ++i) {
      at_[i] = table.deflection[i];
      rows_[i] = Row(table.velocity, table.value[i], table.columns);
      steepest_ = select(rows_[i].steepest() > steepest_, rows_[i].steepest(), steepest_);
    }
    for (std::size_t i = 0; i + 1 < count_; ++i) {
      for (std::size_t j = 0; j < table.columns; ++j) {
        const S slope = absolute((table.value[i + 1][j] - table.value[i][j]) / (at_[i + 1] - at_[i]));
        stiffest_ = select(slope > stiffest_, slope, stiffest_);
      }
    }
  }

  [[nodiscard]] RIGTWIN_INLINE S operator()(S deflection, S velocity) const {
    const std::size_t i = row(deflection);
    const S r = (deflection - at_[i]) / (at_[i + 1] - at_[i]);
    const S below = rows_[i](velocity), above = rows_[i + 1](velocity);
    return below + r * (above - below);
  }
  [[nodiscard]] S over_velocity(S deflection, S velocity) const {  ///< ∂f/∂v
    const std::size_t i = row(deflection);
    const S r = (deflection - at_[i]) / (at_[i + 1] - at_[i]);
    const S below = rows_[i].slope(velocity), above = rows_[i + 1].slope(velocity);
    return below + r * (above - below);
  }
  [[nodiscard]] S over_deflection(S deflection, S velocity) const {  ///< ∂f/∂x
    const std::size_t i = row(deflection);
    return (rows_[i + 1](velocity) - rows_[i](velocity)) / (at_[i + 1] - at_[i]);
  }
  [[nodiscard]] S steepest() const { return steepest_; }  ///< over the velocity, within the rows
  [[nodiscard]] S stiffest() const { return stiffest_; }  ///< over the deflection, at the points

 private:
  using Row = Curve<S, surface_points>;
  [[nodiscard]] RIGTWIN_INLINE std::size_t row(S deflection) const {
    std::size_t n = 0;
    for (std::size_t i = 1; i < surface_points - 1; ++i) {
      n += static_cast<std::size_t>(i + 1 < count_ && deflection >= at_[i]);
    }
    return n;
  }

  std::size_t count_ = 0;
  std::array<S, surface_points> at_{};
  std::array<Row, surface_points> rows_{};
  S steepest_{}, stiffest_{};
};

}  // namespace model
