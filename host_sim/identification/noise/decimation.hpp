// Fewer samples of a signal, without what they cannot hold.
#pragma once

#include <cstddef>
#include <vector>

namespace host_sim::identification {

/// Every 2^n-th sample of a signal whose interesting part ends at `highest`: n half-band filters one after the other,
/// each followed by dropping every second sample,
///
///   (1)  y_k = ½ x_{2k} + Σ_{j odd} h_j (x_{2k−j} + x_{2k+j}),   h_j = sin(πj/2)/(πj) · Kaiser window
///
/// with zeros before the first and after the last sample. Up to `highest` the gain is 1 and nothing is folded there,
/// both within `ripple`. n is the largest for which the new Nyquist frequency is 1.25 `highest` at least.
class Decimation {
 public:
  static constexpr double ripple = 1e-5;

  Decimation(double sample_rate, double highest);

  [[nodiscard]] std::size_t factor() const { return std::size_t{1} << stages_.size(); }

  /// Of a signal whose length is a multiple of factor().
  [[nodiscard]] std::vector<double> operator()(std::vector<double> signal) const;

 private:
  std::vector<std::vector<double>> stages_;  ///< h_1, h_3, … of each
};

}  // namespace host_sim::identification
