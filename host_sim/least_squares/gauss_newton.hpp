// Non-linear least squares with bounds: the one solver of the workbench.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <optional>

#include "host_sim/least_squares/bounded_step.hpp"

namespace host_sim {

/// The quadratic model of ½|r|² at the present point.
struct NormalEquations {
  Eigen::MatrixXd hessian;   ///< H = JᵀJ
  Eigen::VectorXd gradient;  ///< g = Jᵀr
};

/// When gauss_newton() stops. The numbers of its step control stand in the function, with what they decide.
struct GaussNewtonOptions {
  int most_steps = 12;
  double enough = 0.01;  ///< χ² must fall by more than this in a step, or the fit ends: a hundredth of what one
                         ///< independent residual of variance 1 is worth
  double enough_relative = 1e-6;  ///< plus this share of χ²
};

/// Gauss–Newton in a box with a Jacobian that is kept while it predicts well:
///
///   (1)  d = argmin ½ dᵀH d + gᵀd in the box of the step        bounded_step()
///   (2)  predicted fall of χ² = |r|²:  −2 gᵀd − dᵀH d
///   (3)  u ← u + s d with the first s = 1, 0.35, 0.35² … 0.35⁴ for which χ² falls
///   (4)  J is found anew where χ² fell by less than 70 % of (2), else kept
///   (5)  a step that had to be shortened halves the trust region; where no share of a step with a new J is better, the
///        trust region shrinks to a fifth of it, down to its smallest, before the fit ends. One direction along which
///        the slope says nothing (a state at the start while friction sticks) would end it for all others
///
/// A Problem has
///
///   bool find_jacobian()                                 at the present point; false where it is not finite
///   NormalEquations normal_equations()
///   StepBox box(double trust)                            bounds of a step; trust: share of the trust region, 0.05 … 1
///   double chi_squared()                                 at the present point
///   std::optional<double> try_step(const VectorXd& d)    χ² at u + d; nullopt: no such model
///   void accept()                                        the tried point becomes the present one
///
/// Source: J. Nocedal and S. J. Wright, Numerical Optimization, 2006, ch. 10.3 (Gauss–Newton), 3.1
/// (back-tracking), 16.7 (bounds); (4) is the chord or Shamanskii method, C. T. Kelley, Solving Nonlinear Equations
/// with Newton's Method, 2003.
template <class Problem>
void gauss_newton(Problem& problem, const GaussNewtonOptions& options) {
  constexpr int most_attempts = 5;                             // of (3): the shortest step is 0.35⁴ = 1.5 % of d
  constexpr double shorter = 0.35;                             // (3)
  constexpr double keeps_promise = 0.7;                        // (4)
  constexpr double smallest_trust = 0.05, much_smaller = 0.2;  // (5)
  double trust = 1.0;
  int age = -1;  // steps for which J has been kept; −1: it is to be found
  for (int step = 0; step < options.most_steps; ++step) {
    if (age < 0) {
      if (!problem.find_jacobian()) return;
      age = 0;
    }
    const auto [hessian, gradient] = problem.normal_equations();
    const Eigen::VectorXd d = bounded_step(hessian, gradient, problem.box(trust));
    const double promised = -2.0 * gradient.dot(d) - d.dot(hessian * d);
    const double before = problem.chi_squared();
    const double enough = options.enough + options.enough_relative * before;
    double share = 1.0;
    bool better = false;
    for (int attempt = 0; attempt < most_attempts && promised > 0.1 * enough; ++attempt, share *= shorter) {
      const std::optional<double> chi_squared = problem.try_step(share * d);
      if (!chi_squared) continue;
      if (*chi_squared < before) {
        problem.accept();
        better = true;
        break;
      }
      if (age > 0) break;  // with the Jacobian of another place: better look here first
    }
    const double gained = before - problem.chi_squared();
    const bool kept = age > 0;
    ++age;
    if (better && gained > enough) {
      if (share < 1.0) trust = std::max(smallest_trust, 0.5 * trust);
      if (gained < keeps_promise * promised) age = -1;
      continue;
    }
    if (!kept) {
      if (better || promised <= 0.1 * enough || trust <= smallest_trust) return;
      trust = std::max(smallest_trust, much_smaller * trust);
      age = 0;
      continue;
    }
    age = -1;  // with a kept Jacobian the fit ends where that Jacobian is right, which need not be the minimum
  }
}

/// Plain Gauss–Newton for problems that are nearly linear: J is found anew for each step and the whole step is taken,
/// until a step moves the point of linearisation by less than `small` or `most_steps` were taken.
///
/// A Problem has find_jacobian(), normal_equations(), box() as above and
///
///   double move(const VectorXd& d)    how far the point of linearisation moves: parameters that are linear do not
///   count
template <class Problem>
void full_gauss_newton_steps(Problem& problem, int most_steps, double small) {
  for (int step = 0; step < most_steps; ++step) {
    if (!problem.find_jacobian()) return;
    const auto [hessian, gradient] = problem.normal_equations();
    const Eigen::VectorXd d = bounded_step(hessian, gradient, problem.box(1.0));
    if (!d.allFinite()) return;
    if (problem.move(d) < small) return;
  }
}

}  // namespace host_sim
