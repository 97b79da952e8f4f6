#include "firmware/loop/guards/frozen_guard.hpp"

#include "model/effects/catalogue.hpp"
#include "model/rig/rig_equations.hpp"

namespace firmware {

using model::Channel;

FrozenGuard::FrozenGuard(const Supervision& supervision, const model::RigParameters<double>& rig, double period)
    : time_(supervision.frozen_time),
      samples_(static_cast<std::int32_t>(supervision.frozen_time / period)),
      way_(static_cast<float>(supervision.frozen_way)),
      speed_(static_cast<float>(supervision.frozen_speed)),
      acceleration_(static_cast<float>(supervision.frozen_acceleration)) {
  if (time_ <= 0.0) return;
  model::SuspensionComponent<double> component{};
  rig.effects.act_on(component);
  way_ += static_cast<float>(component.free_play);
  const auto paths = rig.effects.sensor_paths();
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const Channel channel = model::channel_at(i);
    watched_[i] = paths[i].limit == 0.0 && paths[i].hold == 0.0 && paths[i].gain != 0.0;
    if (channel == Channel::x_cmd || channel == Channel::z_cmd || channel == Channel::F_act) watched_[i] = false;
    if (channel == Channel::F && model::spring_stiffness(rig, true) == 0.0 && !rig.has_fdva) watched_[i] = false;
    if (channel == Channel::dz_b && (component.dry_friction > 0.0 || component.free_play > 0.0)) watched_[i] = false;
  }
}

void FrozenGuard::start() {
  for (Watch& watch : watches_) watch.samples = -1;
}

bool FrozenGuard::by_position(Channel channel) {
  return channel == Channel::x_act || channel == Channel::z_r || channel == Channel::F;
}

std::optional<Trip> FrozenGuard::follow(const SampleGuard& samples, double expected, const hal::Command& command,
                                        hal::Time now, std::optional<Channel> known) {
  std::optional<Trip> hazard;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const Channel channel = model::channel_at(i);
    if (!watched_[i] || !samples.fitted(channel)) continue;
    const hal::Reading& reading = samples.frame().channels[i];
    if (reading.quality == hal::Quality::missing) continue;
    Watch& watch = watches_[i];
    const bool positional = by_position(channel);
    const auto first = static_cast<float>(positional ? expected : command.velocity);
    const auto second = static_cast<float>(positional ? 0.0 : command.acceleration);
    const auto value = static_cast<float>(reading.value);
    if (watch.samples < 0 || value != watch.value) {
      watch.value = value;
      watch.samples = 0;
      watch.first.begin(first);
      watch.second.begin(second);
      continue;
    }
    if (watch.samples < samples_) ++watch.samples;
    watch.first.hold(first);
    watch.second.hold(second);
    if (watch.samples < samples_ || (hazard && hazard->channel != known)) continue;
    const bool moved = positional ? watch.first.width() >= way_                                              // (1)
                                  : watch.first.width() >= speed_ && watch.second.width() >= acceleration_;  // (2)
    if (moved) {
      hazard = hazard_of(Reason::sensor_frozen, channel, reading.value, time_, now);
    }
  }
  return hazard;
}

}  // namespace firmware
