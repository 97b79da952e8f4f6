#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "host_sim/least_squares/bounded_step.hpp"
#include "tests/reference/diagnose.hpp"

namespace reference {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Bounds of a step: those of the parameters, and for an effect a factor of e, or three times a signed value.
host_sim::StepBox step_box(const Fit& fit, double trust) {
  const auto n = static_cast<Index>(fit.parameters.size());
  host_sim::StepBox box{VectorXd(n), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const Parameter& p = fit.parameters[static_cast<std::size_t>(i)];
    const double u = p.get(fit.model);
    const double far = trust * (!p.cause ? 2.0 : p.logarithmic ? 1.0 : std::max(1.0, 3.0 * std::abs(u)));
    box.lower(i) = std::max(std::min(p.lower - u, 0.0), -far);
    box.upper(i) = std::min(std::max(p.upper - u, 0.0), far);
  }
  return box;
}

Model moved(const Fit& fit, const VectorXd& step) {
  Model model = fit.model;
  for (Index i = 0; i < step.size(); ++i) {
    const Parameter& p = fit.parameters[static_cast<std::size_t>(i)];
    p.put(model, p.get(model) + step(i));
  }
  return model;
}

}  // namespace

Problem::Problem(const Description& description, const std::vector<firmware::Recording>& recordings, double seconds,
                 const Model& noise)
    : description_(description) {
  for (const firmware::Recording& recording : recordings) {
    recordings_.push_back(measured(description, recording, seconds));
    whitenings_.emplace_back(description, recordings_.back(), noise);
    cells_.insert(cells_.end(), whitenings_.back().cells().begin(), whitenings_.back().cells().end());
  }
  const Model described{std::vector<double>(description.tolerance.size()), {}};
  scales_ = scales_of(description, recordings_.front(), predicted(description, described, recordings_.front()));
}

VectorXd Problem::residual(const Model& model) const {
  VectorXd all(static_cast<Index>(cells_.size()));
  Index from = 0;
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const VectorXd part = whitenings_[r](recordings_[r], predicted(description_, model, recordings_[r]));
    all.segment(from, part.size()) = part;
    from += part.size();
  }
  return all;
}

std::vector<Cell> Problem::cells(const VectorXd& residual) const {
  std::vector<Cell> cells(bands * recordings_.front().channels.size());
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells[cells_[i]].power += std::pow(residual(static_cast<Index>(i)), 2);
    cells[cells_[i]].count += 1.0;
  }
  return cells;
}

double Problem::counted(const VectorXd& residual) const {
  double sum = 0.0;
  for (const Cell& cell : cells(residual)) sum += reference::counted(cell);
  return sum;
}

VectorXd Problem::weights(const VectorXd& residual) const {
  const std::vector<Cell> all = cells(residual);
  VectorXd w(residual.size());
  for (Index i = 0; i < w.size(); ++i) w(i) = weight(all[cells_[static_cast<std::size_t>(i)]]);
  return w;
}

void Problem::differentiate(Fit& fit, Index from) const {
  for (Index i = from; i < fit.jacobian.cols(); ++i) {
    const Parameter& p = fit.parameters[static_cast<std::size_t>(i)];
    const double step = p.get(fit.model) + 0.01 > p.upper ? -0.01 : 0.01;
    fit.jacobian.col(i) = (residual(moved(fit, step * VectorXd::Unit(fit.jacobian.cols(), i))) - fit.residual) / step;
  }
}

Fit Problem::fit(const Model& start, const MatrixXd& known, int most) const {
  Fit f{start, parameters_of(start, recordings_.front(), scales_), residual(start)};
  f.jacobian = MatrixXd::Zero(f.residual.size(), static_cast<Index>(f.parameters.size()));
  if (known.cols() > 0) f.jacobian.leftCols(known.cols()) = known;
  for (bool tempered = known.cols() == 0, done = false; !done; done = tempered, tempered = true) {
    const auto left = [&](const VectorXd& r) { return tempered ? counted(r) : r.squaredNorm(); };
    for (int i = 0; i < most; ++i) {
      differentiate(f, known.cols());
      const VectorXd w = tempered ? weights(f.residual) : VectorXd::Ones(f.residual.size());
      const MatrixXd weighted = w.asDiagonal() * f.jacobian, hessian = f.jacobian.transpose() * weighted;
      const double before = left(f.residual);
      double now = before;
      for (double trust = 1.0; trust > 0.01 && !(now < before); trust /= 4.0) {
        const auto step = host_sim::bounded_step(hessian, weighted.transpose() * f.residual, step_box(f, trust));
        const Model model = moved(f, step);
        const VectorXd r = residual(model);
        now = left(r);
        if (now < before) f.model = model, f.residual = r;
      }
      if (!(now < before - 0.3)) break;
    }
  }
  std::vector<double> widths;
  for (const Parameter& p : f.parameters) widths.push_back(p.width());
  f.evidence =
      counted(f.residual) + occam(f.jacobian.transpose() * weights(f.residual).asDiagonal() * f.jacobian, widths);
  const double of_channel = std::log(static_cast<double>(recordings_.front().channels.size()));
  for (const Cause& cause : f.model.causes) f.evidence += 2.0 * (log_prior + (cause.channel ? of_channel : 0.0));
  if (!std::isfinite(f.evidence)) f.evidence = INFINITY;
  return f;
}

std::vector<Scanned> Problem::scan(const Fit& fit) const {
  const VectorXd w = weights(fit.residual);
  const MatrixXd weighted = w.asDiagonal() * fit.jacobian;
  MatrixXd hessian = fit.jacobian.transpose() * weighted;
  hessian.diagonal().array() += 3.0;
  const Eigen::LDLT<MatrixXd> solver(hessian);
  const auto way_made = [&](const VectorXd& r) -> VectorXd {
    return r - fit.jacobian * solver.solve(weighted.transpose() * r);
  };
  const VectorXd rest = way_made(fit.residual);
  std::vector<Scanned> result;
  for (Cause& cause : candidates(description_, recordings_.front(), scales_)) {
    Model model = fit.model;
    model.causes.push_back(cause);
    const VectorXd d = way_made(residual(model) - fit.residual), weighted_d = w.asDiagonal() * d;
    const double best = -weighted_d.dot(rest) / weighted_d.dot(d);
    if (!std::isfinite(best)) continue;
    const bool either_sign = !cause.values.empty() && cause.entry->parameters[0].lower < 0.0;
    const double a = either_sign ? best : std::clamp(best, 0.5, 2.0);
    if (either_sign) {
      const double neutral = cause.entry->parameters[0].neutral;
      cause.values[0] = neutral + a * (cause.values[0] - neutral);
    }
    result.push_back({cause, counted(fit.residual) - counted(rest + a * d)});
  }
  std::stable_sort(result.begin(), result.end(), [](const Scanned& x, const Scanned& y) { return x.gain > y.gain; });
  return result;
}

}  // namespace reference
