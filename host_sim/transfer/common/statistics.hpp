// Quantiles, p-values and the order of draws.
#pragma once

#include <cstddef>
#include <vector>

namespace host_sim::transfer {

/// Linear between the order statistics: the p-quantile of n values is at p (n − 1). Values need not be sorted.
[[nodiscard]] double quantile(std::vector<double> values, double p);

struct Bands {
  double median = 0.0, low50 = 0.0, high50 = 0.0, low95 = 0.0, high95 = 0.0;
};
[[nodiscard]] Bands bands_of(std::vector<double> values);

[[nodiscard]] double mean_of(const std::vector<double>& values);
[[nodiscard]] double variance_of(const std::vector<double>& values);  ///< unbiased; 0 of fewer than two

/// Probability of a normal deviate beyond z.
[[nodiscard]] double upper_tail(double z);

/// P(X > x) of a scaled χ² with the mean and variance of `draws`:
///
///   (1)  X = c χ²_ν,   c = variance/(2 mean), ν = 2 mean²/variance        F. E. Satterthwaite, Biometrics Bull. 2,
///   1946
///
/// with the tail of χ²_ν by E. B. Wilson and M. M. Hilferty, PNAS 17, 1931. A count of draws ends at 1/draws; this does
/// not. 1 where the draws have no variance and x is not beyond them.
[[nodiscard]] double tail_probability(double x, const std::vector<double>& draws);

/// P(χ²_ν > x), by the same approximation.
[[nodiscard]] double chi_squared_tail(double x, double degrees_of_freedom);

}  // namespace host_sim::transfer
