#include "host_sim/identification/predict/true_input.hpp"

#include <algorithm>
#include <vector>

#include "host_sim/identification/predict/recording_faults.hpp"

namespace host_sim::identification {

using model::Channel;
using Motion = model::Motion<double>;

namespace {

using Path = model::SensorPath<double>;

/// (0): motion is linear in the samples, so what the hold took away is added to it.
void fill_hold(firmware::FootPointMotion& motion, const PreparedRecording& recording, Channel channel,
               const HoldClock& clock) {
  const std::vector<double>& held = recording.recording[channel];
  std::vector<double> missing = before_hold(held, *recording.renewals[index(channel)], clock);
  for (std::size_t k = 0; k < missing.size(); ++k) missing[k] -= held[k];
  const auto added = recording.motion_of_input(missing);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    for (double Motion::*part : {&Motion::position, &Motion::velocity, &Motion::acceleration}) {
      motion[k].*part += added[k].*part;
    }
  }
}

/// (1)
void set_earlier(firmware::FootPointMotion& motion, double delay, double period) {
  std::vector<double> values(motion.size());
  for (double Motion::*part : {&Motion::position, &Motion::velocity, &Motion::acceleration}) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = motion[k].*part;
    values = shifted(values, -delay, 0.0, period);
    for (std::size_t k = 0; k < values.size(); ++k) motion[k].*part = values[k];
  }
}

/// (2)
void sharpen(firmware::FootPointMotion& motion, double lag, double period) {
  const firmware::FootPointMotion late = motion;
  const std::size_t last = late.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const std::size_t before = k > 0 ? k - 1 : 0, behind = std::min(k + 1, last);
    const double width = period * static_cast<double>(std::max<std::size_t>(behind - before, 1));
    motion[k].position += lag * late[k].velocity;
    motion[k].velocity += lag * late[k].acceleration;
    motion[k].acceleration += lag * (late[behind].acceleration - late[before].acceleration) / width;
  }
}

}  // namespace

bool can_be_undone(const firmware::CatalogueEntry& effect, const PreparedRecording& recording, Channel channel) {
  model::RigParameters<double> rig;
  firmware::put_effect(rig, {&effect, channel, std::vector<double>(effect.parameters.size(), 1.0)});
  const Path path = rig.effects.sensor_paths()[index(channel)];
  return path.offset == 0.0 && path.limit == 0.0 && (path.hold == 0.0 || recording.renewals[index(channel)]);
}

std::optional<TrueInput> true_input(const Hypothesis& hypothesis, const PreparedRecording& recording,
                                    const SimulationInput& input, const InitialState& start) {
  const std::optional<Channel> channel = recording.input_sensor();
  if (!channel || input.size() == 0) return std::nullopt;
  const auto c = index(*channel);
  const model::RigParameters<double>& rig = hypothesis.rig;
  const Path path = rig.effects.sensor_paths()[c];
  const bool held = path.hold > 0.0 && recording.renewals[c];
  if (path.gain == 1.0 && path.lag == 0.0 && path.delay == 0.0 && !held) return std::nullopt;
  TrueInput truth{input, start};
  auto& motions = truth.input.motion;
  if (held) fill_hold(motions, recording, *channel, hypothesis.clocks[c]);
  if (path.delay > 0.0) set_earlier(motions, path.delay, input.period);
  if (path.lag > 0.0) sharpen(motions, path.lag, input.period);
  for (Motion& motion : motions) {
    motion.position /= path.gain;
    motion.velocity /= path.gain;
    motion.acceleration /= path.gain;
  }
  const bool has_car = rig.kind != model::RigKind::component_bench && !input.is_force();
  for (int state = 0; state < 4 && has_car; ++state) {
    double Motion::*const part = state % 2 == 0 ? &Motion::position : &Motion::velocity;
    truth.start(state) += motions.front().*part - input.motion.front().*part;
  }
  return truth;
}

}  // namespace host_sim::identification
