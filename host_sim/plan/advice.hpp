// Ranks changes of the experiment by how much they help.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/plan/open_parameters.hpp"
#include "host_sim/plan/separation.hpp"

namespace host_sim::plan {

struct Advice {
  std::string what;                       ///< "a sensor of F_w"
  double gain;                            ///< how many times smaller effects may be
  std::string helps;                      ///< the effect that gains most, in words
  double most;                            ///< its gain
  std::vector<std::string> determines{};  ///< parameters that are open without it
};

struct AdviceResult {
  std::vector<Advice> advice;        ///< best first
  std::vector<std::string> remarks;  ///< what could not be tried
};

/// Tried by rehearsing each over the same seconds of the road:
///
///   a sensor more      each channel that the model computes and that is not recorded
///   twice the level    of the whole excitation
///   another band       sines over an octave, with the velocity of the road (rms) and at most three times its travel
///   other ducts open   each other number
///
///   (1)  gain = geometric mean over the effects of  (what is left beside the nearest rival with) ÷ (without)
///
/// of effects in the size in which they show on the road with ten standard deviations. Reasons of open combinations:
/// the sensor that would close them.
[[nodiscard]] AdviceResult advice_for(const firmware::RigDescription& description, const Setting& setting,
                                      const std::vector<Rival>& rivals, std::vector<OpenCombination>& open,
                                      const std::function<void(double)>& progress);

}  // namespace host_sim::plan
