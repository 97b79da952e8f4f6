#include "host_sim/diagnose/virtual_car.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <optional>

#include "host_sim/diagnose/fit.hpp"

namespace host_sim::diagnose {
namespace {

using model::Channel;
constexpr std::array<std::string_view, 5> paths{"body.mass", "wheel.mass", "tyre.stiffness", "tyre.damping",
                                                "machine.virtual_damping"};
enum : Eigen::Index { m_b, m_w, k_t, b_t, b_v, count };
using Row = Eigen::Matrix<double, count, 1>;

std::vector<double> velocity(const std::vector<double>& positions, double rate) {
  std::vector<double> result;
  for (const auto& m : through_samples(positions, rate)) result.push_back(m.velocity);
  return result;
}

/// Σ rows rowsᵀ and Σ rows rhs of one equation, over Σ rhs².
struct Normal {
  Eigen::Matrix<double, count, count> matrix = Eigen::Matrix<double, count, count>::Zero();
  Row right = Row::Zero();
  double square = 0.0;
  double samples = 0.0;

  void add(const Row& row, double rhs) {
    matrix.noalias() += row * row.transpose();
    right += row * rhs;
    square += rhs * rhs;
    samples += 1.0;
  }
  void add_to(Normal& all) const {
    if (!(square > 0.0)) return;
    const double weight = samples / square;
    all.matrix += weight * matrix;
    all.right += weight * right;
    all.square += weight * square;
    all.samples += samples;
  }
};

/// The deflection of the virtual tyre and its rate.
struct TyreMotion {
  std::vector<double> deflection, rate;
};
TyreMotion tyre_motion(const Recording& r) {
  TyreMotion motion;
  if (!r.has(Channel::z_r) || !r.has(Channel::z_w)) return motion;
  for (std::size_t k = 0; k < r.size(); ++k) motion.deflection.push_back(r[Channel::z_r][k] - r[Channel::z_w][k]);
  motion.rate = velocity(motion.deflection, 1.0 / r.sample_period);
  return motion;
}

/// Whether two loads are one, as written: the lower of them is negative.
bool is_as_low_as(double load, double lowest) { return load <= lowest * (1.0 - 1e-8); }

/// The load at which the wheel flies: the lowest F_w, where it is repeated and near the weight of the car.
std::optional<double> lifted_load(const RigDescription& description, const std::vector<Evidence>& evidence) {
  const double weight = (description.rig.body.mass + description.rig.wheel.mass) * 9.81;
  double lowest = INFINITY;
  for (const Evidence& e : evidence) {
    if (!e.recording.has(Channel::F_w)) continue;
    for (const double f : e.recording[Channel::F_w]) lowest = std::min(lowest, f);
  }
  std::size_t count = 0;
  for (const Evidence& e : evidence) {
    if (!e.recording.has(Channel::F_w)) continue;
    for (const double f : e.recording[Channel::F_w]) count += is_as_low_as(f, lowest) ? 1 : 0;
  }
  constexpr std::size_t enough = 4;
  return count >= enough && std::abs(lowest + weight) < 0.05 * weight ? std::optional(lowest) : std::nullopt;
}

/// The tyre law as far as it is not linear.
struct TyreLaw {
  double cubic = 0.0;            ///< k₃ [N/m³]
  std::optional<double> lifted;  ///< F_w of a flying wheel [N]

