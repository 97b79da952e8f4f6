// A law that no catalogue holds, as part of a hypothesis: a family of curves, its values, and the place where it acts.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

#include "firmware/description/rig_description.hpp"

namespace host_sim::identification {

/// Families of curves over x, a velocity [m/s] or a deflection [m]. X: the largest |x|, r: its rms, both in the record.
///
///   points        (1)  a monotone cubic through (x_i, F_i); values: F_i
///   power         (2)  F = c sgn(x) |x/r|^p                               values: c, p
///   two_slopes    (3)  F = c x/r for x > 0, c′ x/r for x < 0                 values: c, c′
///   two_powers    (4)  F = c |x/r|^p for x > 0, −c′ |x/r|^p for x < 0     values: c, c′, p
///   soft_sign     (5)  F = c tanh(x/w)                                    values: c, w
///   falling       (6)  F = −c (1 − exp(−(x/w)²)) sgn(x)                   values: c, w; beside dry friction: Stribeck
///   knee          (7)  F = (c min(|x|, w) + c′ max(|x| − w, 0)) sgn(x)/r          values: c, c′, w
///   one_sided     (8)  F = c (x − w)/r for x > w, c′ (x + w)/r for x < −w   values: c, c′, w
///   levelling     (9)  F = c (x/r)/(1 + |x|/w): the slope at w is a quarter of c/r         values: c, w
///
/// and with memory of a deflection, stacks of branches (model/laws/branch.hpp):
///
///   sliders      (10)  F = Σ u_i, u_i ← clamp(u_i + c_i Δx/d_i, ±c_i)      values: c_i ≥ 0 of the slip travels d_i;
///                      with a gap all of them have that free play in series
///   maxwell      (11)  F = Σ u_i, u̇_i = c_i ẋ/r − u_i/T_i                values: c_i ≥ 0 of the time constants T_i
///
/// and surfaces over deflection x and velocity v, q: rms of v:
///
///   follows_load (12)  F = c |x|/r · tanh(v/w)                            values: c, w: friction, times the load
///   along_stroke (13)  F = c |x/r|^p · v/q                                values: c, p: damping along the stroke
///   free_surface (14)  F = F_0 + Σ_k u_k E_k on a grid of x and v           values: u_k
enum class LawFamily : unsigned char {
  points,
  power,
  two_slopes,
  two_powers,
  soft_sign,
  falling,
  knee,
  one_sided,
  levelling,
  sliders,
  maxwell,
  follows_load,
  along_stroke,
  free_surface
};
inline constexpr std::size_t law_families = 14;
[[nodiscard]] constexpr bool has_memory(LawFamily family) {
  return family == LawFamily::sliders || family == LawFamily::maxwell;
}
[[nodiscard]] constexpr bool is_surface(LawFamily family) {
  return family == LawFamily::follows_load || family == LawFamily::along_stroke || family == LawFamily::free_surface;
}
/// True if the values of a family are forces, whose number depends on its grid.
[[nodiscard]] constexpr bool has_grid(LawFamily family) {
  return family == LawFamily::points || family == LawFamily::free_surface || has_memory(family);
}

/// Straight between points and beyond them.
[[nodiscard]] double between(const std::vector<double>& at, const std::vector<double>& value, double x);
/// 0 and `each_side` points on each side of it up to `largest`, dense within `bend`: ± bend sinh(i a).
[[nodiscard]] std::vector<double> points_around(double bend, double largest, int each_side);

/// The guides hold body and wheel against the ground: laws over ż_b and ż_w.
enum class CurvePlace : unsigned char { suspension, tyre, body_guide, wheel_guide };
enum class CurveOver : unsigned char { velocity, deflection, both };
[[nodiscard]] std::string_view name(CurvePlace place);
[[nodiscard]] std::string_view name(CurveOver over);

/// F_0 [N] and E_k [1] of (14), on one grid.
struct SurfaceBasis {
  model::SurfaceTable<double> from;
  std::vector<model::SurfaceTable<double>> directions;
  std::vector<double> deflections{}, velocities{};  ///< while its values are forces at nodes: where these are
};

struct PlacedLaw {
  CurvePlace place = CurvePlace::suspension;
  CurveOver over = CurveOver::velocity;
  LawFamily family = LawFamily::points;
  double rms = 1.0, largest = 1.0;                    ///< r and X
  double rms_velocity = 1.0, largest_velocity = 1.0;  ///< q of a surface, and the largest |v|
  double size = 1.0;         ///< a force [N] that matters here: unit of the values that are forces, in a fit
  std::vector<double> at{};  ///< x_i of (1), d_i [m] of (10), T_i [s] of (11)
  std::vector<double> values{};
  std::shared_ptr<const SurfaceBasis> basis{};  ///< of (14)
  double gap = 0.0;                             ///< [m] of (10): lost motion; 0: none
  double farthest = 0.0;  ///< the table of a family goes on as far as this, beyond X; straight from there
  std::size_t slot = 0;   ///< of the rig's laws, curve, surface or first branch: behind those of its description

  /// F(x) of (2)–(9); of (1) the straight lines between points. With memory: at the end of a first travel from rest to
  /// x, for (11) one that is fast beside every T_i.
  /// Of a surface: while v = q.
  [[nodiscard]] double force(double x) const;
  [[nodiscard]] double force(double x, double v) const;  ///< of a surface
  /// Unit of a value that is a width [m], [m/s].
  [[nodiscard]] double unit_of_width() const { return family == LawFamily::follows_load ? rms_velocity : rms; }
  /// One of `values`, or behind them the gap.
  [[nodiscard]] double& value(std::size_t number) { return number < values.size() ? values[number] : gap; }
  [[nodiscard]] double value(std::size_t number) const { return number < values.size() ? values[number] : gap; }

  /// F along a motion that is sampled with a period [s].
  [[nodiscard]] std::vector<double> forces_along(const std::vector<double>& x, double period) const;
};

/// The branches of (10) and (11) that carry a force.
[[nodiscard]] std::vector<model::BranchNumbers<double>> branches_of(const PlacedLaw& law);

/// What a value of a family is: its unit is a force, or x, or none.
struct LawValue {
  std::string_view name;
  enum class Kind : unsigned char { force, width, exponent } kind;
  double lower, upper;  ///< of a width: in units of r; of a force: without bounds
};
[[nodiscard]] const std::vector<LawValue>& values_of(LawFamily family);

/// The table of a law: model::curve_points at most, with 0 among its points, dense where the curve bends.
struct LawTable {
  std::vector<double> at, value;
};
[[nodiscard]] LawTable table_of(const PlacedLaw& law);

/// The same of a surface; table_of() is its section at v = q.
[[nodiscard]] model::SurfaceTable<double> surface_of(const PlacedLaw& law);

/// Puts the tables of laws into their slots of a rig.
void put_laws(const std::vector<PlacedLaw>& laws, model::RigParameters<double>& rig);

}  // namespace host_sim::identification
