// A law of a family with round numbers.
#pragma once

#include <utility>
#include <vector>

#include "host_sim/identification/predict/placed_law.hpp"

namespace sample {

/// At the suspension; the motion's rms is 0.1, its largest value 0.4 (m or m/s).
inline host_sim::identification::PlacedLaw law_of(
    host_sim::identification::LawFamily family, std::vector<double> values,
    host_sim::identification::CurveOver over = host_sim::identification::CurveOver::velocity) {
  host_sim::identification::PlacedLaw law;
  law.over = over;
  law.family = family;
  law.rms = 0.1;
  law.largest = 0.4;
  law.values = std::move(values);
  return law;
}

}  // namespace sample
