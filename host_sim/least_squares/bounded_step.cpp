#include "host_sim/least_squares/bounded_step.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

namespace host_sim {
namespace {

enum class At : unsigned char { inside, lower_bound, upper_bound };

/// Solves (1) for the free components with all others at their bounds; d holds both afterwards.
std::vector<Eigen::Index> solve_free(const Eigen::MatrixXd& h, const Eigen::VectorXd& g, const StepBox& box,
                                     const std::vector<At>& at, Eigen::VectorXd& d) {
  const Eigen::Index n = g.size();
  std::vector<Eigen::Index> free;
  for (Eigen::Index i = 0; i < n; ++i) {
    const At where = at[static_cast<std::size_t>(i)];
    if (where == At::inside) free.push_back(i);
    if (where == At::lower_bound) d(i) = box.lower(i);
    if (where == At::upper_bound) d(i) = box.upper(i);
  }
  const auto m = static_cast<Eigen::Index>(free.size());
  if (m == 0) return free;
  Eigen::MatrixXd reduced(m, m);
  Eigen::VectorXd right(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::Index a = free[static_cast<std::size_t>(i)];
    right(i) = -g(a);
    for (Eigen::Index j = 0; j < n; ++j) {
      if (at[static_cast<std::size_t>(j)] != At::inside) right(i) -= h(a, j) * d(j);
    }
    for (Eigen::Index j = 0; j < m; ++j) reduced(i, j) = h(a, free[static_cast<std::size_t>(j)]);
    constexpr double ridge = 1e-12;
    reduced(i, i) += ridge * h(a, a) + 1e-30;
  }
  const Eigen::VectorXd step = reduced.ldlt().solve(right);
  for (Eigen::Index i = 0; i < m; ++i) d(free[static_cast<std::size_t>(i)]) = step(i);
  return free;
}

}  // namespace

Eigen::VectorXd bounded_step(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& gradient, const StepBox& box) {
  const auto& [lower, upper] = box;
  const Eigen::Index n = gradient.size();
  std::vector<At> at(static_cast<std::size_t>(n), At::inside);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(n);
  if (n == 0) return d;
  const int most_rounds = 4 * static_cast<int>(n) + 4;
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<Eigen::Index> free = solve_free(hessian, gradient, box, at, d);
    // The bound that is passed by most becomes active.
    Eigen::Index worst = -1;
    double most = 1e-12;
    for (const Eigen::Index a : free) {
      const double beyond = std::max(lower(a) - d(a), d(a) - upper(a));
      const double relative = beyond / (upper(a) - lower(a) + 1e-30);
      if (relative > most) {
        most = relative;
        worst = a;
      }
    }
    if (worst >= 0) {
      at[static_cast<std::size_t>(worst)] = d(worst) < lower(worst) ? At::lower_bound : At::upper_bound;
      continue;
    }
    // A bound that holds back nothing becomes free again.
    const Eigen::VectorXd slope = hessian * d + gradient;
    Eigen::Index released = -1;
    double strongest = 1e-9 * (gradient.cwiseAbs().maxCoeff() + 1e-30);
    for (Eigen::Index i = 0; i < n; ++i) {
      const At where = at[static_cast<std::size_t>(i)];
      const double pull = where == At::lower_bound ? -slope(i) : (where == At::upper_bound ? slope(i) : 0.0);
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

}  // namespace host_sim
