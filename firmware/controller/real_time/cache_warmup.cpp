#include "firmware/controller/real_time/cache_warmup.hpp"

#include <algorithm>
#include <cstddef>

namespace firmware::controller {
namespace {

hal::simulated::Construction construction(const Settings& settings, const hal::SensorSetup& sensors) {
  hal::simulated::Construction c;
  c.period = settings.period;
  for (std::size_t i = 0; i < sensors.size(); ++i) c.sensors[i].fitted = sensors[i].fitted;  // no range: zeros are good
  return c;
}

/// At rest where it is: from the first period on it runs.
Settings at_once(Settings settings) {
  settings.ramps.rest = 0.0;
  settings.ramps.settling = 0.0;
  settings.arming = {};
  return settings;
}

void ask_for(const void* memory, std::size_t size) {
  constexpr std::size_t line = 64;
  const auto* bytes = static_cast<const std::byte*>(memory);
  for (std::size_t i = 0; i < size; i += line) __builtin_prefetch(bytes + i, 1);
}

}  // namespace

void CacheWarmup::IdlePlant::do_measure(std::span<double, hal::channel_capacity> values) {
  std::fill(values.begin(), values.end(), 0.0);
}

CacheWarmup::CacheWarmup(const ControlLoop& loop, const Journal& journal, const Settings& settings,
                         const model::RigParameters<double>& parameters, const hal::SensorSetup& sensors)
    : loop_(loop),
      journal_(journal),
      rig_(idle_plant_, construction(settings, sensors)),
      stand_in_(at_once(settings), parameters, rig_.roles(), idle_plant_, ValvePlan(), records_) {
  stand_in_.arm();
  stand_in_.start();
}

void CacheWarmup::step() {
  rig_.roles().clock.sleep_until(stand_in_.due());
  stand_in_.step();
  while (records_.pop()) {
  }
  ask_for(&loop_, sizeof loop_);
  ask_for(&journal_.next(), sizeof(Record));
}

}  // namespace firmware::controller
