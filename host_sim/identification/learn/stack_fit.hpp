// A stack of branches with memory at the suspension, fitted by simulation error; few of them are kept.
#pragma once

#include <optional>
#include <vector>

#include "host_sim/identification/learn/excited_range.hpp"
#include "host_sim/identification/learn/law_fit.hpp"

namespace host_sim::identification {

/// A stack without forces, (10) or (11) of predict/placed_law.hpp, over deflections of half a range X:
///
///   (1)  d_i = X/2^i                          elastic sliders, i = 1, 2 …
///   (2)  T_i = thresholds::shortest_time · 3^i    Maxwell branches, i = 0, 1 …
///
/// as many as the rig has room for behind `slot`. A slider of d ≥ X never slides: it is a spring. With lost motion
/// `gap` [m] of the sliders, X is half of the range that is left.
[[nodiscard]] PlacedLaw empty_stack(LawFamily family, const ExcitedRange& deflection, std::size_t slot,
                                    double gap = 0.0);

/// Fits the forces c_i ≥ 0 of the last law of `start`, with everything else that is free. The bounds leave few of them.
/// Of those, one after the other, the branch is left out without which χ² rises least,
///
///   (3)  Δχ²_i = c_i² / [(JᵀJ)⁻¹]_ii
///
/// while that is less than the price of its two numbers (SelectionCriterion), times χ² per residual. Bounded least
/// squares in the place of a group penalty: forces of dry and viscous branches have one sign, and nothing is to be
/// tuned. nullopt: nothing is left, or no simulation stays finite. Source: M. Slawski and M. Hein, Non-negative least
/// squares for high-dimensional linear models, Electron. J. Statist. 7, 2013.
[[nodiscard]] std::optional<CandidateModel> fit_stack(const IdentificationProblem& problem, const SearchSpace& space,
                                                      const Hypothesis& start,
                                                      const std::vector<firmware::PlacedEffect>& effects,
                                                      const SelectionCriterion& criterion);

/// Branches of the last law that carry a force.
[[nodiscard]] std::size_t branch_count(const Hypothesis& hypothesis);

}  // namespace host_sim::identification