  [[nodiscard]] bool flies(double load) const { return lifted && is_as_low_as(load, *lifted); }
};

std::vector<TyreEffect> tyre_effects(const RigDescription& description, const std::vector<Evidence>& evidence,
                                     const Row& lower, const Row& upper, const Row& given, TyreLaw& law) {
  std::vector<TyreEffect> effects;
  law.lifted = lifted_load(description, evidence);
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double loads = 0.0, error = 0.0, cut = 0.0, samples = 0.0;
  const double k = given(k_t), b = given(b_t);
  for (const Evidence& e : evidence) {
    const Recording& r = e.recording;
    if (!r.has(Channel::F_w)) continue;
    const TyreMotion tyre = tyre_motion(r);
    for (std::size_t i = 2; i + 2 < tyre.deflection.size(); ++i) {
      const double dz = tyre.deflection[i], rate = tyre.rate[i], load = r[Channel::F_w][i];
      const double left = load - k * dz - b * rate;
      loads += load * load;
      error += left * left;
      if (law.flies(load)) {
        cut += left * left;
        continue;
      }
      const Eigen::Vector3d row(dz, rate, dz * dz * dz);
      h += row * row.transpose();
      g -= row * left;
      samples += 1.0;
    }
  }
  if (!(samples > 0.0) || !(loads > 0.0)) return effects;
  const auto add = [&effects](std::string_view name, double error_before, double error_after) -> TyreEffect& {
    TyreEffect& added = effects.emplace_back();
    added.effect.entry = find_effect(name);
    added.before = error_before;
    added.after = error_after;
    return added;
  };
  if (law.lifted) add("tyre_lift_off", std::sqrt(error / loads), std::sqrt((error - cut) / loads));
  const Eigen::Vector3d scale = h.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Matrix3d scaled = scale.asDiagonal() * h * scale.asDiagonal();
  const Eigen::Vector3d right = scale.asDiagonal() * g;
  const double far = 1e3 * right.cwiseAbs().maxCoeff() + 1.0;
  const auto left_with = [&](double most_cubic, Eigen::Vector3d& d) {
    const Eigen::Vector3d low(lower(k_t) / scale(0), lower(b_t) / scale(1), -most_cubic);
    const Eigen::Vector3d high(upper(k_t) / scale(0), upper(b_t) / scale(1), most_cubic);
    d = bounded_step(scaled, right, {low, high});
    return error - cut + 2.0 * right.dot(d) + d.dot(scaled * d);
  };
  Eigen::Vector3d linear, cubic;
  const double without = left_with(0.0, linear), with = std::max(left_with(far, cubic), 0.0);
  const double moves = std::sqrt(scaled(2, 2)) * std::abs(cubic(2));
  if (with < 0.5 * without && moves > 1e-3 * std::sqrt(loads)) {
    law.cubic = cubic(2) * scale(2);
    // Neighbouring samples are off alike: as if one in ten counted.
    const double variance = 10.0 * with / samples;
    const double deviation = std::sqrt(variance * scaled.inverse()(2, 2)) * scale(2);
    TyreEffect& tyre = add("progressive_tyre", std::sqrt(std::max(without, 0.0) / loads), std::sqrt(with / loads));
    tyre.effect.values.push_back(law.cubic);
    tyre.parameters.push_back({law.cubic, deviation + 1e-4 * std::abs(law.cubic)});
  }
  return effects;
}

}  // namespace

VirtualCar virtual_car(const RigDescription& description, const std::vector<Evidence>& evidence) {
  VirtualCar result;
  if (description.rig.kind != model::RigKind::hil) return result;
  model::RigParameters<double> rig = description.rig;
  Row given;
  Row lower, upper;
  bool any = false;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::string path(paths[static_cast<std::size_t>(i)]);
    given(i) = *find_parameter(rig, path);
    const auto tolerance = description.tolerance.find(path);
    const double bound = tolerance == description.tolerance.end() ? 0.0 : tolerance->second * std::abs(given(i));
    lower(i) = -bound;
    upper(i) = bound;
    any = any || bound > 0.0;
  }
  TyreLaw law;
  result.effects = tyre_effects(description, evidence, lower, upper, given, law);
  if (!any) return result;

  Normal all;
  for (const Evidence& e : evidence) {
    const Recording& r = e.recording;
    const double rate = 1.0 / r.sample_period;
    if (e.fit.size() == 0 || !r.has(Channel::x_cmd) || !r.has(Channel::F)) continue;
    const auto x = velocity(r[Channel::x_cmd], rate);
    const auto [tyre, tyre_rate] = tyre_motion(r);
    Normal body, wheel, load;
    for (std::size_t k = e.fit.from + 2; k + 2 < e.fit.to; ++k) {
      const double force = r[Channel::F][k];
      Row row = Row::Zero();
      if (r.has(Channel::zdd_b)) {
        row(m_b) = r[Channel::zdd_b][k];
        row(b_v) = -x[k];
        body.add(row, force);
      }
      if (r.has(Channel::zdd_w) && r.has(Channel::F_w)) {
        row.setZero();
        row(m_w) = r[Channel::zdd_w][k];
        row(b_v) = x[k];
        wheel.add(row, r[Channel::F_w][k] - force);
      }
      if (r.has(Channel::F_w) && !tyre.empty() && !law.flies(r[Channel::F_w][k])) {
        row.setZero();
        row(k_t) = tyre[k];
        row(b_t) = tyre_rate[k];
        load.add(row, r[Channel::F_w][k] - law.cubic * tyre[k] * tyre[k] * tyre[k]);
      }
    }
    body.add_to(all);
    wheel.add_to(all);
    load.add_to(all);
  }
  if (!(all.samples > 0.0)) return result;
  // In deviations from the given values, each in units of the value, so that all are of one size.
  const Row scale = given.cwiseAbs().cwiseMax(1e-9);
  const Eigen::MatrixXd h = scale.asDiagonal() * all.matrix * scale.asDiagonal();
  const Eigen::VectorXd g = scale.asDiagonal() * (all.matrix * given - all.right);
  const Eigen::VectorXd d =
      bounded_step(h, g, {lower.cwiseQuotient(scale), upper.cwiseQuotient(scale)}).cwiseProduct(scale);
  const Row values = given + d;
  const double left = values.dot(all.matrix * values) - 2.0 * values.dot(all.right) + all.square;
  const double variance = std::max(left, 0.0) / all.samples;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(upper(i) > 0.0)) continue;
    // Beside the scatter, what differences of fourth order are off.
    const double error = std::sqrt(variance / std::max(all.matrix(i, i), 1e-300)) + 3e-5 * values(i);
    result.parameters[std::string(paths[static_cast<std::size_t>(i)])] = {values(i), error};
  }
  return result;
}

}  // namespace host_sim::diagnose
