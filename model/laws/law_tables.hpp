// Laws of a rig description: curves, surfaces and branches, as numbers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "model/components/channel.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// Where a law acts and what it adds to.
///
///   suspension   (5)  F_s += f        over dz_b, ḋz_b (behind the top mount and the free play)
///   tyre         (3)  F_w += f        over dz_w, ḋz_w
///   piston       (8)  F_c += f        over y, ẏ: against the piston of the FDVA
///   body_guide        m_b z̈_b −= f    over z_b, ż_b
///   wheel_guide       m_w z̈_w −= f    over z_w, ż_w
///   sensor            what goes into the sensor of one channel = f(true value), before gain, offset, noise
enum class LawPlace : std::uint8_t { suspension, tyre, piston, body_guide, wheel_guide, sensor };
inline constexpr std::size_t force_places = 5;
inline constexpr std::array<std::string_view, force_places + 1> law_place_names{"suspension", "tyre",        "piston",
                                                                                "body_guide", "wheel_guide", "sensor"};

/// What a curve is a function of; sensors: the true value of the channel.
enum class LawOver : std::uint8_t { velocity, deflection };

[[nodiscard]] constexpr std::size_t index(LawPlace place) { return static_cast<std::size_t>(place); }
[[nodiscard]] constexpr std::string_view name(LawPlace place) { return law_place_names[index(place)]; }

inline constexpr std::size_t curve_points = 33;    ///< 2 … 33
inline constexpr std::size_t surface_points = 17;  ///< in each direction, 2 … 17

/// How many laws of each kind a rig has room for, and for the extensions of a rig. Without room
/// they cost neither code nor memory.
struct LawCapacity {
  std::size_t curves = 0, surfaces = 0, branches = 0;
  bool extensions = false;  ///< air spring, lever, delay that varies
  [[nodiscard]] constexpr bool any() const { return curves + surfaces + branches > 0; }
  friend constexpr bool operator==(const LawCapacity&, const LawCapacity&) = default;
};
inline constexpr LawCapacity no_laws{};
#if defined(RIGTWIN_WITHOUT_LAWS)
inline constexpr LawCapacity usual_laws = no_laws;  // a microcontroller's programs, which choose for themselves
#else
inline constexpr LawCapacity usual_laws{.curves = 8, .surfaces = 1, .branches = 8, .extensions = true};
#endif
/// Rigs side by side in lanes have laws, but no extensions.
template <class S>
inline constexpr LawCapacity law_capacity{.curves = usual_laws.curves,
                                          .surfaces = usual_laws.surfaces,
                                          .branches = usual_laws.branches,
                                          .extensions = usual_laws.extensions&& lane_count<S> == 1};

/// A curve through points, f(at[i]) = value[i]; with `behind` > 0 in series with a spring (behind_spring.hpp).
template <class S>
struct CurveTable {
  LawPlace place = LawPlace::suspension;
  LawOver over = LawOver::velocity;
  Channel channel{};                    ///< of a sensor
  std::uint8_t count = 0;               ///< points in use, 2 … 33
  std::array<S, curve_points> at{};     ///< [m/s], [m]; of a sensor [unit of the channel]; ascending
  std::array<S, curve_points> value{};  ///< [N]; of a sensor [unit of the channel]
  S behind{};                           ///< [N/m] stiffness of the spring; 0: the curve itself is at the place
};

/// A surface through a grid of points, f(deflection[i], velocity[j]) = value[i][j].
template <class S>
struct SurfaceTable {
  LawPlace place = LawPlace::suspension;
  std::uint8_t rows = 0, columns = 0;                                 ///< in use, 2 … 17
  std::array<S, surface_points> deflection{}, velocity{};             ///< [m], [m/s]; ascending
  std::array<std::array<S, surface_points>, surface_points> value{};  ///< [N]
};

/// A spring in series with a dashpot (time_constant > 0) or with a dry slider (slip_force > 0), over the deflection; a
/// slider may have free play in series, too.
template <class S>
struct BranchNumbers {
  LawPlace place = LawPlace::suspension;
  S stiffness{};      ///< [N/m], > 0
  S time_constant{};  ///< [s] of a Maxwell branch, > 0; else 0
  S slip_force{};     ///< [N] of an elastic slider, > 0; else 0
  S gap{};            ///< [m] of a slider, ≥ 0: lost motion, the travel without force at each change of its sign
};

/// The laws of a rig, each kind in the order of the description.
template <class S, LawCapacity capacity = law_capacity<S>>
struct Laws {
  std::array<CurveTable<S>, capacity.curves> curves{};
  std::array<SurfaceTable<S>, capacity.surfaces> surfaces{};
  std::array<BranchNumbers<S>, capacity.branches> branches{};
  std::uint8_t curve_count = 0, surface_count = 0, branch_count = 0;

  [[nodiscard]] constexpr bool any() const { return curve_count + surface_count + branch_count > 0; }
};
template <class S>
struct Laws<S, no_laws> {
  [[nodiscard]] static constexpr bool any() { return false; }
};

/// visit(number) for every number of the laws.
template <class Laws, class Visit>
constexpr void for_each_law_number(Laws& laws, const Visit& visit) {
  for (std::size_t i = 0; i < laws.curve_count; ++i) {
    for (std::size_t k = 0; k < laws.curves[i].count; ++k) {
      visit(laws.curves[i].at[k]);
      visit(laws.curves[i].value[k]);
    }
    visit(laws.curves[i].behind);
  }
  for (std::size_t i = 0; i < laws.surface_count; ++i) {
    auto& surface = laws.surfaces[i];
    for (std::size_t row = 0; row < surface.rows; ++row) visit(surface.deflection[row]);
    for (std::size_t column = 0; column < surface.columns; ++column) visit(surface.velocity[column]);
    for (std::size_t row = 0; row < surface.rows; ++row) {
      for (std::size_t column = 0; column < surface.columns; ++column) visit(surface.value[row][column]);
    }
  }
  for (std::size_t i = 0; i < laws.branch_count; ++i) {
    visit(laws.branches[i].stiffness);
    visit(laws.branches[i].time_constant);
    visit(laws.branches[i].slip_force);
    visit(laws.branches[i].gap);
  }
}

}  // namespace model
