// A free surface over deflection and velocity at the suspension, fitted by simulation error.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "host_sim/identification/learn/excited_range.hpp"
#include "host_sim/identification/learn/law_fit.hpp"

namespace host_sim::identification {

/// A surface with given forces at nodes, F(0, 0) = 0; they are the values of (14) in predict/placed_law.hpp.
/// Deflections are evenly spaced, velocities stand at ± s sinh(j a), as the points of a curve. Between the nodes
///
///   (1)  F(x, v) = Σ_n F_n N_i(x) N_j(v),   node n at (x_i, v_j)
///
/// N_i: the natural cubic spline that is 1 at its own node and 0 at all others; so what is straight stays straight.
[[nodiscard]] PlacedLaw surface_through(const ExcitedRange& deflection, const ExcitedRange& velocity,
                                        const std::function<double(double x, double v)>& force);

/// Fits the last law of `start`, a surface_through() nodes, as PenalisedFit does with
///
///   (2)  FᵀP F = Σ B²   over the bends B of every row and every column of nodes
///
/// which sees neither x nor v nor x v. Few of its many values are known by more than that they are smooth. Those are
/// combinations e of them with
///
///   (3)  (M/τ) e = μ (M/τ + λP) e,   μ > ½: the data know e better than the penalty does
///
/// and they alone stay free: the law that is returned has the surface as F_0 and the e as its E_k, the largest 1. A
/// later fit needs no penalty any more, and intervals are of what the data determine. nullopt: no simulation stays
/// finite, or nothing is known.
[[nodiscard]] std::optional<CandidateModel> fit_surface(const IdentificationProblem& problem, const SearchSpace& space,
                                                        const Hypothesis& start,
                                                        const std::vector<firmware::PlacedEffect>& effects, int most);

}  // namespace host_sim::identification
