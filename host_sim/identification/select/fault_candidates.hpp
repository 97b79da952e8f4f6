// Faults of the recording that a model leaves visible, proposed without a simulation.
#pragma once

#include <vector>

#include "host_sim/identification/estimate/fit.hpp"

namespace host_sim::identification {

/// A fault with values to start from, and the χ² it promises while everything fitted already makes way linearly.
struct FaultCandidate {
  PlacedFault fault;
  double gain = 0.0;
};

/// Faults that stand out of the residuals of a fit, the best first; those of a kind and place that are in its
/// hypothesis already are left out.
///
///   clock          ∂r/∂offset_c and ∂r/∂rate_c of each channel c by differences of its readings. For each group of
///                  channels these are added, and the best offset and rate follow from (3) of LinearRefit: all groups
///                  cost no more than their 2×2 systems. The input's own clock shows as the group of all others.
///   common_filter  below its corner a filter is a delay: the groups whose common offset gains most are tried with
///                  orders 1 and 2 and thresholds::filter_corners; and those of filters_seen()
///   mains_hum      the largest line of the residuals within thresholds::hum_range of the mains' frequencies
///   drift          (1)  d = F{ t/T F⁻¹{∂r/∂p} } · p       for each parameter p of rig and effects; the derivative is
///                       that of the fit's Jacobian, or costs a simulation for a parameter that is no part of it
///
///                  (2)  and only where one change of the form of recording_faults.hpp (4) gains what sizes of p gain
///                       that are free at thresholds::drift_pieces instants, but for thresholds::drift_remainder of it
///
/// (1): a rig whose parameter is p (1 + s t/T) answers as the derivative says, weighted with time, as long as its
/// motion forgets fast beside T. (2): the
/// size of a law that is another one goes with the motion, up and down. Source: score tests, as linear_refit.hpp. A
/// fault must promise more than a parameter that is only off (suspect_parameters.hpp): one that is described as exact,
/// or at the bound of its tolerance. `only_noise`: the fit leaves nothing but noise in each band, so only drifts are
/// tried that cost no simulation: what changes with time is weak in every band.
[[nodiscard]] std::vector<FaultCandidate> fault_candidates(const IdentificationProblem& problem, const Fit& base,
                                                           bool only_noise);

/// Low-passes that the colours of the noises show (noise/recorder_filter.hpp): each acts on the channels whose noise is
/// behind it or, where the input's is, inversely on the others. A filter that all channels share with the input is
/// none.
[[nodiscard]] std::vector<PlacedFault> filters_seen(const IdentificationProblem& problem);

/// The same fault with one channel more or less, where that promises at least `least` [χ²]: best first. Of a filter
/// that the noises show, the channels whose noise says nothing of it.
[[nodiscard]] std::vector<FaultCandidate> neighbouring_groups(const IdentificationProblem& problem, const Fit& base,
                                                              std::size_t fault, double least);

}  // namespace host_sim::identification
