// What an effect must gain to be believed.
#pragma once

#include <cstddef>
#include <vector>

#include "firmware/description/values/effects_by_name.hpp"
#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::identification {

struct SelectionCriterion;

/// A set of effects, fitted.
struct CandidateModel {
  Fit fit;
  std::vector<firmware::PlacedEffect> effects;  ///< those found, without those of the rig description
  std::size_t channels = 0;                     ///< of the problem: among them a fault has its group

  [[nodiscard]] const std::vector<PlacedFault>& faults() const { return fit.hypothesis.faults; }

  /// (1) of SelectionCriterion; infinite for a simulation that diverged.
  [[nodiscard]] double penalised_chi_squared(const SelectionCriterion& criterion) const;
};

/// The criterion that a search minimises, over models with E effects or faults of the recording and p parameters of
/// them:
///
///   (1)  χ² + effect · E + parameter · p + Σ group_choice · channels      the last for each clock and common filter;
///                                                                          a drift costs `violation` more, as a wrong
///                                                                          parameter does (suspect_parameters.hpp)
///
/// A filter that the colours of the noises show (fault_candidates.hpp) costs its parameter alone: that it is there is
/// known without the signals. A lag of the machine in its place needs a filter that acts on noise and on no signal.
///
/// Relation to the Bayesian information criterion (G. Schwarz, Ann. Statist. 6, 1978), χ² + p ln n: with n = 22 000
/// residuals (a minute of two channels) ln n = 10 = `parameter`. `effect` is the prior that one effect of some 30
/// candidates with several starts each acts at all: −2 ln(3e-7) = 30. A fixed penalty is used instead of ln n since
/// neighbouring recordings shall be judged alike; at n = 1e3 … 1e6, ln n = 7 … 14.
///
/// Beside (1) an effect must explain a share of what is left beyond noise: a model that is wrong in details always
/// finds something that gains 40 of a χ² of millions.
struct SelectionCriterion {
  /// [χ²]. Half and twice: the same names.
  double effect = 30.0;
  double parameter = 10.0;
  /// [1] of χ² − n, for the first effect and for each later one. Tuned on our own generator; half and twice: the same
  /// names.
  double first_share = 0.03, later_share = 0.30;
  bool imitating = false;           ///< laws that could imitate others are candidates
  bool sensors = true;              ///< effects of sensors are candidates
  bool machine = true;              ///< effects of the machine
  bool faults = true;               ///< and faults of the recording
  std::size_t beam = 2;             ///< models kept for the next effect
  std::size_t most_candidates = 8;  ///< fitted beside each of them
  std::size_t most_rivals = 8;      ///< fitted in the place of each effect

  /// Of what a model leaves, the share that one more effect must explain.
  [[nodiscard]] double share(const CandidateModel& base) const {
    return base.effects.empty() ? first_share : later_share;
  }
  [[nodiscard]] bool prefers(const CandidateModel& a, const CandidateModel& b) const {
    return a.penalised_chi_squared(*this) < b.penalised_chi_squared(*this);
  }
  /// Whether a longer model is to be believed: it is preferred, and explains at least `least_share` of what is left.
  [[nodiscard]] bool accepts(const CandidateModel& longer, const CandidateModel& shorter, double least_share) const;
};

/// −2 ln of how much rarer an effect is than others: what a late sensor costs in (1). A prior, so no model error makes
/// less of it.
[[nodiscard]] double rarity(const firmware::PlacedEffect& effect);

/// Penalty of a fault in (1), beside `channels` measured ones.
[[nodiscard]] double penalty(const SelectionCriterion& criterion, const PlacedFault& fault, std::size_t channels);

/// What a model leaves beyond noise: max(χ² − n, 0).
[[nodiscard]] double beyond_noise(const Fit& fit);

}  // namespace host_sim::identification
