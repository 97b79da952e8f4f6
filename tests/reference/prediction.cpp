#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "firmware/simulation/road.hpp"
#include "host_sim/comparison/fine_steps.hpp"
#include "host_sim/comparison/start_state.hpp"
#include "host_sim/signal/spectrum.hpp"
#include "model/components/sensors.hpp"
#include "tests/reference/diagnose.hpp"

namespace reference {
namespace {

using model::Channel;
using model::RigKind;
using Rig = model::RigParameters<double>;
using Samples = std::vector<double>;

/// [s] until a start from rest is forgotten: 1.4 Hz with 0.19 of critical damping falls by e⁻¹⁰.
constexpr double settling = 6.0;

/// (2). Noise above what is compared would be folded by a sensor that holds or limits.
Samples foot_accelerations(const host_sim::SimulationInput& input, std::size_t count) {
  Samples result(count);
  const auto& z = input.motion;
  for (std::size_t k = 2; k + 2 < count; ++k) {
    result[k] = (16.0 * (z[k - 1].position + z[k + 1].position) - z[k - 2].position - z[k + 2].position -
                 30.0 * z[k].position) /
                (12.0 * input.period * input.period);
  }
  host_sim::RealTransform transform(host_sim::good_fft_size(count));
  const auto bins = transform(result);
  std::vector<std::complex<double>> low(bins.size());
  const double above = band_edges.back() * input.period * static_cast<double>(transform.length());
  std::copy_n(bins.begin(), std::min(static_cast<std::size_t>(above), bins.size()), low.begin());
  Samples smooth = transform.inverse(low);
  smooth.resize(count);
  return smooth;
}

/// (1)
Samples tyre_loads(const Rig& rig, const std::vector<Cause>& causes, const Measured& m) {
  Samples deflection(m.to), load;
  for (std::size_t k = 0; k < m.to; ++k) deflection[k] = m.recording[Channel::z_r][k] - m.recording[Channel::z_w][k];
  const double weight = 9.81 * (rig.body.mass + rig.wheel.mass);
  for (const auto& tyre : firmware::through_samples(deflection, 1.0 / m.input.period)) {
    double force = rig.tyre.stiffness * tyre.position + rig.tyre.damping * tyre.velocity;
    for (const Cause& c : causes) {
      if (c.entry->tyre_force != nullptr) force = c.entry->tyre_force(c.values, force, tyre.position, weight);
    }
    load.push_back(force);
  }
  return load;
}

/// What the model simulates: no sensors; of a hil rig the component on its machine.
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

/// On the cubic through the four samples around `place`.
double between(const Samples& y, double place) {
  const double inside = std::clamp(place, 1.0, static_cast<double>(y.size()) - 3.0);
  const auto i = static_cast<std::size_t>(inside);
  const double r = place - static_cast<double>(i);
  return -r * (r - 1) * (r - 2) / 6 * y[i - 1] + (r + 1) * (r - 1) * (r - 2) / 2 * y[i] -
         (r + 1) * r * (r - 2) / 2 * y[i + 1] + (r + 1) * r * (r - 1) / 6 * y[i + 2];
}

/// The sensor of one channel over its true values.
Samples reading(const Rig& rig, const Measured& m, Channel channel, const Samples& truth) {
  std::array<model::SensorPath<double>, model::channel_count> paths{};
  auto& path = paths[index(channel)] = rig.effects.sensor_paths()[index(channel)];
  const bool held = path.hold > 0.0;
  path.hold = 0.0;
  const model::Sensors<double> sensor(paths, m.input.period);
  model::Sensors<double>::State state;
  model::Signals<double> signals{};
  Samples values = truth;
  for (std::size_t k = 0; k < truth.size() && sensor.any(); ++k) {
    signals[index(channel)] = truth[k];
    k == 0 ? sensor.start(state, signals, nullptr) : sensor.step(state, signals, nullptr);
    values[k] = sensor.reading(state, channel, truth[k]);
  }
  const auto& renewals = m.renewals[index(channel)];
  if (!held || !renewals) return values;
  const Samples before = values;
  for (std::size_t n = 0, k = renewals->at.front(); k < values.size(); ++k) {
    while (n + 1 < renewals->at.size() && renewals->at[n + 1] <= k) ++n;
    values[k] = between(before, taken_at(*renewals, n, {.own = true}));
  }
  return values;
}

}  // namespace

double Measured::hold_period(Channel channel) const {
  const auto& held = renewals[index(channel)];
  return held ? held->period * input.period : 0.0;
}

Measured measured(const Description& description, firmware::Recording recording, double seconds) {
  const Rig rig = simulated_part(description.rig);
  Measured m{std::move(recording), {}};
  m.input = host_sim::simulation_input(rig, m.recording);
  const auto samples = [&m](double time) { return static_cast<std::size_t>(std::lround(time / m.input.period)); };
  if (!host_sim::begins_at_rest(rig, m.input, m.recording)) m.from = samples(settling);
  m.to = std::min(m.recording.size(), m.from + samples(seconds));
  m.fine_steps = host_sim::fine_steps(m.input.period);
  if (m.to < m.recording.size()) m.fine_steps = (m.fine_steps + 1) / 2;
  std::vector<Channel> shown{Channel::x_act, Channel::F};
  if (description.rig.kind == RigKind::hil) shown.push_back(Channel::F_w);
  if (description.rig.kind == RigKind::quarter_car) {
    shown = {Channel::zdd_r, Channel::zdd_w, Channel::zdd_b, Channel::F_w, Channel::dz_w, Channel::dz_b};
  }
  for (const Channel channel : shown) {
    if (!m.recording.has(channel) || channel == m.input.channel) continue;
    m.channels.push_back(channel);
    m.renewals[index(channel)] = host_sim::identification::renewals_of(m.recording[channel]);
  }
  return m;
}

Rig rig_of(const Description& description, const Model& model) {
  Rig rig = description.rig;
  std::size_t i = 0;
  for (const auto& [path, tolerance] : description.tolerance) {
    if (double* const value = firmware::find_parameter(rig, path)) *value *= 1.0 + tolerance * model.tolerated[i];
    ++i;
  }
  for (const Cause& cause : model.causes) firmware::put_effect(rig, cause);
  return rig;
}

Readings predicted(const Description& description, const Model& model, const Measured& m) {
  const Rig rig = rig_of(description, model);
  std::vector<double> key = model.tolerated;
  for (const Cause& c : model.causes) {
    if (c.entry->of_channel) continue;
    key.push_back(static_cast<double>(c.entry - firmware::catalogue().data()));
    key.insert(key.end(), c.values.begin(), c.values.end());
  }
  if (m.simulated.size() > 8) m.simulated.clear();
  Readings& truth = m.simulated[key];
  if (firmware::find_rig_fault(rig, m.input.period)) {
    truth.fill(Samples(m.to, std::nan("")));
    return std::exchange(truth, {});
  }
  if (truth[index(Channel::F)].empty() && truth[index(Channel::F_w)].empty()) {
    const Rig part = simulated_part(rig);
    const int steps = host_sim::steps_of(part, m.input.period, m.fine_steps);
    truth = host_sim::simulate(part, m.input, host_sim::resting(part, m.input), m.to, steps);
    if (rig.kind == RigKind::quarter_car) truth[index(Channel::zdd_r)] = foot_accelerations(m.input, m.to);
    if (rig.kind == RigKind::hil) truth[index(Channel::F_w)] = tyre_loads(rig, model.causes, m);
  }
  Readings readings = truth;
  for (const Channel c : m.channels) readings[index(c)] = reading(rig, m, c, truth[index(c)]);
  return readings;
}

}  // namespace reference
