#include "host_sim/diagnose/virtual_car.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

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

}  // namespace

std::map<std::string, Estimate> virtual_car(const RigDescription& description, const std::vector<Evidence>& evidence) {
  std::map<std::string, Estimate> result;
  if (description.rig.kind != model::RigKind::hil) return result;
  model::RigParameters<double> rig = description.rig;
  Row given;
  Eigen::VectorXd lower(count), upper(count);
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
  if (!any) return result;

  Normal all;
  for (const Evidence& e : evidence) {
    const Recording& r = e.recording;
    const double rate = 1.0 / r.sample_period;
    if (e.fit.size() == 0 || !r.has(Channel::x_cmd) || !r.has(Channel::F)) continue;
    const auto x = velocity(r[Channel::x_cmd], rate);
    std::vector<double> tyre, tyre_rate;
    if (r.has(Channel::z_r) && r.has(Channel::z_w)) {
      for (std::size_t k = 0; k < r.size(); ++k) tyre.push_back(r[Channel::z_r][k] - r[Channel::z_w][k]);
      tyre_rate = velocity(tyre, rate);
    }
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
      if (r.has(Channel::F_w) && !tyre.empty()) {
        row.setZero();
        row(k_t) = tyre[k];
        row(b_t) = tyre_rate[k];
        load.add(row, r[Channel::F_w][k]);
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
      bounded_step(h, g, lower.cwiseQuotient(scale), upper.cwiseQuotient(scale)).cwiseProduct(scale);
  const Row values = given + d;
  const double left = values.dot(all.matrix * values) - 2.0 * values.dot(all.right) + all.square;
  const double variance = std::max(left, 0.0) / all.samples;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(upper(i) > 0.0)) continue;
    // Beside the scatter, what differences of fourth order are off.
    const double error = std::sqrt(variance / std::max(all.matrix(i, i), 1e-300)) + 3e-5 * values(i);
    result[std::string(paths[static_cast<std::size_t>(i)])] = {values(i), error};
  }
  return result;
}

}  // namespace host_sim::diagnose
