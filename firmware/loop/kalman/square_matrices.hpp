// Products of the filter's matrices in a fixed order.
#pragma once

#include "firmware/loop/kalman/estimator_equations.hpp"

namespace firmware {

/// to = a · b of the first n rows and columns, the rest 0; summed column by column: the same bits everywhere. `to` is
/// another matrix.
inline void multiply(EstimatorMatrix& to, const EstimatorMatrix& a, const EstimatorMatrix& b, int n) {
  to.setZero();
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < n; ++k) {
      const double factor = b(k, j);
      for (int i = 0; i < n; ++i) to(i, j) += a(i, k) * factor;
    }
  }
}

/// to = a · bᵀ likewise.
inline void multiply_transposed(EstimatorMatrix& to, const EstimatorMatrix& a, const EstimatorMatrix& b, int n) {
  to.setZero();
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < n; ++k) {
      const double factor = b(j, k);
      for (int i = 0; i < n; ++i) to(i, j) += a(i, k) * factor;
    }
  }
}

}  // namespace firmware
