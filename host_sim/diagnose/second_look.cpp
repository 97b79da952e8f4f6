#include "host_sim/diagnose/second_look.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "host_sim/diagnose/gap.hpp"
#include "host_sim/diagnose/story.hpp"

namespace host_sim::diagnose {

bool second_look(const Case& all, Findings& found, double left, const Look& look, std::vector<std::string>& remarks) {
  Price smaller;
  smaller.later_share = 0.1;
  smaller.beam = 1;
  smaller.tried = 5;
  smaller.compared = 3;
  // Sensors last: several of them bend any channel into place, but what a rig does has one cause for all channels.
  double least = 0.98 * left;
  bool replaced = false;
  for (const bool sensors : {false, true}) {
    smaller.sensors = sensors;
    double error = INFINITY;
    const auto is_less = [&](const Findings& findings) {
      error = pooled_error(all, findings.best.fit.hypothesis);
      return error < least;
    };
    Findings again = sensors ? look(smaller, is_less) : look(smaller, {});
    const bool less = is_less(again);
    again.simulations += found.simulations;
    again.tried += found.tried;
    if (less) {
      found = std::move(again);
      replaced = true;
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
  return replaced;
}

}  // namespace host_sim::diagnose
