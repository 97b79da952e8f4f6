// What a relation's residual depends on, in words.
#pragma once

#include <string>
#include <vector>

#include "host_sim/identification/parity/relation_fit.hpp"

namespace host_sim::identification {

/// Correlates the residual r with the motion d:
///
///   (1)  share of Σ r² that 1, d, ḋ, d̈ explain by least squares      "90 % follow the motion linearly"
///   (2)  share of Σ r² that one of sgn ḋ, ḋ|ḋ|, ḋ³, |ḋ|, d³, d²
///        explains beyond (1)                                          "40 % go with the cube of the velocity"
///   (3)  slope of ln rms(r) over ln rms(ḋ), second by second          "it grows faster than the motion, as its
///   power 2.0" (4)  rms(r)/rms(ḋ) of the last third ÷ that of the first          "1.8 times as large at the end …"
///
/// Empty: nothing stands out (thresholds::described_…).
[[nodiscard]] std::string describe_residual(const Signal& motion, const std::vector<ResidualSeries>& residual,
                                            const std::vector<firmware::Recording>& recordings,
                                            const SmoothWindow& window);

}  // namespace host_sim::identification
