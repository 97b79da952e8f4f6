#include "tests/reference/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "firmware/simulation/road.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/comparison/start_state.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "model/components/sensors.hpp"

namespace reference {
namespace {

using model::Channel;
using model::RigKind;
using Samples = std::vector<double>;

/// Of a channel most of whose samples repeat the one before: a line through the samples at which values change, since
/// k_n − 1 < t_0 + n P ≤ k_n.
std::vector<Measured::Renewal> renewals_of(const Samples& values) {
  std::vector<std::size_t> changes;
  for (std::size_t k = 1; k < values.size(); ++k) {
    if (values[k] != values[k - 1]) changes.push_back(k);
  }
  if (changes.size() < 10 || 2 * changes.size() > values.size()) return {};
  std::vector<std::size_t> gaps;
  for (std::size_t i = 1; i < changes.size(); ++i) gaps.push_back(changes[i] - changes[i - 1]);
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  const auto usual = gaps[gaps.size() / 2];
  if (changes.back() - changes.front() > 2 * usual * changes.size()) return {};  // a limit, that comes and goes
  const auto n = static_cast<double>(changes.size());
  double sum = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    sum += static_cast<double>(changes[i]);
    moment += (static_cast<double>(i) - 0.5 * (n - 1.0)) * static_cast<double>(changes[i]);
  }
  const double period = moment / (n * (n * n - 1.0) / 12.0), first = sum / n - 0.5 - 0.5 * period * (n - 1.0);
  std::vector<Measured::Renewal> renewals;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    renewals.push_back({first + period * static_cast<double>(i), changes[i]});
  }
  return renewals;
}

/// On the cubic through the four samples around `place`.
double between(const Samples& y, double place) {
  const double inside = std::clamp(place, 1.0, static_cast<double>(y.size()) - 3.0);
  const auto i = static_cast<std::size_t>(inside);
  const double r = place - static_cast<double>(i);
  return -r * (r - 1) * (r - 2) / 6 * y[i - 1] + (r + 1) * (r - 1) * (r - 2) / 2 * y[i] -
         (r + 1) * r * (r - 2) / 2 * y[i + 1] + (r + 1) * r * (r - 1) / 6 * y[i + 2];
}

/// (2); noise above what is compared would be folded by a sensor that holds or limits.
Samples foot_accelerations(const host_sim::SimulationInput& input, std::size_t count) {
  Samples result(count);
  const auto& z = input.motion;
  for (std::size_t k = 2; k + 2 < count; ++k) {
    result[k] = (16.0 * (z[k - 1].position + z[k + 1].position) - z[k - 2].position - z[k + 2].position -
                 30.0 * z[k].position) / (12.0 * input.period * input.period);
  }
  host_sim::RealTransform transform(host_sim::good_fft_size(count + 1000));  // zeros between end and beginning
  const auto bins = transform(result);
  std::vector<std::complex<double>> low(bins.begin(), bins.end());
  const auto top = static_cast<std::size_t>(90.0 * input.period * static_cast<double>(transform.length()));
  for (std::size_t k = top; k < low.size(); ++k) low[k] = 0.0;
  Samples smooth = transform.inverse(low);
  smooth.resize(count);
  return smooth;
}

/// (1)
Samples tyre_loads(const Rig& rig, const std::vector<Cause>& causes, const Measured& measured) {
  const firmware::Recording& r = measured.recording;
  Samples deflection(measured.to), load;
  for (std::size_t k = 0; k < measured.to; ++k) deflection[k] = r[Channel::z_r][k] - r[Channel::z_w][k];
  for (const auto& tyre : firmware::through_samples(deflection, 1.0 / r.sample_period)) {
    double force = rig.tyre.stiffness * tyre.position + rig.tyre.damping * tyre.velocity;
    const double weight = 9.81 * (rig.body.mass + rig.wheel.mass);
    for (const Cause& cause : causes) {
      if (cause.entry->tyre_force != nullptr) force = cause.entry->tyre_force(cause.values, force, tyre.position, weight);
    }
    load.push_back(force);
  }
  return load;
}

