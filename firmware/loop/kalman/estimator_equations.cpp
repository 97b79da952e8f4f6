#include "firmware/loop/kalman/estimator_equations.hpp"

#include <cmath>

#include "model/numerics/require.hpp"

namespace firmware {
namespace {

using model::Channel;
using model::CoreIndex;

bool has_row(Channel channel) {
  switch (channel) {
    case Channel::x_cmd:
    case Channel::x_act:
    case Channel::F:
    case Channel::F_act:
    case Channel::z_cmd:
      return false;
    default:
      return true;
  }
}

double mass_beyond(const model::RigParameters<double>& rig) {
  model::WheelLoadSensor<double> sensor{};
  rig.effects.act_on(sensor);
  return sensor.mass_beyond;
}

bool within(double value, double lowest, double highest) { return value >= lowest && value <= highest; }

}  // namespace

std::string_view EstimatorState::name() const {
  constexpr std::array<std::string_view, model::core_states> core{"z_w",
                                                                  "velocity of the wheel",
                                                                  "z_b",
                                                                  "velocity of the body",
                                                                  "piston travel",
                                                                  "velocity of the piston",
                                                                  "relaxed deflection",
                                                                  "deflection behind the top mount"};
  constexpr std::array<std::string_view, 5> road{"z_r (road)", "contact patch", "velocity of the contact patch",
                                                 "z_r (foot point)", "velocity of the foot point"};
  constexpr std::array<std::string_view, model::channel_count> bias{
      "bias of z_r",   "bias of z_w",  "bias of z_b",   "bias of zdd_r", "bias of zdd_w",
      "bias of zdd_b", "bias of dz_w", "bias of dz_b",  "bias of F_w",   "bias of x_cmd",
      "bias of x_act", "bias of F",    "bias of F_act", "bias of z_cmd"};
  switch (kind) {
    case Kind::core:
      return core[static_cast<std::size_t>(entry)];
    case Kind::road:
      return road[static_cast<std::size_t>(entry)];
    case Kind::bias:
      return bias[static_cast<std::size_t>(entry)];
  }
  return {};
}

std::string_view EstimatorEquations::check(const KalmanSettings& settings, const model::RigParameters<double>& rig) {
  if (rig.kind != model::RigKind::quarter_car) {
    return "estimator.kind: expected \"observer\" unless the rig is a quarter_car (a hil rig computes its car)";
  }
  std::size_t used = 0, biases = 0;
  const auto paths = rig.effects.sensor_paths();
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    const Channel channel = model::channel_at(i);
    if (!(settings.noise[i] >= 0.0 && settings.noise[i] < 1e9)) return "noise: expected an rms of at least 0";
    if (!within(settings.age[i], 0.0, 0.5)) return "estimator.age: expected 0 to 0.5 s";
    if (settings.noise[i] == 0.0) {
      if (settings.bias[i]) return "estimator.bias: expected channels that the filter uses";
      continue;
    }
    if (!has_row(channel)) return "estimator.sensors: expected displacements, accelerations and F_w";
    if (channel == Channel::zdd_r && settings.bandwidth == 0.0) {
      return "estimator.sensors: zdd_r is white noise on a road without bandwidth, expected estimator.bandwidth > 0";
    }
    if (channel == Channel::F_w && settings.bandwidth == 0.0 && mass_beyond(rig) > 0.0) {
      return "estimator.sensors: F_w carries a mass (force_sensor_inertia), which needs estimator.bandwidth > 0";
    }
    const auto& path = paths[i];
    if (path.lag > 0.0 || path.limit > 0.0 || path.hold > 0.0) {
      return "estimator.sensors: expected channels without lag, limit and hold in the rig description";
    }
    ++used;
    if (settings.bias[i]) ++biases;
  }
  if (used == 0) return "estimator.sensors: expected at least one channel with a noise above 0 in [noise]";
  if (used > estimator_channels) return "estimator.sensors: expected at most 8 channels";
  if (biases > bias_capacity) return "estimator.bias: expected at most 3 channels";
  if (!within(settings.bias_drift, 1e-6, 1e3)) return "estimator.bias_drift: expected 1e-6 to 1000";
  if (!within(settings.roughness, 1e-9, 1.0)) return "estimator.roughness: expected 1e-9 to 1 m³";
  if (!within(settings.speed, 0.1, 150.0)) return "estimator.speed: expected 0.1 to 150 m/s";
  if (!within(settings.cut_off, 0.0, 10.0)) return "estimator.cut_off: expected 0 to 10 Hz";
  if (!(settings.bandwidth == 0.0 || within(settings.bandwidth, 0.1, 2e4))) {
    return "estimator.bandwidth: expected 0 or 0.1 to 20000 Hz";
  }
  if (settings.history < 0 || settings.history > longest_history) return "estimator.history: expected 0 to 8 periods";
  if (!within(settings.false_alarms, 1e-9, 1e3)) return "estimator.false_alarms: expected 1e-9 to 1000 an hour";
  return {};
}

