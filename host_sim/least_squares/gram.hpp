// Products of long, narrow matrices.
#pragma once

#include <Eigen/Core>

namespace host_sim {

/// JᵀJ. Each product of two columns is summed in eight partial sums, which are added in pairs: an order that every
/// processor keeps, whatever the width of its registers.
[[nodiscard]] Eigen::MatrixXd gram(const Eigen::MatrixXd& j);

/// Jᵀr in the same order.
[[nodiscard]] Eigen::VectorXd transposed_product(const Eigen::MatrixXd& j, const Eigen::VectorXd& r);

}  // namespace host_sim
