#include "host_sim/identification/learn/curve_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/identification/learn/thresholds.hpp"
#include "host_sim/least_squares/gram.hpp"

namespace host_sim::identification {
namespace {

/// Where the curve's values stand among the free parameters.
struct CurveBlock {
  Eigen::Index first = 0, count = 0;
};
CurveBlock block_of(const std::vector<FreeParameter>& parameters, std::size_t law) {
  CurveBlock block;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].role != FreeParameter::Role::law || parameters[i].law != law) continue;
    if (block.count++ == 0) block.first = static_cast<Eigen::Index>(i);
  }
  return block;
}

/// (2) as a matrix on the free points.
Eigen::MatrixXd bends(const std::vector<double>& at) {
  const auto n = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n - 2, n);
  Eigen::Index zero = -1;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (at[k] == 0.0) zero = i;
    if (i == 0 || i + 1 == n) continue;
    const double share = (at[k] - at[k - 1]) / (at[k + 1] - at[k - 1]);
    all(i - 1, i) = 1.0;
    all(i - 1, i + 1) = -share;
    all(i - 1, i - 1) = share - 1.0;
  }
  Eigen::MatrixXd free(n - 2, n - 1);
  free << all.leftCols(zero), all.rightCols(n - 1 - zero);
  return free;
}

/// The linearised problem behind everything else: M, gradient, P, and the curve now; in the curve's coordinates.
struct ReducedCurve {
  Eigen::MatrixXd matrix, penalty;
  Eigen::VectorXd gradient, now;
};

/// (3) over a grid of λ, in units that make M and P alike.
double likeliest_penalty(const ReducedCurve& r, double temper) {
  const double unit = r.matrix.trace() / temper / std::max(r.penalty.trace(), 1e-300);
  const auto rank = static_cast<double>(r.now.size() - 1);
  double best = -INFINITY, chosen = unit;
  for (double step = thresholds::least_penalty; step <= thresholds::largest_penalty; step += 0.5) {
    const double lambda = unit * std::pow(10.0, step);
    const Eigen::MatrixXd a = r.matrix / temper + lambda * r.penalty;
    const Eigen::LDLT<Eigen::MatrixXd> factor(a);
    const Eigen::VectorXd b = -r.gradient / temper - lambda * (r.penalty * r.now);
    const double fall = 0.5 * b.dot(factor.solve(b)) - 0.5 * lambda * r.now.dot(r.penalty * r.now);
    const double determinant = factor.vectorD().array().abs().max(1e-300).log().sum();
    const double evidence = fall + 0.5 * rank * std::log(lambda) - 0.5 * determinant;
    if (evidence > best) best = evidence, chosen = lambda;
  }
  return chosen;
}

class PenalisedFit {
 public:
  PenalisedFit(const IdentificationProblem& problem, Fit& fit, std::size_t law)
      : problem_(problem), fit_(fit), block_(block_of(fit.parameters, law)) {
    scale_ = fit.parameters[static_cast<std::size_t>(block_.first)].scale;
    const Eigen::MatrixXd b = bends(fit.hypothesis.laws[law].at);
    penalty_ = b.transpose() * b;
  }