EstimatorEquations::EstimatorEquations(const KalmanSettings& settings, const model::RigParameters<double>& rig)
    : settings_(settings),
      rig_(rig),
      equations_(rig),
      road_gain_(2.0 * 3.141592653589793 * Road::reference_wave_number *
                 std::sqrt(settings.roughness * settings.speed)),
      road_corner_(2.0 * 3.141592653589793 * settings.cut_off),
      sensor_mass_(mass_beyond(rig)),
      paths_(rig.effects.sensor_paths()) {
  model::require(check(settings, rig).empty(), "settings of a Kalman filter that fit");
  const auto add = [this](EstimatorState::Kind kind, int entry) {
    list_[static_cast<std::size_t>(states_)] = {kind, entry};
    return states_++;
  };
  for (int i = 0; i < model::core_states; ++i) {
    const bool piston = i == CoreIndex::piston_travel || i == CoreIndex::piston_velocity;
    const bool there = i < model::car_states || (piston && rig.has_fdva) ||
                       (i == CoreIndex::relaxed_deflection && equations_.has_relaxation()) ||
                       (i == CoreIndex::inner_deflection && equations_.has_mount());
    core_[static_cast<std::size_t>(i)] = there ? add(EstimatorState::Kind::core, i) : -1;
  }
  road_begin_ = states_;
  if (settings.bandwidth > 0.0) {
    filter_.emplace(Road::Parameters{settings.roughness, settings.speed, settings.cut_off, settings.bandwidth}, 1e-3);
  }
  for (int i = 0; i < (filter_ ? Road::states : 1); ++i) add(EstimatorState::Kind::road, i);
  bias_begin_ = states_;
  for (std::size_t i = 0; i < model::channel_count; ++i) {
    if (settings.noise[i] > 0.0) channel_[static_cast<std::size_t>(channels_++)] = model::channel_at(i);
    if (settings.bias[i]) add(EstimatorState::Kind::bias, static_cast<int>(i));
  }
}

int EstimatorEquations::foot_point() const { return filter_ ? road_begin_ + Road::foot_point : road_begin_; }

EstimatorEquations::Equations::JoinedState EstimatorEquations::core_state(const EstimatorVector& x) const {
  Equations::JoinedState state = Equations::JoinedState::Zero();
  for (int i = 0; i < model::core_states; ++i) {
    if (core(i) >= 0) state(i) = x(core(i));
  }
  return state;
}

model::Motion<double> EstimatorEquations::foot_point_motion(const EstimatorVector& x) const {
  if (!filter_) return {x(road_begin_), -road_corner_ * x(road_begin_), 0.0};
  Road::State road;
  for (int i = 0; i < Road::states; ++i) road(i) = x(road_begin_ + i);
  return filter_->motion(road);
}

