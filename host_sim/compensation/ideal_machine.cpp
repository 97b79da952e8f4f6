#include "host_sim/compensation/ideal_machine.hpp"

namespace host_sim::compensation {

model::RigParameters<double> without_delay(model::RigParameters<double> rig) {
  rig.effects.for_each([](auto& slot) {
    using Effect = std::remove_cvref_t<decltype(slot.effect)>;
    if constexpr (model::ActsOn<Effect, model::MachinePath<double>>) slot.active = false;
  });
  rig.effects.for_each_sensor([](auto& slot, model::Channel) { slot.active = false; });
  return rig;
}

}  // namespace host_sim::compensation
