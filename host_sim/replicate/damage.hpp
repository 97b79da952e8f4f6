// What a signal does to a part: turning points, rainflow cycles, relative pseudo-damage, level crossings.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace host_sim::replicate {

/// Peaks and valleys of a signal, with its first and last value.
[[nodiscard]] std::vector<double> turning_points(std::span<const double> signal);

/// A cycle of a signal: from one turning point to the next and back; a half cycle goes one way.
struct Cycle {
  double from, to;
  double count;  ///< 1, or ½
  [[nodiscard]] double range() const { return from < to ? to - from : from - to; }
};

/// Rainflow cycles by four points: an inner range that is not larger than both its neighbours is a whole cycle and is
/// taken out. What remains, the residue, first grows and then falls; each of its ranges is counted as half a cycle.
/// These are the counts of ASTM E1049, and the largest range is that from the highest peak to the lowest valley.
/// Source: ASTM E1049-85 (2017), 5.4.4; C. Amzallag et al., Int. J. Fatigue 16 (1994), 287–293 (four points).
[[nodiscard]] std::vector<Cycle> rainflow(std::span<const double> signal);

/// Σ count · range^k, Miner's sum for a Wöhler line with exponent k and any constant: only ratios of it have a meaning.
[[nodiscard]] double pseudo_damage(const std::vector<Cycle>& cycles, double exponent);

/// Counts over where a cycle begins (rows) and where it ends (columns), in even classes from lowest to highest.
struct RainflowMatrix {
  double lowest = 0.0, highest = 0.0;
  std::size_t classes = 0;
  std::vector<double> counts;  ///< row after row
  [[nodiscard]] double middle(std::size_t i) const {
    return lowest + (static_cast<double>(i) + 0.5) * (highest - lowest) / static_cast<double>(classes);
  }
};
[[nodiscard]] RainflowMatrix rainflow_matrix(const std::vector<Cycle>& cycles, double lowest, double highest,
                                             std::size_t classes);

/// How often the signal goes upwards through each level.
[[nodiscard]] std::vector<double> level_crossings(std::span<const double> signal, const std::vector<double>& levels);

}  // namespace host_sim::replicate
