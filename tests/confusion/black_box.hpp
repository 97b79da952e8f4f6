// A black box for a component on a bench: what a model without physics reaches on the same data.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "firmware/recording/recording.hpp"

namespace confusion {

/// Polynomial NARX of the force, by least squares on one-step errors:
///
///   (1)  F_k = θᵀφ,   φ: F_{k−1}, F_{k−2}, 1, and all products of up to three of x_k, x_{k−1}, x_{k−2}
///
/// at every fifth sample, since at 1 kHz the last force is the best guess of the next. 22 numbers: more than any law
/// has. Source: S. A. Billings, Nonlinear System Identification, 2013.
class BlackBox {
 public:
  /// Fitted to all rows but the last quarter, which diagnose holds out.
  explicit BlackBox(const firmware::Recording& bench);

  /// rms of simulated − measured force ÷ rms of the measured one, over the last quarter; the first two forces are
  /// given.
  [[nodiscard]] double error() const;

 private:
  [[nodiscard]] Eigen::VectorXd row(const std::vector<double>& force, std::size_t k) const;

  std::vector<double> stroke_, force_;
  std::size_t fitted_ = 0;
  Eigen::VectorXd values_;
};

}  // namespace confusion
