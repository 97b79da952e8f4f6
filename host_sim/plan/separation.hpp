// Residual of an effect after another effect was refitted in its place.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/plan/effect_size.hpp"

namespace host_sim::plan {

/// A change that a rival can make, in any size.
struct Direction {
  Change change;
  bool of_either_sign;                             ///< it may also be taken away
  double square;                                   ///< ⟨b, b⟩
  std::optional<firmware::PlacedEffect> effect{};  ///< that makes it; of a parameter of the rig none
};

/// A subject once its sizes are known.
struct Rival {
  Subject subject;
  /// At thresholds::told_apart, or where it shows most; nullopt: nothing ever shows.
  std::optional<firmware::PlacedEffect> strong{};
  std::optional<firmware::PlacedEffect> absent{};  ///< of an effect with a corner
  std::optional<Eigen::VectorXf> without{};        ///< residuals with `absent`, of the rehearsal of `directions`
  std::vector<Direction> directions{};             ///< first the one of `strong`
};

/// With ⟨·,·⟩ of rehearsal.hpp (1) and the rival's directions b,
///
///   (1)  left² = min over b of  ⟨a, a⟩ − ⟨a, b⟩²/⟨b, b⟩      where ⟨a, b⟩ > 0 or b may be taken away; else ⟨a, a⟩
///
/// in standard deviations. Source: discrimination between models, W. Hunter and A. Reiner, Technometrics 7, 1965.
/// `whole`: ⟨a, a⟩
[[nodiscard]] double left_of(const Rehearsal& rehearsal, const Change& a, double whole,
                             const std::vector<Direction>& rival);

/// Rest of a change after the nearest direction of all rivals is taken off, and of that again, so many times.
/// No less than all of them together would leave.
[[nodiscard]] double left_of_several(const Rehearsal& rehearsal, Change a, const std::vector<const Rival*>& rivals,
                                     int times);

/// Change of an effect after a rival with parameters θ was fitted to it, within the bounds of its card:
///
///   (2)  left² = min over θ of ⟨a − b(θ), a − b(θ)⟩      Levenberg and Marquardt, from the direction with the least
///   (1)
///
/// A law with a corner or with several parameters is no line through its size: (2) is less than (1) where it bends to
/// the effect. Neither more than √⟨a, a⟩ nor worked on where (1) leaves thresholds::unlike of it.
[[nodiscard]] double left_when_refitted(const Rehearsal& rehearsal, const Change& a, const Rival& rival);

/// Fills in `directions` and `without`: of `strong`, and of each combination of starts where the effect has several
/// parameters.
void add_directions(const Rehearsal& rehearsal, Rival& rival);

/// The change of `strong`.
[[nodiscard]] std::optional<Change> strong_change(const Rehearsal& rehearsal, const Rival& rival);

}  // namespace host_sim::plan