EstimatorVector EstimatorEquations::rates(const EstimatorVector& x, int open, double noise, double actuator,
                                          double losses) const {
  EstimatorVector rate = EstimatorVector::Zero();
  model::Motion<double> foot = foot_point_motion(x);
  if (filter_) {
    Road::State road;
    for (int i = 0; i < Road::states; ++i) road(i) = x(road_begin_ + i);
    const Road::State moves = filter_->rates(road, noise);
    for (int i = 0; i < Road::states; ++i) rate(road_begin_ + i) = moves(i);
  } else {
    foot.velocity += road_gain_ * noise;
    rate(road_begin_) = foot.velocity;
  }
  Equations::JoinedInput in;
  in.z_r = foot.position;
  in.v_r = foot.velocity;
  in.actuator_force = actuator;
  in.minor_losses = losses;
  const Equations::JoinedState moves = equations_.joined(core_state(x), in, open);
  for (int i = 0; i < model::core_states; ++i) {
    if (core(i) >= 0) rate(core(i)) = moves(i);
  }
  return rate;
}

EstimatorMatrix EstimatorEquations::matrix(int open) const {
  EstimatorMatrix a = EstimatorMatrix::Zero();
  for (int j = 0; j < states_; ++j) a.col(j) = rates(EstimatorVector::Unit(j), open);
  return a;
}

EstimatorVector EstimatorEquations::noise_column() const { return rates(EstimatorVector::Zero(), 1, 1.0); }

double EstimatorEquations::linear_loss(double piston_rms, int open) const {
  if (open == 0 || !rig_.has_fdva) return 0.0;
  constexpr double gaussian = 1.5957691216057308;  // E u²|u| / E u² = 2 √(2/π) σ
  const double area = rig_.fdva.piston_area;
  return model::Fdva<double>::piston_deceleration_per_loss(rig_.fdva, equations_.duct()) * area * area / open *
         gaussian * piston_rms;
}

double EstimatorEquations::output(Channel channel, const EstimatorVector& x, int open, bool as_measured) const {
  const double z_w = x(core(CoreIndex::wheel_position)), z_b = x(core(CoreIndex::body_position));
  const model::Motion<double> foot = foot_point_motion(x);
  switch (channel) {
    case Channel::z_r:
      return foot.position;
    case Channel::z_w:
      return z_w;
    case Channel::z_b:
      return z_b;
    case Channel::zdd_r:
      return foot.acceleration;
    case Channel::zdd_w:
      return rates(x, open)(core(CoreIndex::wheel_velocity));
    case Channel::zdd_b:
      return rates(x, open)(core(CoreIndex::body_velocity));
    case Channel::dz_w:
      return foot.position - z_w;
    case Channel::dz_b:
      return z_w - z_b;
    case Channel::F_w:
      return equations_.tyre_force(core_state(x).head<model::car_states>(), foot.position, foot.velocity) +
             (as_measured ? sensor_mass_ * foot.acceleration : 0.0);
    default:
      return 0.0;
  }
}

double EstimatorEquations::feedthrough(Channel channel) const {
  const EstimatorVector pushed = rates(EstimatorVector::Zero(), 0, 0.0, 1.0);
  if (channel == Channel::zdd_w) return pushed(core(CoreIndex::wheel_velocity));
  return channel == Channel::zdd_b ? pushed(core(CoreIndex::body_velocity)) : 0.0;
}

EstimatorVector EstimatorEquations::row(Channel channel, int open, bool as_measured) const {
  EstimatorVector row = EstimatorVector::Zero();
  for (int j = 0; j < states_; ++j) row(j) = output(channel, EstimatorVector::Unit(j), open, as_measured);
  if (!as_measured) return row;
  for (int j = bias_begin_; j < states_; ++j) {
    if (state(j).entry == static_cast<int>(model::index(channel))) row(j) = 1.0;
  }
  return row;
}

}  // namespace firmware
