// How far rig and model are apart, by channel.
#pragma once

#include <map>
#include <vector>

#include "host_sim/diagnose/carried_noise.hpp"
#include "host_sim/diagnose/fit.hpp"

namespace host_sim::diagnose {

/// rms of the error ÷ rms of the channel, on data not used for choosing or fitting.
struct Gap {
  double before, refit, after, noise_floor;
};

/// Of every channel; nothing where nothing is held out.
[[nodiscard]] std::map<model::Channel, Gap> gaps(const Case& all, const std::vector<CarriedNoise>& noises,
                                                 const Hypothesis& given, const Hypothesis& refit,
                                                 const Hypothesis& after);

/// rms of the error ÷ rms of the channel over the fitted windows, root mean square over channels and recordings.
[[nodiscard]] double pooled_error(const Case& all, const Hypothesis& hypothesis);

}  // namespace host_sim::diagnose
