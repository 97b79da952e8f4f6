// Lever of the axle between wheel and component.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "model/numerics/motion.hpp"

namespace model {

inline constexpr std::size_t lever_points = 9;  ///< 2 … 9

/// The lever ratio i over the suspension deflection d = z_w − z_b, as a table.
template <class S, bool room>
struct LeverTable {
  std::uint8_t count = 0;               ///< points in use; 0: no lever
  std::array<S, lever_points> at{};     ///< d [m], ascending
  std::array<S, lever_points> ratio{};  ///< i [1], > 0
  [[nodiscard]] constexpr bool any() const { return count > 0; }
};
template <class S>
struct LeverTable<S, false> {
  [[nodiscard]] static constexpr bool any() { return false; }
};

/// Component travel and wheel force behind the arms of an axle:
///
///   (1)  s = ∫₀^d i(δ) dδ,   ṡ = i(d) ḋ       s: travel of the component
///   (2)  F_s = i(d) F + (i(d) − i(0)) F₀       virtual work: F_s ḋ = F ṡ;  F₀ = m_b g/i(0): what it carries at rest
///
/// F₀ makes a lever whose ratio changes a spring of its own, of the stiffness F₀ di/dd.
/// i goes straight between its points and stays as it is beyond them.
template <class S>
class Lever {
 public:
  Lever() = default;
  Lever(const LeverTable<S, true>& table, S body_mass) : table_(table) {
    S sum = S(0);
    for (std::size_t i = 1; i < table_.count; ++i) {
      sum += S(0.5) * (table_.ratio[i] + table_.ratio[i - 1]) * (table_.at[i] - table_.at[i - 1]);
      travel_[i] = sum;
    }
    if (table_.count == 0) return;
    travel_at_zero_ = travel(S(0));
    constexpr double gravity = 9.81;  // [m/s²]
    middle_ = ratio(S(0));
    load_ = body_mass * S(gravity) / middle_;
  }

  /// (2), F_s [N]
  [[nodiscard]] S force(S d, S component_force) const {
    const S i = ratio(d);
    return i * component_force + (i - middle_) * load_;
  }
  [[nodiscard]] S load() const { return load_; }  ///< F₀ [N]

  /// i(d)
  [[nodiscard]] S ratio(S d) const {
    const std::size_t k = interval(d);
    if (d <= table_.at[k]) return table_.ratio[k];
    if (d >= table_.at[k + 1]) return table_.ratio[k + 1];
    return table_.ratio[k] + slope_of(k) * (d - table_.at[k]);
  }
  /// di/dd [1/m]
  [[nodiscard]] S slope(S d) const {
    const std::size_t k = interval(d);
    return d < table_.at[k] || d > table_.at[k + 1] ? S(0) : slope_of(k);
  }
  /// (1); 0 at 0, without a rounding error.
  [[nodiscard]] S travel(S d) const {
    const std::size_t k = interval(d);
    const S beyond = d - table_.at[k + 1], on = d - table_.at[k];
    if (beyond > S(0)) return travel_[k + 1] + table_.ratio[k + 1] * beyond - travel_at_zero_;
    return travel_[k] + (table_.ratio[k] + (on > S(0) ? S(0.5) * slope_of(k) * on : S(0))) * on - travel_at_zero_;
  }
  [[nodiscard]] Stroke<S> over(const Stroke<S>& d) const {
    return {travel(d.position), ratio(d.position) * d.velocity};
  }

 private:
  /// The interval of d; the first or the last beyond the ends. As many comparisons whatever d is.
  [[nodiscard]] std::size_t interval(S d) const {
    std::size_t k = 0;
    for (std::size_t i = 1; i + 1 < lever_points; ++i) k += i + 1 < table_.count && d >= table_.at[i] ? 1U : 0U;
    return k;
  }
  [[nodiscard]] S slope_of(std::size_t k) const {
    return (table_.ratio[k + 1] - table_.ratio[k]) / (table_.at[k + 1] - table_.at[k]);
  }

  LeverTable<S, true> table_{};
  std::array<S, lever_points> travel_{};  ///< ∫ i from the first point on [m]
  S travel_at_zero_{};                    ///< … to 0
  S middle_{1}, load_{};                  ///< i(0), F₀
};

}  // namespace model
