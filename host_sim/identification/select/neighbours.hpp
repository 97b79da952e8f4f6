// Effects of a machine that a fault of the recording may be instead.
#pragma once

#include <vector>

#include "host_sim/identification/select/model_fitter.hpp"

namespace host_sim::identification {

/// What makes every channel that follows the command late is said by the machine as well as by the recorder:
///
///   clock, late by τ                  delay τ
///   common filter of order n at f     delay τ · lag τ · half of each · resonance f,     τ = butterworth_delay(n)/(2π f)
///
/// Each of these in the place of the fault, fitted with everything else; an effect that is there already takes up what
/// it lacks. Empty: the fault is of some channels alone, or the noises show it (PlacedFault::seen), or nothing commands
/// a machine here.
[[nodiscard]] std::vector<CandidateModel> machine_instead(const ModelFitter& fitter, const CandidateModel& whole,
                                                          std::size_t fault);

}  // namespace host_sim::identification
