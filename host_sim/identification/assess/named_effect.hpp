// Effects that were found, how large they are and how sure that is.
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "host_sim/identification/assess/uncertainty_budget.hpp"
#include "host_sim/identification/select/search.hpp"

namespace host_sim::identification {

/// A value with the interval that holds the truth with 95 %.
struct Interval {
  double value, lower, upper;
};

/// A parameter of the description at another value.
struct ParameterValue {
  std::string path;
  double value;  ///< [SI]
};

/// Another explanation: an effect or a parameter at another value, instead of what is named.
struct Alternative {
  using Cause = std::variant<firmware::PlacedEffect, ParameterValue>;
  Cause cause;
  double odds_against;
  std::string separate_by;  ///< the experiment, where the two are close
};

/// A law outside the catalogue that an effect may be (model::Lookalike).
struct PossibleLaw {
  std::string_view law{};
  double chance = 0.0;  ///< that it is that one rather than the effect; 0: there is none
};

struct NamedEffect {
  firmware::PlacedEffect effect;
  std::vector<Interval> parameters;
  double confidence;
  std::vector<Alternative> alternatives;  ///< the nearest first
  PossibleLaw other{};
  double share = 0.0;   ///< of the held-out error that goes when it is added (cause_support.hpp)
  double chance = 0.0;  ///< that a cause which is none had explained as much beside a rest (chance_of_share.hpp)
  std::vector<UncertaintyBudget> budgets{};  ///< of `parameters`; none of a period that was read off the recording

  /// Fits, but any cause could have.
  [[nodiscard]] bool is_by_chance() const { return chance > 0.5; }
};

/// What confidence depends on beside the rivals.
struct Certainty {
  double worth;   ///< of any name beside an unexplained residual: 0 … 1
  double temper;  ///< χ² per residual, at least 1: odds are those of χ² divided by it
  double seen;    ///< χ² of a residual that would be seen
  bool rest;      ///< whether more than noise is left
};

/// χ² that must be left to be seen, in a channel and two bands: n residuals there of `count` in all.
///
///   (1)  seen = max(thresholds::significant_deviations · √(2n), significant_share · n)
[[nodiscard]] double seen_from(double count, std::size_t channels);

/// Confidence of an effect that gained so much χ², with the odds against each of its rivals:
///
///   (2)  odds_i     = exp((penalised χ²_i − penalised χ²) / (2 temper) + (rarity_i − rarity) / 2)      Bayes factor,
///                     as BIC approximates it, and prior odds (selection_criterion.hpp), of which the first holds none
///   (3)  outside    = outside_share · ln(seen · temper/(gain · q₀))/ln(1/q₀)     in 0 … outside_share
///   (4)  confidence = highest_confidence · worth · (1 − outside) / (1 + Σ 1/odds_i)
///
/// q₀: closest_outside. (3): a law outside the catalogue that shares all but q of the effect's power leaves q · gain,
/// which is seen from `seen` on. Its q is as likely around 0.001 as around 0.1 (uniform in ln q). Source of (2): R. Kass
/// and A. Raftery, Bayes factors, J. Am. Stat. Assoc. 90, 1995.
[[nodiscard]] double confidence(const std::vector<double>& odds, double gain, const Certainty& certainty);

/// All other explanations of one cause, with the odds against each.
struct RatedRivals {
  std::vector<double> odds;               ///< (2), of all
  std::vector<Alternative> alternatives;  ///< the nearest first, thresholds::most_alternatives at most
};
/// `of_best`: what the χ² of `effects` counts from, with `own_rarity` of the cause in it; `experiment`: tells the model from that of a rival, and is asked of
/// those that are close.
[[nodiscard]] RatedRivals rated(const std::vector<Rival>& effects, double of_best, double own_rarity,
                                const std::vector<RivalParameter>& parameters, double temper,
                                const std::function<std::string(const Hypothesis&)>& experiment);

/// The law outside the catalogue that this effect may be. A parameter x that is known to ± σ lies near a where that law
/// acts, with the deviation d, and anywhere in the range w of its card where it does not:
///
///   (5)  chance = r/(1 + r),  r = w p/(1 − p) exp(−(x − a)²/(2v))/√(2πv),  v = d² + σ²,  p = outside_share
[[nodiscard]] PossibleLaw lookalike_of(const firmware::PlacedEffect& effect, const std::vector<Interval>& parameters);

/// 95 % of each parameter of a fit, within its bounds. `half_widths`: of Uncertainty.
[[nodiscard]] std::vector<Interval> intervals(const Fit& fit, const Eigen::VectorXd& half_widths);

/// The effects of `found.best`; `parameters`: intervals() of its fit.
[[nodiscard]] std::vector<NamedEffect> named_effects(const IdentificationProblem& problem, const SearchResult& found,
                                                     const SelectionCriterion& criterion,
                                                     const std::vector<Interval>& parameters,
                                                     const Certainty& certainty);

/// Whether a rival is so near that the two count as not told apart (thresholds::close_odds).
[[nodiscard]] bool is_close(const Alternative& other);
[[nodiscard]] bool has_close_rival(const std::vector<Alternative>& alternatives);
/// The same of the law that it may be.
[[nodiscard]] bool is_close(const PossibleLaw& other);

}  // namespace host_sim::identification
