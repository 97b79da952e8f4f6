#include "host_sim/comparison/fine_steps.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "firmware/description/rig_description.hpp"

namespace host_sim {
namespace {

using Rig = model::RigParameters<double>;

/// true: an active effect satisfies a predicate.
template <class Predicate>
bool any_effect(const Rig& rig, Predicate holds) {
  bool any = false;
  rig.effects.for_each([&](const auto& slot) { any = any || (slot.active && holds(slot.effect)); });
  return any;
}

}  // namespace

bool has_corners(const Rig& rig) {
  return any_effect(rig, [](const auto& effect) { return effect.card.corner != model::Corner::none; });
}

bool has_free_play(const Rig& rig) {
  return any_effect(rig, [](const auto& effect) { return effect.card.corner == model::Corner::free_play; });
}

bool is_stepped_finely(const Rig& rig) {
  return rig.laws.any() || has_corners(rig) || any_effect(rig, []<class Effect>(const Effect&) {
           return model::SuspensionLaw<Effect> || model::HistoryLaw<Effect> || model::TyreLaw<Effect>;
         });
}

int fine_steps(double period, double slower) {
  return std::max(1, static_cast<int>(std::lround(period / (slower * longest_bent_step))));
}

int steps_of(const Rig& rig, double period, int fine) {
  return is_stepped_finely(rig) && !firmware::find_rig_fault(rig, period / fine) ? fine : 1;
}

}  // namespace host_sim
