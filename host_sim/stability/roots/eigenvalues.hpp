// Eigenvalues of real matrices whose rows differ by many powers of ten.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

namespace host_sim::stability {

/// Scales rows and columns by powers of two until each pair has about the same norm: x = T x', which leaves the
/// eigenvalues unchanged to the bit. Source: Parlett and Reinsch, Balancing a matrix for calculation of eigenvalues,
/// 1969.
void balance(Eigen::MatrixXd& matrix);

/// All eigenvalues, balanced first (Eigen's QR algorithm). Throws when it does not converge.
[[nodiscard]] std::vector<std::complex<double>> eigenvalues(Eigen::MatrixXd matrix);

}  // namespace host_sim::stability