  /// One step of Gauss–Newton; false where nothing is gained any more.
  bool step() {
    linearise();
    Eigen::MatrixXd h = hessian_ / temper_;
    Eigen::VectorXd g = gradient_ / temper_;
    h.block(block_.first, block_.first, block_.count, block_.count) += lambda_ * penalty_;
    g.segment(block_.first, block_.count) += lambda_ * (penalty_ * reduced_.now);
    double trust = 1.0;
    const double before = fit_.chi_squared / temper_ + lambda_ * reduced_.now.dot(penalty_ * reduced_.now);
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
      ++fit_.simulations;
      const Eigen::VectorXd curve = reduced_.now + d.segment(block_.first, block_.count);
      const double after = residual.squaredNorm() / temper_ + lambda_ * curve.dot(penalty_ * curve);
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
  void linearise() {
    refresh_jacobian(problem_, fit_);
    hessian_ = gram(fit_.jacobian);
    gradient_ = transposed_product(fit_.jacobian, fit_.residual);
    temper_ = std::max(1.0, fit_.chi_squared / static_cast<double>(fit_.residual.size()));
    for (Eigen::Index i = 0; i < hessian_.rows(); ++i) {
      const FreeParameter& p = fit_.parameters[static_cast<std::size_t>(i)];
      const double width = p.upper - p.lower;
      hessian_(i, i) += 1e-10 * hessian_(i, i) + 1e-30;
      if (p.role == FreeParameter::Role::tolerated) hessian_(i, i) += 12.0 * temper_ / (width * width);
    }
    reduce();
    lambda_ = likeliest_penalty(reduced_, temper_);
  }

  [[nodiscard]] CurveFit result(std::size_t law) const {
    CurveFit out;
    out.matrix = reduced_.matrix / (scale_ * scale_ * temper_);
    out.gradient = reduced_.gradient / (scale_ * temper_);
    out.force = reduced_.now * scale_;
    for (const double x : fit_.hypothesis.laws[law].at) {
      if (x != 0.0) out.at.push_back(x);
    }
    out.temper = temper_;
    const Eigen::MatrixXd m = reduced_.matrix / temper_;
    out.freedom = (m + lambda_ * penalty_).ldlt().solve(m).trace();
    return out;
  }

 private:
  /// Schur complement of the curve's block.
  void reduce() {
    const Eigen::Index n = hessian_.rows() - block_.count;
    Eigen::MatrixXd others(n, n), between(n, block_.count);
    Eigen::VectorXd g(n);
    std::vector<Eigen::Index> of;
    for (Eigen::Index i = 0; i < hessian_.rows(); ++i) {
      if (i < block_.first || i >= block_.first + block_.count) of.push_back(i);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index row = of[static_cast<std::size_t>(i)];
      for (Eigen::Index k = 0; k < n; ++k) others(i, k) = hessian_(row, of[static_cast<std::size_t>(k)]);
      between.row(i) = hessian_.block(row, block_.first, 1, block_.count);
      g(i) = gradient_(row);
    }
    reduced_.matrix = hessian_.block(block_.first, block_.first, block_.count, block_.count);
    reduced_.gradient = gradient_.segment(block_.first, block_.count);
    if (n > 0) {
      const Eigen::LDLT<Eigen::MatrixXd> factor(others);
      reduced_.matrix -= between.transpose() * factor.solve(between);
      reduced_.gradient -= between.transpose() * factor.solve(g);
    }
    reduced_.penalty = penalty_;
    reduced_.now.resize(block_.count);
    for (Eigen::Index i = 0; i < block_.count; ++i) {
      reduced_.now(i) = fit_.parameters[static_cast<std::size_t>(block_.first + i)].get(fit_.hypothesis);
    }
  }

  const IdentificationProblem& problem_;
  Fit& fit_;
  CurveBlock block_;
  double scale_ = 1.0, temper_ = 1.0, lambda_ = 1.0;
  Eigen::MatrixXd penalty_, hessian_;
  Eigen::VectorXd gradient_;
  ReducedCurve reduced_;
};

}  // namespace

PlacedLaw flat_curve(CurvePlace place, CurveOver over, const ExcitedRange& range) {
  PlacedLaw law{place, over, LawFamily::points, range.rms, range.largest()};
  const double s = thresholds::innermost_point * range.rms, last = std::asinh(range.largest() / s);
  for (int i = -thresholds::points_each_side; i <= thresholds::points_each_side; ++i) {
    const double x = i == 0 ? 0.0 : s * std::sinh(last * i / thresholds::points_each_side);
    if (x < thresholds::beyond_range * range.lowest || x > thresholds::beyond_range * range.highest) continue;
    law.at.push_back(x);
  }
  law.values.assign(law.at.size(), 0.0);
  law.farthest = thresholds::table_beyond * range.farthest;
  return law;
}

std::optional<CurveFit> fit_curve(const IdentificationProblem& problem, const SearchSpace& space,
                                  const Hypothesis& start, const std::vector<firmware::PlacedEffect>& effects,
                                  int most) {
  const std::size_t law = start.laws.size() - 1;
  Fit fit;
  fit.hypothesis = start;
  fit.parameters = parameters_with_laws(space, start, effects);
  fit.prediction = predict(problem, fit.hypothesis);
  fit.residual = residuals(problem, fit.prediction);
  fit.chi_squared = fit.residual.squaredNorm();
  if (!std::isfinite(fit.chi_squared)) return std::nullopt;
  const double before = fit.chi_squared;
  PenalisedFit penalised(problem, fit, law);
  for (int i = 0; i < most && penalised.step(); ++i) {
  }
  penalised.linearise();
  CurveFit out = penalised.result(law);
  out.gain = before - fit.chi_squared;
  out.model.fit = std::move(fit);
  out.model.effects = effects;
  out.model.channels = problem.channels().size();
  return out;
}

}  // namespace host_sim::identification
