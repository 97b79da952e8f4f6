// The linear least-squares problem with bounds: one step of every fit on the workbench.
#pragma once

#include <Eigen/Core>

namespace host_sim {

/// Bounds of a step: lower ≤ d ≤ upper, component by component.
struct StepBox {
  Eigen::VectorXd lower, upper;
};

/// The step d that minimises the quadratic model of ½|r(u + d)|² in a box:
///
///   (1)  min ½ dᵀH d + gᵀd   with lower ≤ d ≤ upper,   H = JᵀJ, g = Jᵀr
///
/// Active set on the normal equations: the free components are solved for, the component that is furthest beyond a
/// bound is fixed there, and a fixed component whose gradient points inwards is freed again, until no component changes
/// (the Kuhn–Tucker conditions hold). A ridge of 1e-12 of the diagonal keeps directions that the data do not see at 0.
///
/// Source: P. B. Stark and R. L. Parker, Bounded-variable least squares: an algorithm and applications, Computational
/// Statistics 10, 1995; after C. L. Lawson and R. J. Hanson, Solving Least Squares Problems, 1974, ch. 23.
[[nodiscard]] Eigen::VectorXd bounded_step(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient,
                                           const StepBox& box);

}  // namespace host_sim
