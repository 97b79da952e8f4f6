#include "host_sim/comparison/static_value.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace host_sim {
namespace {

using model::Channel;
using model::RigKind;

constexpr double gravity = 9.81;

bool may_have_one(RigKind kind, Channel channel) {
  if (kind == RigKind::quarter_car) {
    return channel != Channel::x_cmd && channel != Channel::x_act && channel != Channel::F && channel != Channel::F_act;
  }
  if (kind == RigKind::driven_mass)
    return channel == Channel::F || channel == Channel::x_act || channel == Channel::zdd_b;
  return kind == RigKind::component_bench && channel == Channel::F;
}

bool is_acceleration(Channel channel) {
  return channel == Channel::zdd_r || channel == Channel::zdd_w || channel == Channel::zdd_b;
}

}  // namespace

std::vector<StaticValue> static_values(const model::RigParameters<double>& rig, const firmware::Recording& recording,
                                       const UnusableSamples& unusable) {
  std::vector<StaticValue> found;
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const Channel channel = model::channel_at(c);
    if (!recording.has(channel) || !may_have_one(rig.kind, channel)) continue;
    const std::vector<double>& samples = recording[channel];
    const auto counts = [&](std::size_t k) {
      const bool filled = k < recording.filled.size() && recording.filled[k];
      return !filled && (unusable[c].empty() || !unusable[c][k]) && std::isfinite(samples[k]);
    };
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (!counts(k)) continue;
      sum += samples[k];
      count += 1.0;
    }
    if (!(count > 0.0)) continue;
    const double mean = sum / count;
    std::optional<StaticValue> value;
    if (channel == Channel::F_w) {
      const double load = gravity * (rig.body.mass + rig.wheel.mass);
      if (std::abs(mean) > 0.5 * load) value = {channel, mean, load, StaticValue::Kind::wheel_load};
    } else if (is_acceleration(channel)) {
      if (std::abs(mean) > 0.5 * gravity) value = {channel, mean, gravity, StaticValue::Kind::gravity};
    }
    if (!value && !is_acceleration(channel)) {
      double farthest = 0.0;
      for (std::size_t k = 0; k < samples.size(); ++k) {
        if (counts(k)) farthest = std::max(farthest, std::abs(samples[k] - mean));
      }
      // A channel that never moves is a dead sensor, which is said elsewhere.
      if (farthest > 0.0 && std::abs(mean) > 2.0 * farthest) {
        value = {channel, mean, 0.0, StaticValue::Kind::unknown};
      }
    }
    if (value) found.push_back(*value);
  }
  return found;
}

void tare(const std::vector<StaticValue>& values, firmware::Recording& recording) {
  for (const StaticValue& value : values) {
    for (double& sample : recording[value.channel]) sample -= value.value;
  }
}

std::string words(const StaticValue& value) {
  const std::string channel(model::name(value.channel)), unit(model::unit(value.channel));
  char text[200];
  if (value.kind == StaticValue::Kind::wheel_load) {
    std::snprintf(text, sizeof text, "%s holds the static wheel load, %.4g N (described: %.4g N); it was taken off",
                  channel.c_str(), value.value, value.expected);
  } else if (value.kind == StaticValue::Kind::gravity) {
    std::snprintf(text, sizeof text, "%s holds gravity, %.4g %s; it was taken off", channel.c_str(), value.value,
                  unit.c_str());
  } else {
    std::snprintf(text, sizeof text,
                  "%s holds a constant, %.4g %s, of which the rig description says nothing; it was "
                  "taken off",
                  channel.c_str(), value.value, unit.c_str());
  }
  return text;
}

}  // namespace host_sim
