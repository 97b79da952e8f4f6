#include "host_sim/identification/learn/penalised_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/identification/learn/thresholds.hpp"
#include "host_sim/least_squares/gram.hpp"

namespace host_sim::identification {
namespace {

/// (3) over a grid of λ, in units that make M and P alike.
double likeliest_penalty(const LawInformation& r, Eigen::Index straight) {
  const double unit = r.matrix.trace() / r.temper / std::max(r.penalty.trace(), 1e-300);
  const auto rank = static_cast<double>(r.now.size() - straight);
  double best = -INFINITY, chosen = unit;
  for (double step = thresholds::least_penalty; step <= thresholds::largest_penalty; step += 0.5) {
    const double lambda = unit * std::pow(10.0, step);
    const Eigen::MatrixXd a = r.matrix / r.temper + lambda * r.penalty;
    const Eigen::LDLT<Eigen::MatrixXd> factor(a);
    const Eigen::VectorXd b = -r.gradient / r.temper - lambda * (r.penalty * r.now);
    const double fall = 0.5 * b.dot(factor.solve(b)) - 0.5 * lambda * r.now.dot(r.penalty * r.now);
    const double determinant = factor.vectorD().array().abs().max(1e-300).log().sum();
    const double evidence = fall + 0.5 * rank * std::log(lambda) - 0.5 * determinant;
    if (evidence > best) best = evidence, chosen = lambda;
  }
  return chosen;
}

}  // namespace

double LawInformation::freedom() const {
  const Eigen::MatrixXd m = matrix / temper;
  return (m + lambda * penalty).ldlt().solve(m).trace();
}

PenalisedFit::PenalisedFit(const IdentificationProblem& problem, const SearchSpace& space, const Hypothesis& start,
                           const std::vector<firmware::PlacedEffect>& effects, Eigen::MatrixXd penalty,
                           Eigen::Index straight)
    : problem_(problem), effects_(effects), straight_(straight) {
  fit_.hypothesis = start;
  fit_.parameters = parameters_with_laws(space, start, effects);
  fit_.prediction = predict(problem, fit_.hypothesis);
  fit_.residual = residuals(problem, fit_.prediction);
  fit_.chi_squared = before_ = fit_.residual.squaredNorm();
  for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
    const FreeParameter& p = fit_.parameters[i];
    if (p.role != FreeParameter::Role::law || p.law + 1 != start.laws.size()) continue;
    if (count_++ == 0) first_ = static_cast<Eigen::Index>(i);
  }
  known_.penalty = std::move(penalty);
  known_.scale = fit_.parameters[static_cast<std::size_t>(first_)].scale;
}

bool PenalisedFit::is_finite() const { return std::isfinite(before_); }

void PenalisedFit::run(int most) {
  for (int i = 0; i < most && step(); ++i) {
  }
  linearise();
}

CandidateModel PenalisedFit::model() const {
  CandidateModel model;
  model.fit = fit_;
  model.effects = effects_;
  model.channels = problem_.channels().size();
  return model;
}

/// One step of Gauss–Newton; false where nothing is gained any more.
bool PenalisedFit::step() {
  linearise();
  const double temper = known_.temper, lambda = known_.lambda;
  const Eigen::MatrixXd& penalty = known_.penalty;
  Eigen::MatrixXd h = hessian_ / temper;
  Eigen::VectorXd g = gradient_ / temper;
  h.block(first_, first_, count_, count_) += lambda * penalty;
  g.segment(first_, count_) += lambda * (penalty * known_.now);
  double trust = 1.0;
  const double before = fit_.chi_squared / temper + lambda * known_.now.dot(penalty * known_.now);
  for (int attempt = 0; attempt < 4; ++attempt, trust *= 0.35) {
    const Eigen::VectorXd d = trust * bounded_step(h, g, step_box(fit_.parameters, fit_.hypothesis, 1.0));
    if (!d.allFinite()) return false;
    Hypothesis tried = fit_.hypothesis;
    for (std::size_t i = 0; i < fit_.parameters.size(); ++i) {
      const FreeParameter& p = fit_.parameters[i];
      p.put(tried, p.get(fit_.hypothesis) + d(static_cast<Eigen::Index>(i)));
    }
    if (firmware::find_rig_fault(tried.rig, problem_.sample_period())) continue;
    Prediction prediction = predict(problem_, tried);
    Eigen::VectorXd residual = residuals(problem_, prediction);
    const Eigen::VectorXd law = known_.now + d.segment(first_, count_);
    const double after = residual.squaredNorm() / temper + lambda * law.dot(penalty * law);
    if (!(after < before)) continue;
    fit_.hypothesis = std::move(tried);
    fit_.prediction = std::move(prediction);
    fit_.residual = std::move(residual);
    fit_.chi_squared = fit_.residual.squaredNorm();
    return before - after > thresholds::curve_settled * (1.0 + 1e-3 * before);
  }
  return false;
}

/// J, its products and λ at the present point.
void PenalisedFit::linearise() {
  refresh_jacobian(problem_, fit_);
  hessian_ = gram(fit_.jacobian);
  gradient_ = transposed_product(fit_.jacobian, fit_.residual);
  known_.temper = std::max(1.0, fit_.chi_squared / static_cast<double>(fit_.residual.size()));
  for (Eigen::Index i = 0; i < hessian_.rows(); ++i) {
    const FreeParameter& p = fit_.parameters[static_cast<std::size_t>(i)];
    const double width = p.upper - p.lower;
    hessian_(i, i) += 1e-10 * hessian_(i, i) + 1e-30;
    if (p.role == FreeParameter::Role::tolerated) hessian_(i, i) += 12.0 * known_.temper / (width * width);
  }
  reduce();
  known_.lambda = likeliest_penalty(known_, straight_);
}

/// Schur complement of the law's block.
void PenalisedFit::reduce() {
  const Eigen::Index n = hessian_.rows() - count_;
  Eigen::MatrixXd others(n, n), between(n, count_);
  Eigen::VectorXd g(n);
  std::vector<Eigen::Index> of;
  for (Eigen::Index i = 0; i < hessian_.rows(); ++i) {
    if (i < first_ || i >= first_ + count_) of.push_back(i);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index row = of[static_cast<std::size_t>(i)];
    for (Eigen::Index k = 0; k < n; ++k) others(i, k) = hessian_(row, of[static_cast<std::size_t>(k)]);
    between.row(i) = hessian_.block(row, first_, 1, count_);
    g(i) = gradient_(row);
  }
  known_.matrix = hessian_.block(first_, first_, count_, count_);
  known_.gradient = gradient_.segment(first_, count_);
  if (n > 0) {
    const Eigen::LDLT<Eigen::MatrixXd> factor(others);
    known_.matrix -= between.transpose() * factor.solve(between);
    known_.gradient -= between.transpose() * factor.solve(g);
  }
  known_.now.resize(count_);
  for (Eigen::Index i = 0; i < count_; ++i) {
    known_.now(i) = fit_.parameters[static_cast<std::size_t>(first_ + i)].get(fit_.hypothesis);
  }
}

Eigen::MatrixXd bends(const std::vector<double>& at) {
  const auto n = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd off = Eigen::MatrixXd::Zero(n - 2, n);
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double share = (at[k] - at[k - 1]) / (at[k + 1] - at[k - 1]);
    off(i - 1, i) = 1.0;
    off(i - 1, i + 1) = -share;
    off(i - 1, i - 1) = share - 1.0;
  }
  return off;
}

}  // namespace host_sim::identification
