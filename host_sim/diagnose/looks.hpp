// What a residual goes with, in words.
#pragma once

#include <string>
#include <vector>

#include "host_sim/diagnose/relation.hpp"

namespace host_sim::diagnose {

/// A relation's residual over one recording, and where it counts.
struct ResidualSeries {
  std::vector<double> values;
  std::vector<bool> trusted;
};

/// Which share follows the motion d linearly (d, ḋ, d̈), which goes beyond that with the sign, the square or the cube of
/// velocity or deflection; with which power of the motion it grows from second to second; whether it changes through
/// the record. Empty: nothing stands out.
[[nodiscard]] std::string looks_of(const Signal& motion, const std::vector<ResidualSeries>& residual,
                                   const std::vector<Recording>& recordings, const SmoothWindow& window);

}  // namespace host_sim::diagnose
