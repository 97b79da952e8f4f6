// A surface through a grid of points.
#pragma once

#include <array>
#include <cstddef>

#include "model/laws/curve.hpp"
#include "model/numerics/inline.hpp"
#include "model/numerics/select.hpp"

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
    if constexpr (lane_count<S> == 1) {
      const std::size_t i = row(deflection);
      return between(deflection, at_[i], at_[i + 1], rows_[i](velocity), rows_[i + 1](velocity));
    } else {
      const S i = row(deflection);
      const auto row_of = [&](std::size_t lane, std::size_t further) {
        return static_cast<std::size_t>(i[lane]) + further;
      };
      const auto from = [&](std::size_t further) {
        return S::each([&](std::size_t lane) { return at_[row_of(lane, further)][lane]; });
      };
      const auto force = [&](std::size_t further) {
        return rows_[0].of_each(velocity, [&](std::size_t lane) -> const Row& { return rows_[row_of(lane, further)]; });
      };
      return between(deflection, from(0), from(1), force(0), force(1));
    }
  }
  [[nodiscard]] S over_velocity(S deflection, S velocity) const {  ///< ∂f/∂v
    const std::size_t i = row(deflection);
    return between(deflection, at_[i], at_[i + 1], rows_[i].slope(velocity), rows_[i + 1].slope(velocity));
  }
  [[nodiscard]] S over_deflection(S deflection, S velocity) const {  ///< ∂f/∂x
    const std::size_t i = row(deflection);
    return (rows_[i + 1](velocity) - rows_[i](velocity)) / (at_[i + 1] - at_[i]);
  }
  [[nodiscard]] S steepest() const { return steepest_; }  ///< over the velocity, within the rows
  [[nodiscard]] S stiffest() const { return stiffest_; }  ///< over the deflection, at the points

 private:
  using Row = Curve<S, surface_points>;
  /// The row below; in lanes as numbers.
  [[nodiscard]] RIGTWIN_INLINE auto row(S deflection) const {
    if constexpr (lane_count<S> == 1) {
      std::size_t n = 0;
      for (std::size_t i = 1; i < surface_points - 1; ++i) {
        n += static_cast<std::size_t>(i + 1 < count_ && deflection >= at_[i]);
      }
      return n;
    } else {
      S n = S(0);
      for (std::size_t i = 1; i + 1 < count_; ++i) n += select(deflection >= at_[i], S(1), S(0));
      return n;
    }
  }
  [[nodiscard]] RIGTWIN_INLINE static S between(S deflection, S from, S to, S below, S above) {
    const S r = (deflection - from) / (to - from);
    return below + r * (above - below);
  }

  std::size_t count_ = 0;
  std::array<S, surface_points> at_{};
  std::array<Row, surface_points> rows_{};
  S steepest_{}, stiffest_{};
};

}  // namespace model
