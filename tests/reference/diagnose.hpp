// `diagnose` a second time, as plainly as its theory allows: simulate, whiten, scan, fit, compare by one evidence.
#pragma once

#include <string>
#include <vector>

#include "tests/reference/causes.hpp"
#include "tests/reference/evidence.hpp"
#include "tests/reference/whitening.hpp"

namespace reference {

/// The recordings of a rig, or their beginnings, and how their residuals are weighted.
class Problem {
 public:
  /// `noise`: the model through which the noise of the input passes.
  Problem(const firmware::RigDescription& description, const std::vector<firmware::Recording>& recordings, double seconds,
          const Model& noise);

  [[nodiscard]] const firmware::RigDescription& description() const { return description_; }
  [[nodiscard]] const std::vector<Measured>& recordings() const { return recordings_; }
  [[nodiscard]] Eigen::VectorXd residual(const Model& model) const;  ///< whitened; infinite where the model is no rig
  [[nodiscard]] std::vector<Cell> cells(const Eigen::VectorXd& residual) const;
  [[nodiscard]] double counted(const Eigen::VectorXd& residual) const;  ///< Σ E
  [[nodiscard]] Eigen::VectorXd weights(const Eigen::VectorXd& residual) const;

 private:
  firmware::RigDescription description_;
  std::vector<Measured> recordings_;
  std::vector<Whitening> whitenings_;
  std::vector<std::size_t> cells_;  ///< of each residual
};

/// A fitted model.
struct Fit {
  Model model;
  std::vector<Parameter> parameters;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
  double left = 0.0;      ///< Σ E
  double evidence = 0.0;  ///< (4), but for the discrepancy's own price, which is (5)
};

struct Verdict {
  struct Found {
    Cause cause;
    double confidence;  ///< (6)
  };
  std::vector<Found> causes;   ///< of any model that is kept, the surest first
  double unexplained = 0.0;    ///< (5)
  std::vector<Fit> models;     ///< that were compared, the best first
};

/// "sensor_lag of F"
[[nodiscard]] std::string words(const Cause& cause);

[[nodiscard]] Verdict diagnose(const firmware::RigDescription& description,
                               const std::vector<firmware::Recording>& recordings);

}  // namespace reference
