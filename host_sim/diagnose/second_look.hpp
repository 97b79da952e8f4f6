// A rig that is not all in the catalogue.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/diagnose/search.hpp"

namespace host_sim::diagnose {

/// Searches a case that allows for a model error, with such prices. What was found is compared with rivals where that
/// is worth it; no question: always.
using Look = std::function<Findings(const Price&, const std::function<bool(const Findings&)>& is_worth_comparing)>;

/// In units of noise, details of what cannot be explained outweigh the effects that matter. `look` allows for an error
/// of the model as large as `left`, the pooled error of what was found; this says with which prices: smaller steps, the
/// rig first and sensors last. What is better replaces what was found, and true is returned; what is not, but nearly,
/// is remarked.
[[nodiscard]] bool second_look(const Case& all, Findings& found, double left, const Look& look,
                               std::vector<std::string>& remarks);

}  // namespace host_sim::diagnose
