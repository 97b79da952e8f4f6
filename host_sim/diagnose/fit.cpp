#include "host_sim/diagnose/fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace host_sim::diagnose {

std::vector<Response> respond(const Case& all, const Hypothesis& hypothesis) {
  std::vector<Response> responses;
  for (std::size_t r = 0; r < all.evidence.size(); ++r) {
    responses.push_back(host_sim::respond(hypothesis.rig, all.evidence[r].drive, hypothesis.starts[r]));
  }
  return responses;
}

Eigen::VectorXd residuals(const Case& all, const std::vector<Response>& responses, bool held_out) {
  const auto& whitenings = held_out ? all.judge : all.fit;
  const auto& recordings = held_out ? all.judged : all.fitted;
  std::size_t count = 0;
  for (const Whitening& w : whitenings) count += w.count();
  std::vector<double> values;
  values.reserve(count);
  for (std::size_t i = 0; i < whitenings.size(); ++i) {
    whitenings[i](all.evidence[recordings[i]], responses[recordings[i]], values);
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::VectorXd residuals(const Case& all, const Hypothesis& hypothesis) {
  std::vector<Response> responses(all.evidence.size());
  for (const std::size_t r : all.fitted) {
    responses[r] =
        host_sim::respond(hypothesis.rig, all.evidence[r].drive, hypothesis.starts[r], all.evidence[r].fit.to);
  }
  return residuals(all, responses, false);
}

Eigen::VectorXd bounded_step(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const Eigen::VectorXd& lower,
                             const Eigen::VectorXd& upper) {
  const Eigen::Index n = g.size();
  enum class At : unsigned char { inside, bottom, top };
  std::vector<At> at(static_cast<std::size_t>(n), At::inside);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  for (int round = 0; round < 4 * static_cast<int>(n) + 4; ++round) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i) {
      const At where = at[static_cast<std::size_t>(i)];
      if (where == At::inside) free.push_back(i);
      if (where == At::bottom) d(i) = lower(i);
      if (where == At::top) d(i) = upper(i);
    }
    const auto m = static_cast<Eigen::Index>(free.size());
    Eigen::MatrixXd reduced(m, m);
    Eigen::VectorXd right(m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index a = free[static_cast<std::size_t>(i)];
      right(i) = -g(a);
      for (Eigen::Index j = 0; j < n; ++j) {
        if (at[static_cast<std::size_t>(j)] != At::inside) right(i) -= h(a, j) * d(j);
      }
      for (Eigen::Index j = 0; j < m; ++j) reduced(i, j) = h(a, free[static_cast<std::size_t>(j)]);
      reduced(i, i) += 1e-12 * h(a, a) + 1e-30;
    }
    const Eigen::VectorXd step = m > 0 ? Eigen::VectorXd(reduced.ldlt().solve(right)) : Eigen::VectorXd();
    // The bound that is passed by most becomes active.
    Eigen::Index worst = -1;
    double most = 1e-12;
    for (Eigen::Index i = 0; i < m; ++i) {
      const Eigen::Index a = free[static_cast<std::size_t>(i)];
      d(a) = step(i);
      const double beyond = std::max(lower(a) - d(a), d(a) - upper(a));
      const double relative = beyond / (upper(a) - lower(a) + 1e-30);
      if (relative > most) {
        most = relative;
        worst = a;
      }
    }
    if (worst >= 0) {
      at[static_cast<std::size_t>(worst)] = d(worst) < lower(worst) ? At::bottom : At::top;
      continue;
    }
    // A bound that holds back nothing becomes free again.
    const Eigen::VectorXd slope = h * d + g;
    Eigen::Index released = -1;
    double strongest = 1e-9 * (g.cwiseAbs().maxCoeff() + 1e-30);
    for (Eigen::Index i = 0; i < n; ++i) {
      const At where = at[static_cast<std::size_t>(i)];
      const double pull = where == At::bottom ? -slope(i) : (where == At::top ? slope(i) : 0.0);
      if (pull > strongest) {
        strongest = pull;
        released = i;
      }
    }
    if (released < 0) return d;
    at[static_cast<std::size_t>(released)] = At::inside;
  }
  return d.cwiseMax(lower).cwiseMin(upper);
}

