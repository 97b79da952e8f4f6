#include "host_sim/stability/roots/sides_of_rest.hpp"

#include <algorithm>
#include <cstddef>

#include "model/components/lever.hpp"

namespace host_sim::stability {
namespace {

using Parameters = model::RigParameters<double>;

/// The slopes of the lever's ratio at rest, from below and from above [1/m].
struct Slopes {
  double below{}, above{};
};
Slopes slopes_at_rest(const Parameters& rig) {
  const model::Lever<double> lever(rig.lever, rig.body.mass);
  Slopes slopes{lever.slope(0.0), lever.slope(0.0)};
  const auto& table = rig.lever;
  const auto between = [&](std::size_t i) {
    return (table.ratio[i + 1] - table.ratio[i]) / (table.at[i + 1] - table.at[i]);
  };
  for (std::size_t i = 0; i < table.count; ++i) {
    if (table.at[i] != 0.0) continue;
    slopes.below = i > 0 ? between(i - 1) : 0.0;
    slopes.above = i + 1U < table.count ? between(i) : 0.0;
  }
  return slopes;
}

/// The rig with a lever of one slope about rest. The table's ends are so near that its ratios stay what a description
/// may say, and a motion of 0.1 µm does not reach them.
Parameters with_slope(Parameters rig, double slope) {
  const double ratio = model::Lever<double>(rig.lever, rig.body.mass).ratio(0.0);
  const double reach = std::min(1e-2, slope == 0.0 ? 1e-2 : 0.05 * ratio / std::abs(slope));
  rig.lever = {};
  rig.lever.count = 2;
  rig.lever.at[0] = -reach;
  rig.lever.at[1] = reach;
  rig.lever.ratio[0] = ratio - slope * reach;
  rig.lever.ratio[1] = ratio + slope * reach;
  return rig;
}

void add_name(std::string& name, const char* more) { name += (name.empty() ? "" : ", ") + std::string(more); }

}  // namespace

std::vector<SideOfRest> sides_of_rest(const Parameters& rig) {
  std::vector<SideOfRest> sides{{"", rig}};
  if (rig.lever.any()) {
    const Slopes slopes = slopes_at_rest(rig);
    if (slopes.below != slopes.above) {
      sides = {{"dz_b below rest", with_slope(rig, slopes.below)}, {"dz_b above rest", with_slope(rig, slopes.above)}};
    }
  }
  const auto& damper = rig.effects.get<model::AsymmetricDamper>();
  if (!damper.active || damper.effect.difference == 0.0) return sides;
  std::vector<SideOfRest> both;
  for (const SideOfRest& side : sides) {
    for (const bool compression : {false, true}) {
      const double half = (compression ? 0.5 : -0.5) * damper.effect.difference;
      SideOfRest one = side;
      one.rig.effects.get<model::AsymmetricDamper>().active = false;
      one.rig.suspension.damping += half;
      if (one.rig.suspension.damping < 0.0) continue;
      add_name(one.name, compression ? "in compression" : "in rebound");
      both.push_back(std::move(one));
    }
  }
  return both.size() == 2 * sides.size() ? both : sides;
}

}  // namespace host_sim::stability
