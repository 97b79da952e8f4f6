#include "host_sim/stability/roots/eigenvalues.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

namespace host_sim::stability {

void balance(Eigen::MatrixXd& matrix) {
  const Eigen::Index n = matrix.rows();
  bool changed = true;
  for (int sweep = 0; changed && sweep < 32; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double diagonal = std::abs(matrix(i, i));
      const double row = matrix.row(i).lpNorm<1>() - diagonal;
      const double column = matrix.col(i).lpNorm<1>() - diagonal;
      if (!(row > 0.0) || !(column > 0.0)) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (row / factor + column * factor < 0.95 * (row + column)) {
        matrix.row(i) /= factor;
        matrix.col(i) *= factor;
        changed = true;
      }
    }
  }
}

std::vector<std::complex<double>> eigenvalues(Eigen::MatrixXd matrix) {
  if (matrix.rows() == 0) return {};
  if (!matrix.allFinite()) throw std::domain_error("eigenvalues of a matrix with numbers that are not finite");
  balance(matrix);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix, false);
  if (solver.info() != Eigen::Success) throw std::runtime_error("the QR algorithm did not converge");
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

}  // namespace host_sim::stability