namespace {

Hypothesis moved(const Hypothesis& from, const Unknown& unknown, double u) {
  Hypothesis hypothesis = from;
  unknown.put(hypothesis, u);
  return hypothesis;
}

Eigen::VectorXd slope_of(const Case& all, const Hypothesis& hypothesis, const Unknown& unknown,
                         const Eigen::VectorXd& r) {
  const double u = unknown.get(hypothesis);
  const double step = u + unknown.step > unknown.upper ? -unknown.step : unknown.step;
  return (residuals(all, moved(hypothesis, unknown, u + step)) - r) / step;
}

}  // namespace

Eigen::MatrixXd jacobian(const Case& all, const Hypothesis& hypothesis, const std::vector<Unknown>& unknowns,
                         const Eigen::VectorXd& r) {
  Eigen::MatrixXd slope(r.size(), static_cast<Eigen::Index>(unknowns.size()));
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    slope.col(static_cast<Eigen::Index>(i)) = slope_of(all, hypothesis, unknowns[i], r);
  }
  return slope;
}

Eigen::MatrixXd Fit::covariance() const {
  Eigen::MatrixXd h = slope.transpose() * slope;
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double u = unknowns[i].get(hypothesis);
    h(k, k) += 1e-12 * h(k, k) + 1e-30;
    if (u <= unknowns[i].lower + 1e-9 || u >= unknowns[i].upper - 1e-9) h(k, k) += 1e12 * (h(k, k) + 1.0);
  }
  return h.ldlt().solve(Eigen::MatrixXd::Identity(h.rows(), h.cols()));
}

Fit fit(const Case& all, Hypothesis start, std::vector<Unknown> unknowns, int most,
        const Eigen::MatrixXd& known_slope) {
  Fit result;
  result.hypothesis = std::move(start);
  result.unknowns = std::move(unknowns);
  const auto n = static_cast<Eigen::Index>(result.unknowns.size());
  result.residual = residuals(all, result.hypothesis);
  result.chi_squared = result.residual.squaredNorm();
  result.slope.resize(result.residual.size(), n);
  const Eigen::Index known = known_slope.cols();
  if (known > 0) result.slope.leftCols(known) = known_slope;

  double trust = 1.0;  // of the logarithmic coordinates: a factor of e in one step at most
  for (int step = 0; step < most && n > 0; ++step) {
    for (Eigen::Index i = known; i < n; ++i) {
      result.slope.col(i) =
          slope_of(all, result.hypothesis, result.unknowns[static_cast<std::size_t>(i)], result.residual);
    }
    if (!result.slope.allFinite()) break;
    const Eigen::MatrixXd h = result.slope.transpose() * result.slope;
    const Eigen::VectorXd g = result.slope.transpose() * result.residual;
    Eigen::VectorXd u(n), lower(n), upper(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Unknown& unknown = result.unknowns[static_cast<std::size_t>(i)];
      u(i) = unknown.get(result.hypothesis);
      lower(i) = unknown.lower - u(i);
      upper(i) = unknown.upper - u(i);
      if (unknown.role == Unknown::Role::effect) {
        lower(i) = std::max(lower(i), -trust);
        upper(i) = std::min(upper(i), trust);
      }
    }
    const Eigen::VectorXd d = bounded_step(h, g, lower, upper);
    double share = 1.0;
    bool better = false;
    const double before = result.chi_squared;
    for (int attempt = 0; attempt < 5; ++attempt, share *= 0.35) {
      Hypothesis next = result.hypothesis;
      for (Eigen::Index i = 0; i < n; ++i) {
        result.unknowns[static_cast<std::size_t>(i)].put(next, u(i) + share * d(i));
      }
      if (find_rig_fault(next.rig, all.evidence.front().drive.period)) continue;
      Eigen::VectorXd r = residuals(all, next);
      const double chi = r.squaredNorm();
      if (chi < before) {
        result.hypothesis = std::move(next);
        result.residual = std::move(r);
        result.chi_squared = chi;
        better = true;
        break;
      }
    }
    if (share < 1.0) trust = std::max(0.05, trust * 0.5);
    if (!better || before - result.chi_squared < 0.01 + 1e-6 * result.chi_squared) break;
  }
  return result;
}

}  // namespace host_sim::diagnose
