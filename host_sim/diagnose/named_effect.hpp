// Effects that were found, how large they are and how sure that is.
#pragma once

#include <string>
#include <vector>

#include "host_sim/diagnose/search.hpp"

namespace host_sim::diagnose {

/// A value with the interval that holds the truth with 95 %.
struct Interval {
  double value, lower, upper;
};

/// An effect that could stand in another's place.
struct Alternative {
  PlacedEffect effect;
  double odds_against;
  std::string separate_by;  ///< the experiment, where the two are close
};

struct NamedEffect {
  PlacedEffect effect;
  std::vector<Interval> parameters;
  double confidence;
  std::vector<Alternative> alternatives;  ///< the nearest first
};

/// What confidence depends on beside the rivals.
struct Certainty {
  double worth;   ///< of any name, where a rest is left: 0 … 1
  double temper;  ///< χ² per residual, at least 1: odds are those of χ² divided by it
  double seen;    ///< χ² of a rest that would be seen
};

/// χ² that must be left over to be seen: a rest in one channel and two bands. `count` residuals in all.
[[nodiscard]] double seen_from(const Case& all, double count);

/// 95 % of each unknown of a fit, widened by what the model leaves unexplained.
[[nodiscard]] std::vector<Interval> intervals(const Fit& fit, double temper);

/// The effects of `findings.best`; `unknowns`: intervals() of its fit.
[[nodiscard]] std::vector<NamedEffect> named_effects(const Case& all, const Findings& findings, const Price& price,
                                                     const std::vector<Interval>& unknowns, const Certainty& certainty);

/// Whether a rival is so near that the two count as not told apart.
[[nodiscard]] bool has_close_rival(const NamedEffect& effect);

}  // namespace host_sim::diagnose
