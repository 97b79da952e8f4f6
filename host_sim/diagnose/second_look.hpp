// A rig that is not all in the catalogue.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/diagnose/search.hpp"

namespace host_sim::diagnose {

/// In units of noise, details of what cannot be explained outweigh the effects that matter. `look` searches a case that
/// allows for an error of the model as large as `left`, the pooled error of what was found; this says with which
/// prices: smaller steps, the rig first and sensors last. What is better replaces what was found; what is not, but
/// nearly, is remarked.
[[nodiscard]] Findings second_look(const Case& all, Findings found, double left,
                                   const std::function<Findings(const Price&)>& look,
                                   std::vector<std::string>& remarks);

}  // namespace host_sim::diagnose
