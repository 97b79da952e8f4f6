#include "host_sim/identification/prepare/driving_input.hpp"

#include <algorithm>
#include <array>

#include "firmware/description/text/input_error.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;

void remove_line(std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  double sum = 0.0, moment = 0.0, spread = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double x = static_cast<double>(k) - 0.5 * (n - 1.0);
    sum += values[k] / n;
    moment += x * values[k];
    spread += x * x;
  }
  const double slope = spread > 0.0 ? moment / spread : 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    values[k] -= sum + slope * (static_cast<double>(k) - 0.5 * (n - 1.0));
  }
}

}  // namespace

std::vector<double> twice_integrated(std::vector<double> acceleration, double period) {
  const std::size_t n = acceleration.size();
  double mean = 0.0;
  for (const double a : acceleration) mean += a / static_cast<double>(n);
  for (double& a : acceleration) a -= mean;
  std::vector<double> position(n, 0.0);
  double rise = 0.0;  // of one sample
  for (std::size_t k = 1; k + 1 < n; ++k) {
    rise += period * period * (acceleration[k - 1] + 10.0 * acceleration[k] + acceleration[k + 1]) / 12.0;
    position[k + 1] = position[k] + rise;
  }
  remove_line(position);
  return position;
}

SimulationInput driving_input(const model::RigParameters<double>& rig, const firmware::Recording& recording) {
  const bool told = recording.has(Channel::z_r) || recording.has(Channel::z_cmd);
  if (rig.kind != model::RigKind::quarter_car || told) return simulation_input(rig, recording);
  constexpr std::array<Channel, 3> in_place_of_the_road{Channel::zdd_r, Channel::zdd_w, Channel::z_w};
  const auto* const found = std::find_if(in_place_of_the_road.begin(), in_place_of_the_road.end(),
                                         [&](Channel channel) { return recording.has(channel); });
  if (found == in_place_of_the_road.end()) {
    throw firmware::InputError(recording.source, 0, "nothing is measured that could drive the simulation",
                               "the road (z_r or zdd_r) or the wheel (zdd_w or z_w)");
  }
  firmware::Recording driven = recording;
  const bool wheel = *found != Channel::zdd_r;
  driven[Channel::z_r] =
      *found == Channel::z_w ? recording[Channel::z_w] : twice_integrated(recording[*found], recording.sample_period);
  if (wheel) driven[Channel::zdd_r] = recording[Channel::zdd_w];
  SimulationInput input = simulation_input(rig, driven);
  input.channel = *found;
  input.wheel_prescribed = wheel;
  return input;
}

firmware::FootPointMotion motion_of(Channel channel, const std::vector<double>& samples, double period) {
  const bool integrated = channel == Channel::zdd_r || channel == Channel::zdd_w;
  auto motion =
      motion_between(channel == Channel::x_act, integrated ? twice_integrated(samples, period) : samples, 1.0 / period);
  if (integrated) {
    for (std::size_t k = 0; k < motion.size(); ++k) motion[k].acceleration = samples[k];
  }
  return motion;
}

std::string road_remark(const SimulationInput& input) {
  const std::string channel(model::name(input.channel));
  if (input.wheel_prescribed) {
    return "the road is not measured: the wheel's motion (" + channel +
           ") drives suspension and body; tyre and road cannot be judged, and of the sensor of " + channel +
           " only gain, lag, delay and hold";
  }
  if (input.channel == Channel::zdd_r) return "z_r is not measured: zdd_r, integrated twice, drives the simulation";
  return {};
}

}  // namespace host_sim::identification
