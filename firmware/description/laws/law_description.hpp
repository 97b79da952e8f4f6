// The [laws] of a rig description: their names, and their text.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "model/rig/rig_model.hpp"

namespace firmware {

/// A law by name. Its numbers stand in model::Laws: a curve or a surface, and branches, all of them optional.
struct LawDescription {
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  std::string name;                            ///< of its table, "damper" for [laws.damper]
  std::size_t curve = none;                    ///< index into model::Laws::curves
  std::size_t surface = none;                  ///< index into model::Laws::surfaces
  std::size_t first_branch = 0, branches = 0;  ///< of model::Laws::branches
  bool feeds_energy = false;  ///< the description says that the law may drive the motion instead of resisting it
  std::string file;           ///< as in the description; empty: its numbers stand there
};

/// [m/s], [m], [N] Beyond these a table is in another unit: dampers of cars and trains are measured to 6 m/s,
/// suspensions travel 0.4 m. A table in mm/s or mm is beyond, as it would be with half or twice the limit.
namespace law_limits {
inline constexpr double fastest = 20.0, farthest = 1.0, strongest = 1e7;
}  // namespace law_limits

/// The lines of one law's table, key and value as TOML.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> law_lines(const LawDescription& law,
                                                                         const model::RigParameters<double>& rig);

/// The laws under their names; those of `rig` that have no name are called law_1, law_2, …
[[nodiscard]] std::vector<LawDescription> named_laws(const std::vector<LawDescription>& laws,
                                                     const model::RigParameters<double>& rig);

}  // namespace firmware
