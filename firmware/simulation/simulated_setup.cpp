#include "firmware/simulation/simulated_setup.hpp"

#include "firmware/simulation/simulated_rig.hpp"

namespace firmware {

hal::SensorSetup simulated_sensors(const RigDescription& description) {
  using model::Channel;
  hal::SensorSetup setup{};
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const Channel channel = model::channel_at(i);
    const bool relative_only = channel == Channel::z_w || channel == Channel::z_b || channel == Channel::F_act;
    setup[i].fitted = is_hardware_channel(description.rig.kind, channel) && !relative_only;
    if (const auto range = trusted_range(description, i)) {
      setup[i].lowest = range->lower;
      setup[i].highest = range->upper;
    }
  }
  return setup;
}

hal::simulated::Construction simulated_construction(const RigDescription& description, hal::Time start) {
  hal::simulated::Construction construction;
  construction.period = hal::seconds(description.period());
  construction.start = start;
  construction.sensors = simulated_sensors(description);
  construction.ducts = description.rig.has_fdva ? static_cast<std::size_t>(description.rig.fdva.ducts) : 0;
  construction.drive_enable = true;
  if (description.hardware.gpio) construction.interlocks = description.hardware.gpio->interlocks.size();
  construction.safe_position = hal::Openings::from_bits(description.controller.safe_ducts);
  return construction;
}

}  // namespace firmware
