// The place that explains which parity relations fail.
#pragma once

#include <string>
#include <vector>

#include "host_sim/identification/parity/parity_residual.hpp"

namespace host_sim::identification {

/// A place p with power S_p(b) in band b would make the excess x_r(b) = g_rp(b) S_p(b) in relation r. For each place,
///
///   (1)  min over S_p(b) ≥ 0 of  Σ_b Σ_r (x_r(b) − g_rp(b) S_p(b))²
///
/// relative to Σ x² of the relations that fail. The place with the least (1) is named, with its equals: "body guide or
/// sensor zdd_b". Empty where no relation fails, no place explains nine tenths, or more than three explain it equally
/// well. Source: fault isolation by structured residuals, J. Gertler, 1998, ch. 7.
[[nodiscard]] std::string likely_fault_location(const std::vector<ParityResidual>& residuals);

}  // namespace host_sim::identification
