// A filter of finite length over a long signal.
#pragma once

#include <cstddef>

namespace host_sim {

/// sums[k] += weights[0] values[k] + … + weights[taps − 1] values[k + taps − 1] for each k < count, the products added
/// in this order. `sums` lies apart from the others.
void add_weighted_sums(const double* weights, std::size_t taps, const double* values, double* sums, std::size_t count);

}  // namespace host_sim
