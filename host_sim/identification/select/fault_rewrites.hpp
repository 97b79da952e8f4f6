// Other words for faults of the recordings and effects of sensors that were found.
#pragma once

#include <optional>

#include "host_sim/identification/select/model_fitter.hpp"

namespace host_sim::identification {

/// A late and smooth channel can be said in several ways: a clock, a filter, a delay or a lag of its sensor. A search
/// adds them one at a time, so what it found together may be longer than need be. Each of these is one model to be
/// tried in the place of `whole`, everything refitted.

/// A filter of the order that the motion shows, where that leaves nothing but noise: the noise itself, with few samples
/// above the corner, may not. It starts from the same delay. false: it has that order.
bool improve_order(const ModelFitter& fitter, CandidateModel& model, std::size_t fault);

/// A clock whose offset or rate is not worth its price is left with the other one. false: both are.
bool simplify_clock(const ModelFitter& fitter, CandidateModel& model, std::size_t fault);

/// Without a clock whose channels are behind a filter that is there: its group was taken from noises, and one may not
/// have shown it. A clock of that filter's own channels gives its delay to the corner. nullopt: no filter makes it
/// better.
[[nodiscard]] std::optional<CandidateModel> in_filter(const ModelFitter& fitter, const CandidateModel& whole,
                                                      std::size_t clock);

/// Without an effect of a sensor, whose channel joins the group of a clock or filter that is there: three low-passes of
/// one recorder may have been found as a filter of two channels and a delay of the third. Or a delay that a clock of
/// this channel takes over. nullopt: no group makes it better.
[[nodiscard]] std::optional<CandidateModel> in_group(const ModelFitter& fitter, const CandidateModel& whole,
                                                     std::size_t effect);

/// One filter of first order in the place of lags of several sensors that are alike, or one late clock in the place of
/// their delays. `effect`: the first of them. nullopt: there are no others, or each of its own is better.
[[nodiscard]] std::optional<CandidateModel> in_one_fault(const ModelFitter& fitter, const CandidateModel& whole,
                                                         std::size_t effect);

/// With an effect of a sensor in the place of a clock or filter of one channel, or of the input: a delay, or a lag for
/// a filter of first order. For such a filter of several channels a lag of each, without clocks of these alone.
/// nullopt: the fault is none of these.
[[nodiscard]] std::optional<CandidateModel> by_sensors(const ModelFitter& fitter, const CandidateModel& whole,
                                                       std::size_t fault);

}  // namespace host_sim::identification
