// How much of the second rig's motion the first rig's recordings have shown.
#pragma once

#include <algorithm>

#include "host_sim/transfer/posterior/posterior.hpp"
#include "host_sim/transfer/predict/second_rig.hpp"

namespace host_sim::transfer {

/// Of the deflection of the component:
///
///   (1)  in_frequency = share of the second rig's velocity power, ∫ f² S df, in third-octaves where the first rig's is
///                       at least 1 % of it
///   (2)  in_travel    = share of the second rig's samples within the largest |deflection| of the first rig
struct Overlap {
  double in_frequency = 1.0, in_travel = 1.0;
  double lowest = 0.0, highest = 0.0;  ///< [Hz] where the first rig moved, among the second's bands
  [[nodiscard]] double least() const { return std::min(in_frequency, in_travel); }
};
[[nodiscard]] Overlap overlap_of(const identification::Identified& first, const SecondRig& second,
                                 const model::RigParameters<double>& second_rig);

}  // namespace host_sim::transfer