/// Without sensors; of a hil rig the component on its machine.
Rig simulated_part(Rig rig) {
  rig.effects.for_each_sensor([](auto& slot, Channel /*of*/) { slot = {}; });
  if (rig.kind != RigKind::hil) return rig;
  rig.kind = RigKind::component_bench;
  rig.machine.virtual_damping = 0.0;
  for (const Cause& cause : firmware::effects_of(rig)) {
    if (cause.entry->tyre_force != nullptr) firmware::remove_effect(rig, *cause.entry, std::nullopt);
  }
  return rig;
}

/// The sensor of one channel over its true values.
Samples reading(const Rig& sensors, const Measured& measured, Channel channel, const Samples& truth) {
  std::array<model::SensorPath<double>, model::channel_count> paths{};
  auto& path = paths[index(channel)] = sensors.effects.sensor_paths()[index(channel)];
  const bool held = path.hold > 0.0;
  path.hold = 0.0;
  const model::Sensors<double> chain(paths, measured.input.period);
  Samples values = truth;
  model::Sensors<double>::State state;
  model::Signals<double> signals{};
  for (std::size_t k = 0; k < truth.size() && chain.any(); ++k) {
    signals[index(channel)] = truth[k];
    k == 0 ? chain.start(state, signals, nullptr) : chain.step(state, signals, nullptr);
    values[k] = chain.reading(state, channel, truth[k]);
  }
  if (!held) return values;
  const Samples before = values;
  const auto& renewals = measured.renewals[index(channel)];
  for (std::size_t n = 0; n < renewals.size(); ++n) {
    const std::size_t end = n + 1 < renewals.size() ? renewals[n + 1].shows : values.size();
    const double value = between(before, renewals[n].taken);
    for (std::size_t k = renewals[n].shows; k < std::min(end, values.size()); ++k) values[k] = value;
  }
  return values;
}

}  // namespace

double Measured::hold_period(Channel channel) const {
  const auto& at = renewals[index(channel)];
  return at.empty() ? 0.0 : input.period * (at.back().taken - at.front().taken) / static_cast<double>(at.size() - 1);
}

Measured measured(const firmware::RigDescription& description, firmware::Recording recording, double seconds) {
  Measured m;
  const Rig rig = simulated_part(description.rig);
  m.input = host_sim::simulation_input(rig, recording);
  if (!host_sim::begins_at_rest(rig, m.input, recording)) m.from = std::lround(settling / m.input.period);
  m.to = std::min(recording.size(), m.from + static_cast<std::size_t>(std::lround(seconds / m.input.period)));
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    const auto channel = static_cast<Channel>(c);
    const bool tyre = description.rig.kind == RigKind::hil && channel == Channel::F_w;
    if (!recording.has(channel) || channel == m.input.channel) continue;
    if (!tyre && !(description.noise[c].value_or(0.0) > 0.0)) continue;
    if (!tyre && description.rig.kind != RigKind::quarter_car && channel != Channel::x_act && channel != Channel::F) continue;
    m.channels.push_back(channel);
    m.renewals[c] = renewals_of(recording[channel]);
  }
  m.recording = std::move(recording);
  return m;
}

Rig rig_of(const firmware::RigDescription& description, const Model& model) {
  Rig rig = description.rig;
  std::size_t i = 0;
  for (const auto& [path, tolerance] : description.tolerance) {
    if (double* const value = firmware::find_parameter(rig, path)) *value *= 1.0 + tolerance * model.tolerated[i];
    ++i;
  }
  for (const Cause& cause : model.causes) firmware::put_effect(rig, cause);
  return rig;
}

host_sim::Response predicted(const firmware::RigDescription& description, const Model& model, const Measured& measured) {
  const Rig rig = rig_of(description, model), part = simulated_part(rig);
  const double period = measured.input.period;
  host_sim::Response response;
  response.fill(Samples(measured.to, std::nan("")));
  if (firmware::find_rig_fault(rig, period)) return response;
  const int steps = host_sim::steps_of(part, period, host_sim::fine_steps(period));
  response = host_sim::simulate(part, measured.input, host_sim::resting(part, measured.input), measured.to, steps);
  if (rig.kind == RigKind::quarter_car) response[index(Channel::zdd_r)] = foot_accelerations(measured.input, measured.to);
  if (rig.kind == RigKind::hil) response[index(Channel::F_w)] = tyre_loads(rig, model.causes, measured);
  for (const Channel c : measured.channels) response[index(c)] = reading(rig, measured, c, response[index(c)]);
  return response;
}

}  // namespace reference
