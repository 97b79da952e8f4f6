#include "firmware/description/filtered_rig.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "firmware/description/text/input_error.hpp"
#include "firmware/loop/kalman/estimator_equations.hpp"
#include "firmware/loop/kalman/steady_gains.hpp"
#include "model/laws/curve.hpp"
#include "model/laws/surface.hpp"
#include "model/rig/lever_at_rest.hpp"

namespace firmware {
namespace {

using Rig = model::RigParameters<double>;
using model::CoreIndex;
using model::LawPlace;

/// Gauss and Hermite's nodes and weights for a normal variable, exact for polynomials of degree 13 (Abramowitz and
/// Stegun, table 25.10). Half as many: a digressive damper of 33 points is 2 % off; twice: 0.3 %.
constexpr std::array<double, 7> nodes{-3.7504397177257425, -2.3667594107345413, -1.1544053947399682, 0.0,
                                      1.1544053947399682,  2.3667594107345413,  3.7504397177257425};
constexpr std::array<double, 7> weights{5.48268855972e-4, 3.07571239675e-2, 2.40123178605e-1, 4.57142857143e-1,
                                        2.40123178605e-1, 3.07571239675e-2, 5.48268855972e-4};
/// Each with the motion that the last slopes make. One: slopes of the rig without laws; three change them by 1 %.
constexpr int rounds_of_slopes = 3;
/// Of the first round: what a law is at rest [m], [m/s].
constexpr double first_motion = 1e-4;

/// rms of a place's deflection [m] and its rate [m/s].
struct Motion {
  double deflection = first_motion, velocity = first_motion;
};
using Motions = std::array<Motion, model::force_places>;

struct Slopes {
  double stiffness{}, damping{};
};

/// (1) of force(x, v).
template <class Force>
Slopes slopes_of(const Force& force, const Motion& rms) {
  double by_deflection = 0.0, by_velocity = 0.0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const double weighed = weights[i] * weights[j] * force(nodes[i] * rms.deflection, nodes[j] * rms.velocity);
      by_deflection += nodes[i] * weighed;
      by_velocity += nodes[j] * weighed;
    }
  }
  return {by_deflection / rms.deflection, by_velocity / rms.velocity};
}

void add(Rig& rig, LawPlace place, Slopes slopes) {
  const auto guide = [&](auto& slot) {
    slot.effect.damping = (slot.active ? slot.effect.damping : 0.0) + slopes.damping;
    slot.active = true;
  };
  switch (place) {
    case LawPlace::suspension:
      rig.suspension.stiffness += slopes.stiffness;
      rig.suspension.damping += slopes.damping;
      return;
    case LawPlace::tyre:
      rig.tyre.stiffness += slopes.stiffness;
      rig.tyre.damping += slopes.damping;
      return;
    case LawPlace::body_guide:
      return guide(rig.effects.get<model::BodyGuideDamping>());
    case LawPlace::wheel_guide:
      return guide(rig.effects.get<model::WheelGuideDamping>());
    case LawPlace::piston:
    case LawPlace::sensor:
      return;
  }
}

/// Laws as slopes; the first Maxwell branch as the effect relaxation.
void add_laws(const Rig& rig, const Motions& motions, Rig& linear) {
  const auto& laws = rig.laws;
  for (std::size_t i = 0; i < laws.curve_count; ++i) {
    const auto& table = laws.curves[i];
    const model::Curve<double> curve(table.at, table.value, table.count);
    if (table.place == LawPlace::sensor) {
      auto& gain = linear.effects.get<model::SensorGain>(table.channel);
      gain.effect.gain = (gain.active ? gain.effect.gain : 1.0) * curve.slope(0.0);
      gain.active = true;
      continue;
    }
    const bool velocity = table.over == model::LawOver::velocity;
    Slopes slopes =
        slopes_of([&](double x, double v) { return curve(velocity ? v : x); }, motions[model::index(table.place)]);
    if (table.behind > 0.0) {  // s in series: s k/(s + k); c in series: the Maxwell branch of k and c/k
      auto& branch = linear.effects.get<model::Relaxation>();
      if (velocity && table.place == LawPlace::suspension && !branch.active && slopes.damping > 0.0) {
        branch = {true, {table.behind, slopes.damping / table.behind}};
        continue;
      }
      slopes.stiffness *= table.behind / (table.behind + std::max(slopes.stiffness, 0.0));
    }
    add(linear, table.place, slopes);
  }
  for (std::size_t i = 0; i < laws.surface_count; ++i) {
    const model::Surface<double> surface(laws.surfaces[i]);
    add(linear, laws.surfaces[i].place,
        slopes_of([&](double x, double v) { return surface(x, v); }, motions[model::index(laws.surfaces[i].place)]));
  }
  auto& relaxation = linear.effects.get<model::Relaxation>();
  for (std::size_t i = 0; i < laws.branch_count; ++i) {
    const auto& branch = laws.branches[i];
    if (branch.time_constant > 0.0 && branch.place == LawPlace::suspension && !relaxation.active) {
      relaxation = {true, {branch.stiffness, branch.time_constant}};
    }
  }
  linear.laws = {};
  linear.suspension.stiffness = std::max(0.0, linear.suspension.stiffness);
  linear.suspension.damping = std::max(0.0, linear.suspension.damping);
  linear.tyre.stiffness = std::max(0.01 * rig.tyre.stiffness, linear.tyre.stiffness);
  linear.tyre.damping = std::max(0.0, linear.tyre.damping);
}

