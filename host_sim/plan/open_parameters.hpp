// Expected intervals of the rig's own parameters, and the combinations that stay open.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "host_sim/plan/rehearsal.hpp"

namespace host_sim::plan {

/// Half widths of relative 95 % intervals.
struct PlannedParameter {
  std::string path;
  double described;          ///< [SI]
  double determined_to;      ///< nothing else known of the rig; at most that of its prior
  double beside_tolerances;  ///< the others as described, within their tolerances
  double tolerance = 0.0;    ///< relative; 0: none
  std::string why{};         ///< this excitation does not reach it; empty where it does
  [[nodiscard]] bool open() const;
};

/// A combination of parameters that leaves every channel as it is: relative changes of each.
struct OpenCombination {
  struct Part {
    std::string path;
    double change;  ///< relative to the largest, 1 … −1
  };
  std::vector<Part> parts;
  std::string combination, why;  ///< in words
};

/// Information of the recording on all parameters of the rig, in logarithms of their values:
///
///   (1)  H = JᵀJ                      Fisher's information, J over all parameters of the explained part and of the
///                                     effects that are described
///   (2)  C = (H + 12/(n width²))⁻¹    width: of the prior, a factor of thresholds::parameter_range either way; n
///                                     parameters, so that all in one ratio are known no better than one
///   (3)  open: eigenvectors of H with 1.96/√λ > thresholds::open, as sparse a basis of them as elimination finds
struct Information {
  std::vector<identification::FreeParameter> parameters;
  Eigen::MatrixXd matrix;  ///< H
};
[[nodiscard]] Information information_of(const Rehearsal& rehearsal);

[[nodiscard]] std::vector<PlannedParameter> planned_parameters(const Rehearsal& rehearsal,
                                                               const firmware::RigDescription& description,
                                                               const Information& information);
/// Without reasons, which advice finds.
[[nodiscard]] std::vector<OpenCombination> open_combinations(const Information& information);

/// Half width of the 95 % interval of a combination (2).
[[nodiscard]] double known_to(const Information& information, const OpenCombination& combination);

}  // namespace host_sim::plan
