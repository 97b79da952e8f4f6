// The confusion matrix in figures: what many outcomes say together.
#pragma once

#include <array>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tests/confusion/outcome.hpp"

namespace confusion {

/// So many of so many.
struct Share {
  std::size_t count = 0, of = 0;
  void add(bool yes) { add(yes ? 1 : 0, 1); }
  void add(std::size_t more, std::size_t of_more) {
    count += more;
    of += of_more;
  }
  [[nodiscard]] double value() const { return of == 0 ? 1.0 : static_cast<double>(count) / static_cast<double>(of); }
};

/// "  3/4    75%", a column of a table; a dash where nothing was asked.
[[nodiscard]] std::string per_cent(const Share& share);

struct Table {
  std::map<std::string, Share> right;              ///< by "single", "pair", "triple", "none", "unknown"
  Share singles_found;                             ///< the hidden effect is among those named
  Share pair_effects_found, triple_effects_found;  ///< of their effects
  Share ambiguous;                                 ///< verdicts on single effects, pairs, triples
  Share false_alarm;                               ///< of rigs without effect: something is named, or a rest is seen
  Share unknown_flagged;
  Share unknown_named;       ///< a name above 0.5 where the catalogue holds none
  Share wrong_names;         ///< of recordings: a name above 0.5 that is not in the rig
  Share unexplained_beside;  ///< of right answers: a rest is seen beside them
  Share
      at_noise_floor;  ///< of singles, pairs, triples, none: every channel's error ends within 1.15 of the noise floor
  Share intervals, tolerated_intervals;  ///< that hold the truth, in right answers
  double median_error = 0.0, tolerated_error = 0.0;
  /// Of effects named with a confidence in 0 … 0.5 … 0.9 … 0.99 … 1: in the rig.
  std::array<Share, 4> calibration;
  double median_wall = 0.0, worst_wall = 0.0, processor = 0.0;  ///< [s]; `processor`: all together
  std::string slowest;
};

[[nodiscard]] Table table_of(const std::vector<Outcome>& outcomes);

/// For people: the table, and a line or two for each outcome that is not right.
[[nodiscard]] std::string text(const Table& table, const std::vector<Outcome>& outcomes);

[[nodiscard]] nlohmann::ordered_json to_json(const Table& table);

}  // namespace confusion