/// (2)
void add_air_spring(const Rig& rig, Rig& linear) {
  if (!rig.air_spring.fitted) return;
  using Air = model::AirSpring<double>;
  const double exponent = model::condition_of_air_spring(rig).polytropic_exponent;
  auto& relaxation = linear.effects.get<model::Relaxation>();
  linear.suspension.stiffness += Air::stiffness(rig.air_spring, relaxation.active ? exponent : 1.0);
  if (!relaxation.active) {
    relaxation = {true, {Air::heat_stiffness(rig.air_spring, exponent), rig.air_spring.heat_time}};
  }
  linear.air_spring = {};
  linear.effects.for_each([](auto& slot) {  // they are in its stiffness, and need a spring that is gone
    if (slot.effect.card.needs_air_spring) slot.active = false;
  });
}

/// (3)
void add_lever(const Rig& rig, Rig& linear) {
  const model::LeverAtRest lever = model::lever_at_rest(rig);
  linear.lever = {};
  const double square = lever.ratio * lever.ratio;
  linear.suspension.stiffness = std::max(0.0, square * linear.suspension.stiffness + lever.stiffness);
  linear.suspension.damping *= square;
  linear.fdva.coupling_stiffness *= square;
  linear.fdva.piston_area *= lever.ratio;
  linear.effects.get<model::Relaxation>().effect.stiffness *= square;
  linear.effects.get<model::TopMount>().effect.stiffness *= square;
  linear.effects.get<model::ViscousDamping>().effect.damping *= square;
}

Rig linear_for(const Rig& rig, const Motions& motions) {
  Rig linear = rig;
  add_air_spring(rig, linear);
  add_laws(rig, motions, linear);
  add_lever(rig, linear);
  return linear;
}

/// rms motion of each place of laws over the road of the filter. (find_fault: no law of the suspension behind a lever.)
Motions motions_of(const Rig& linear, const KalmanSettings& settings, double period) {
  const EstimatorEquations equations(settings, linear);
  const auto gains = std::make_unique<SteadyGains>(equations, period);
  gains->compute(linear.has_fdva ? linear.fdva.open_ducts : 0);
  const EstimatorMatrix& covariance = gains->stationary();
  const auto rms = [&](const EstimatorVector& row) {
    double square = 0.0;
    for (int j = 0; j < equations.states(); ++j) {
      for (int i = 0; i < equations.states(); ++i) square += row(i) * covariance(i, j) * row(j);
    }
    return square > first_motion * first_motion && square < 1e2 ? std::sqrt(square) : first_motion;
  };
  const auto unit = [&](int entry) { return EstimatorVector(EstimatorVector::Unit(equations.core(entry))); };
  EstimatorVector foot_velocity = EstimatorVector::Zero();
  for (int j = 0; j < equations.states(); ++j) {
    foot_velocity(j) = equations.foot_point_velocity(EstimatorVector::Unit(j));
  }
  const EstimatorVector wheel = unit(CoreIndex::wheel_position), wheel_rate = unit(CoreIndex::wheel_velocity);
  const EstimatorVector body = unit(CoreIndex::body_position), body_rate = unit(CoreIndex::body_velocity);
  Motions motions{};
  motions[model::index(LawPlace::suspension)] = {rms(wheel - body), rms(wheel_rate - body_rate)};
  motions[model::index(LawPlace::tyre)] = {rms(EstimatorVector::Unit(equations.foot_point()) - wheel),
                                           rms(foot_velocity - wheel_rate)};
  motions[model::index(LawPlace::body_guide)] = {rms(body), rms(body_rate)};
  motions[model::index(LawPlace::wheel_guide)] = {rms(wheel), rms(wheel_rate)};
  return motions;
}

}  // namespace

model::RigParameters<double> filtered_rig(const RigDescription& description, const KalmanSettings& settings) {
  const Rig& rig = description.rig;
  if (rig.air_spring.fitted && rig.air_spring.skyhook > 0.0) {
    throw InputError(description.source, description.line_of("estimator"),
                     "the Kalman filter does not know the force of an air spring's skyhook",
                     "estimator.kind = \"observer\", or no air_spring.skyhook");
  }
  Rig linear = linear_for(rig, {});
  for (int round = 0; round < rounds_of_slopes && rig.laws.any(); ++round) {
    linear = linear_for(rig, motions_of(linear, settings, description.period()));
  }
  return linear;
}

}  // namespace firmware
