#include "host_sim/plan/open_parameters.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/plan/thresholds.hpp"

namespace host_sim::plan {

using identification::FreeParameter;

namespace {

constexpr double deviations = 1.96;  ///< of a 95 % interval

/// ln of a factor of parameter_range: as much as a prior leaves of a 95 % interval.
double prior_half_width() {
  return deviations * std::log(identification::thresholds::parameter_range) / std::sqrt(3.0);
}

/// 1/variance of the prior of each of n parameters. All together in one ratio are known as well as one alone.
double prior(Eigen::Index n) { return std::pow(deviations / prior_half_width(), 2) / static_cast<double>(n); }

double variance(Eigen::MatrixXd h, Eigen::Index i) {
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(h.rows());
  unit(i) = 1.0;
  return h.ldlt().solve(unit)(i);
}

double half_width(double variance) {
  return std::min(prior_half_width(), deviations * std::sqrt(std::max(variance, 0.0)));
}

/// Why nothing changes with a parameter of a described effect.
std::string not_reached(const Rehearsal& rehearsal, const firmware::PlacedEffect& effect) {
  const model::MotionScales& motion = rehearsal.scales().motion;
  char text[128];
  if (effect.entry->corner == model::Corner::stop || effect.entry->corner == model::Corner::free_play) {
    std::snprintf(text, sizeof text, "not reached: travel %.3g mm, needs %.3g mm", 1e3 * motion.deflection_peak,
                  1e3 * effect.values.front());
    return text;
  }
  if (effect.entry->corner == model::Corner::rate_limit) {
    std::snprintf(text, sizeof text, "not reached: velocity %.3g m/s, needs %.3g m/s", motion.velocity_peak,
                  effect.values.front());
    return text;
  }
  return "not reached by this excitation";
}

std::string words_of(const std::vector<OpenCombination::Part>& parts) {
  std::vector<std::string> up, down;
  double least = 1.0;
  for (const auto& part : parts) {
    (part.change > 0.0 ? up : down).push_back(part.path);
    least = std::min(least, std::abs(part.change));
  }
  if (parts.size() == 1) return parts.front().path;
  if (!down.empty() && !up.empty())
    return identification::joined(up) + " up, " + identification::joined(down) + " down";
  return identification::joined(up.empty() ? down : up) + (least > 0.8 ? " in one ratio" : " together");
}

}  // namespace

bool PlannedParameter::open() const { return determined_to > thresholds::open; }

Information information_of(const Rehearsal& rehearsal) {
  Information information{rehearsal.space().suspects, {}};
  for (const firmware::PlacedEffect& effect : firmware::effects_of(rehearsal.given().rig)) {
    for (FreeParameter& parameter : identification::effect_parameters(effect)) {
      information.parameters.push_back(std::move(parameter));
    }
  }
  const Eigen::MatrixXd j = rehearsal.jacobian(information.parameters);
  information.matrix = j.transpose() * j;
  return information;
}

std::vector<PlannedParameter> planned_parameters(const Rehearsal& rehearsal,
                                                 const firmware::RigDescription& description,
                                                 const Information& information) {
  const auto n = static_cast<Eigen::Index>(information.parameters.size());
  const Eigen::MatrixXd all = information.matrix + prior(n) * Eigen::MatrixXd::Identity(n, n);
  std::vector<PlannedParameter> list;
  for (Eigen::Index i = 0; i < n; ++i) {
    const FreeParameter& parameter = information.parameters[static_cast<std::size_t>(i)];
    const auto tolerated = description.tolerance.find(parameter.path);
    Eigen::MatrixXd beside = information.matrix;
    for (Eigen::Index k = 0; k < n; ++k) {
      const auto bound = description.tolerance.find(information.parameters[static_cast<std::size_t>(k)].path);
      const bool known = bound == description.tolerance.end() || !(bound->second > 0.0);
      beside(k, k) += k == i ? prior(1) : known ? 1e12 : 3.0 / (bound->second * bound->second);
    }
    PlannedParameter planned{parameter.path, parameter.value(parameter.get(rehearsal.given())),
                             half_width(variance(all, i)), half_width(variance(beside, i))};
    if (tolerated != description.tolerance.end()) planned.tolerance = tolerated->second;
    if (!(information.matrix(i, i) > 1e-6)) {
      planned.why = "this excitation does not move it";
      for (const firmware::PlacedEffect& effect : firmware::effects_of(rehearsal.given().rig)) {
        for (std::size_t p = 0; p < effect.values.size(); ++p) {
          if (firmware::effect_path(effect, p) == parameter.path) planned.why = not_reached(rehearsal, effect);
        }
      }
    }
    list.push_back(std::move(planned));
  }
  return list;
}

std::vector<OpenCombination> open_combinations(const Information& information) {
  std::vector<OpenCombination> list;
  const Eigen::Index n = information.matrix.rows();
  if (n == 0) return list;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information.matrix);
  const double least = std::pow(deviations / thresholds::open, 2);
  Eigen::Index open = 0;
  while (open < n && solver.eigenvalues()(open) < least) ++open;
  // Reduced echelon form of the eigenvectors, largest entries as pivots: few parameters in each.
  Eigen::MatrixXd basis = solver.eigenvectors().leftCols(open).transpose();
  for (Eigen::Index row = 0; row < open; ++row) {
    Eigen::Index pivot = 0;
    Eigen::Index from = 0;
    basis.bottomRows(open - row).cwiseAbs().maxCoeff(&from, &pivot);
    basis.row(row).swap(basis.row(row + from));
    basis.row(row) /= basis(row, pivot);
    for (Eigen::Index other = 0; other < open; ++other) {
      if (other == row) continue;
      const double factor = basis(other, pivot);
      basis.row(other) -= factor * basis.row(row);
    }
  }
  for (Eigen::Index row = 0; row < open; ++row) {
    const double largest = basis.row(row).cwiseAbs().maxCoeff();
    OpenCombination combination;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double change = basis(row, i) / largest;
      if (std::abs(change) < thresholds::part_of_combination) continue;
      combination.parts.push_back({information.parameters[static_cast<std::size_t>(i)].path, change});
    }
    combination.combination = words_of(combination.parts);
    list.push_back(std::move(combination));
  }
  return list;
}

double known_to(const Information& information, const OpenCombination& combination) {
  const auto n = static_cast<Eigen::Index>(information.parameters.size());
  Eigen::VectorXd v = Eigen::VectorXd::Zero(n);
  for (const OpenCombination::Part& part : combination.parts) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (information.parameters[static_cast<std::size_t>(i)].path == part.path) v(i) = part.change;
    }
  }
  if (v.isZero()) return 0.0;
  v.normalize();
  const Eigen::MatrixXd h = information.matrix + prior(n) * Eigen::MatrixXd::Identity(n, n);
  return half_width(v.dot(h.ldlt().solve(v)));
}

}  // namespace host_sim::plan
