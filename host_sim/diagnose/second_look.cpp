#include "host_sim/diagnose/second_look.hpp"

#include <cstdio>
#include <utility>

#include "host_sim/diagnose/gap.hpp"
#include "host_sim/diagnose/story.hpp"

namespace host_sim::diagnose {

Findings second_look(const Case& all, Findings found, double left, const std::function<Findings(const Price&)>& look,
                     std::vector<std::string>& remarks) {
  Price smaller;
  smaller.later_share = 0.1;
  smaller.beam = 1;
  smaller.tried = 5;
  smaller.compared = 3;
  // Sensors last: several of them bend any channel into place, but what a rig does has one cause for all channels.
  double least = 0.98 * left;
  for (const bool sensors : {false, true}) {
    smaller.sensors = sensors;
    smaller.compare = !sensors;
    Findings again = look(smaller);
    double error = pooled_error(all, again.best.fit.hypothesis);
    if (sensors && error < least) {
      smaller.compare = true;
      again = look(smaller);
      error = pooled_error(all, again.best.fit.hypothesis);
    }
    again.simulations += found.simulations;
    again.tried += found.tried;
    if (error < least) {
      found = std::move(again);
      left = error;
      least = 0.75 * error;
      continue;
    }
    found.simulations = again.simulations;
    found.tried = again.tried;
    if (!sensors || error >= 0.98 * left) continue;
    std::vector<std::string> names;
    for (const PlacedEffect& effect : again.best.effects) names.push_back(words(effect));
    char change[64];
    std::snprintf(change, sizeof change, " would leave an error of %.3g %%, instead of %.3g %%", 100.0 * error,
                  100.0 * left);
    remarks.push_back(joined(names) + change + ": rivals of what is listed, which has fewer causes in sensors");
  }
  return found;
}

}  // namespace host_sim::diagnose
