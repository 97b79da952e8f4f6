#include "host_sim/diagnose/readings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "model/sensors.hpp"

namespace host_sim::diagnose {

using model::Channel;
using Rig = model::RigParameters<double>;

bool has_corners(const Rig& rig) {
  model::MachinePath<double> machine;
  model::SuspensionComponent<double> suspension;
  model::Piston<double> piston;
  model::Guides<double> guides;
  rig.effects.act_on(machine);
  rig.effects.act_on(suspension);
  rig.effects.act_on(piston);
  rig.effects.act_on(guides);
  bool corners = machine.rate_limit > 0.0 || suspension.dry_friction > 0.0 || suspension.free_play > 0.0 ||
                 piston.dry_friction > 0.0 || guides.body_dry_friction > 0.0 || guides.wheel_dry_friction > 0.0;
  rig.effects.for_each([&](const auto& slot) {
    if constexpr (requires { slot.effect.clearance; }) corners = corners || slot.active;
  });
  return corners;
}

Response true_channels(const Rig& rig, const Evidence& evidence, const Drive& drive, const InitialState& start,
                       std::size_t samples, Steps steps) {
  Rig bare = rig;
  bare.effects.for_each_sensor([](auto& slot, Channel) { slot = {}; });
  const bool finely = has_corners(bare) && !find_rig_fault(bare, drive.period / evidence.fine);
  const int wanted = steps == Steps::fine ? evidence.fine : (evidence.fine + 1) / 2;
  const int parts = finely ? wanted : 1;
  Response response = host_sim::respond(bare, drive, start, samples, parts);
  if (evidence.explains(Channel::zdd_r)) {
    auto& acceleration = response[index(Channel::zdd_r)];
    const std::size_t count = samples == 0 ? drive.size() : std::min(samples, drive.size());
    acceleration.resize(count);
    for (std::size_t k = 0; k < count; ++k) acceleration[k] = drive.motion[k].acceleration;
  }
  return response;
}

bool has_sensor_effect(const Rig& rig, Channel channel) {
  bool any = false;
  rig.effects.for_each_sensor([&](const auto& slot, Channel of) { any = any || (of == channel && slot.active); });
  return any;
}

namespace {

/// What was at `place` [samples]: on the cubic through the four samples around it.
double at(const std::vector<double>& values, double place) {
  const double last = static_cast<double>(values.size() - 1);
  place = std::clamp(place, 0.0, last);
  const auto i =
      std::clamp<std::size_t>(static_cast<std::size_t>(place), 1, std::max<std::size_t>(values.size(), 4) - 3);
  if (values.size() < 4) return values[static_cast<std::size_t>(place)];
  const double r = place - static_cast<double>(i);
  if (r == 0.0) return values[i];
  const double a = r + 1.0, c = r - 1.0, d = r - 2.0;
  return -r * c * d / 6.0 * values[i - 1] + a * c * d / 2.0 * values[i] - a * r * d / 2.0 * values[i + 1] +
         a * r * c / 6.0 * values[i + 2];
}

}  // namespace

std::vector<double> readings(const Hypothesis& hypothesis, const Evidence& evidence, Channel channel,
                             const std::vector<double>& truth) {
  const Rig& rig = hypothesis.rig;
  if (!has_sensor_effect(rig, channel) || truth.empty()) return truth;
  const auto c = index(channel);
  std::array<model::SensorPath<double>, model::channel_count> paths{};
  paths[c] = rig.effects.sensor_paths()[c];
  const std::optional<Renewals>& renewals = evidence.renewals[c];
  const bool held = paths[c].hold > 0.0 && renewals;
  if (held) paths[c].hold = 0.0;
  std::vector<double> values = truth;
  const model::Sensors<double> sensors(paths, evidence.drive.period);
  if (sensors.any()) {
    model::Sensors<double>::State state;
    model::Signals<double> signals{};
    for (std::size_t k = 0; k < truth.size(); ++k) {
      signals[c] = truth[k];
      if (k == 0) {
        sensors.start(state, signals, nullptr);
      } else {
        sensors.step(state, signals, nullptr);
      }
      values[k] = sensors.reading(state, channel, truth[k]);
    }
  }
  if (!held) return values;
  const HoldClock clock = hypothesis.clocks[c];
  std::vector<double> shown(values.size());
  double now = values.front();
  std::size_t n = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (n < renewals->at.size() && renewals->at[n] == k) {
      const double taken = renewals->first + clock.place * renewals->slack + renewals->turn[n] * renewals->period;
      now = clock.own && renewals->regular ? at(values, taken) : values[k];
      ++n;
    }
    shown[k] = now;
  }
  return shown;
}

Response read_channels(const Hypothesis& hypothesis, const Evidence& evidence, const Drive& drive,
                       const InitialState& start, std::size_t samples) {
  Response response = true_channels(hypothesis.rig, evidence, drive, start, samples);
  for (const Channel channel : evidence.channels) {
    if (has_sensor_effect(hypothesis.rig, channel)) {
      response[index(channel)] = readings(hypothesis, evidence, channel, response[index(channel)]);
    }
  }
  return response;
}

}  // namespace host_sim::diagnose
