#include "host_sim/identification/learn/stack_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/identification/learn/thresholds.hpp"
#include "host_sim/identification/select/select_model.hpp"
#include "host_sim/least_squares/gram.hpp"

namespace host_sim::identification {
namespace {

/// The stack with the branches at these places of its grid alone.
PlacedLaw with_branches(const PlacedLaw& law, const std::vector<std::size_t>& kept) {
  PlacedLaw out = law;
  out.at.clear();
  out.values.clear();
  for (const std::size_t i : kept) {
    out.at.push_back(law.at[i]);
    out.values.push_back(law.values[i]);
  }
  return out;
}

/// Places of the grid that are worth their price, by (3).
std::vector<std::size_t> worth_keeping(const Fit& fit, double price) {
  const std::size_t law = fit.hypothesis.laws.size() - 1;
  const auto is_branch = [&](const FreeParameter& p) {
    return p.role == FreeParameter::Role::law && p.law == law && p.number < fit.hypothesis.laws[law].values.size();
  };
  std::vector<Eigen::Index> columns;  // of J: all that is free, but for branches without a force
  std::vector<std::size_t> branches;  // of the stack, in the order of the last columns
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FreeParameter& p = fit.parameters[i];
    if (!is_branch(p)) columns.push_back(static_cast<Eigen::Index>(i));
  }
  const auto others = static_cast<Eigen::Index>(columns.size());
  Eigen::VectorXd force(static_cast<Eigen::Index>(fit.parameters.size()));
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FreeParameter& p = fit.parameters[i];
    if (!is_branch(p) || !(p.get(fit.hypothesis) > 0.0)) continue;
    force(static_cast<Eigen::Index>(branches.size())) = p.get(fit.hypothesis);
    branches.push_back(p.number);
    columns.push_back(static_cast<Eigen::Index>(i));
  }
  Eigen::MatrixXd h = gram(fit.jacobian)(columns, columns);
  h.diagonal() *= 1.0 + 1e-10;
  h.diagonal().array() += 1e-30;
  Eigen::MatrixXd inverse = h.ldlt().solve(Eigen::MatrixXd::Identity(h.rows(), h.cols()));
  Eigen::MatrixXd covariance = inverse.bottomRightCorner(h.rows() - others, h.cols() - others);
  while (!branches.empty()) {
    Eigen::Index least = 0;
    double rise = INFINITY;
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
      const double each = force(i) * force(i) / covariance(i, i);
      if (each < rise) rise = each, least = i;
    }
    if (!(rise < price)) break;
    // The others take over what it did, and their covariance is that of a model without it.
    const Eigen::VectorXd column = covariance.col(least) / covariance(least, least);
    const Eigen::VectorXd moved = force.head(covariance.rows()) - column * force(least);
    const Eigen::MatrixXd reduced = covariance - column * covariance.row(least);
    std::vector<Eigen::Index> rest;
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
      if (i != least) rest.push_back(i);
    }
    force.head(static_cast<Eigen::Index>(rest.size())) = Eigen::VectorXd(moved(rest));
    covariance = Eigen::MatrixXd(reduced(rest, rest));
    branches.erase(branches.begin() + static_cast<std::ptrdiff_t>(least));
  }
  return branches;
}

}  // namespace

PlacedLaw empty_stack(LawFamily family, const ExcitedRange& deflection, std::size_t slot, double gap) {
  PlacedLaw law{CurvePlace::suspension, CurveOver::deflection, family, deflection.rms, deflection.largest()};
  law.slot = slot;
  law.gap = gap;
  const std::size_t room = model::usual_laws.branches - slot;
  const double half = 0.5 * (deflection.highest - deflection.lowest - gap);
  for (std::size_t i = 0; i < room; ++i) {
    const auto n = static_cast<double>(i);
    law.at.push_back(family == LawFamily::sliders ? half * std::exp2(-1.0 - n)
                                                  : thresholds::shortest_time * std::pow(3.0, n));
  }
  law.values.assign(law.at.size(), 0.0);
  return law;
}

std::optional<CandidateModel> fit_stack(const IdentificationProblem& problem, const SearchSpace& space,
                                        const Hypothesis& start, const std::vector<firmware::PlacedEffect>& effects,
                                        const SelectionCriterion& criterion) {
  CandidateModel model = fitted_with_laws(problem, space, start, effects, thresholds::stack_steps);
  for (int round = 0; round < thresholds::stack_rounds; ++round) {
    if (!std::isfinite(model.fit.chi_squared)) return std::nullopt;
    const double price = 2.0 * criterion.parameter * temper_of(model.fit);
    const std::vector<std::size_t> kept = worth_keeping(model.fit, price);
    if (kept.empty()) return std::nullopt;
    PlacedLaw& law = model.fit.hypothesis.laws.back();
    if (kept.size() == law.values.size()) break;
    Hypothesis fewer = model.fit.hypothesis;
    fewer.laws.back() = with_branches(law, kept);
    put_laws(fewer.laws, fewer.rig);
    model = fitted_with_laws(problem, space, fewer, effects, thresholds::stack_steps);
  }
  if (!std::isfinite(model.fit.chi_squared) || branch_count(model.fit.hypothesis) == 0) return std::nullopt;
  return model;
}

std::size_t branch_count(const Hypothesis& hypothesis) {
  const std::vector<double>& forces = hypothesis.laws.back().values;
  return static_cast<std::size_t>(std::count_if(forces.begin(), forces.end(), [](double c) { return c > 0.0; }));
}

}  // namespace host_sim::identification
