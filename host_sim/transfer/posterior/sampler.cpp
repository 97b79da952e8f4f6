#include "host_sim/transfer/posterior/sampler.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

#include "firmware/simulation/gaussian.hpp"
#include "host_sim/transfer/common/thresholds.hpp"

namespace host_sim::transfer {
namespace {

constexpr double never = -std::numeric_limits<double>::infinity();
constexpr int tail_degrees = 5;  // of Student's t (3): finite variance, tails heavier than any posterior of a fit

/// A triangular root of a covariance; of one that rounding made indefinite, of its diagonal.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  if (factor.info() == Eigen::Success) return factor.matrixL();
  return covariance.diagonal().cwiseMax(1e-300).cwiseSqrt().asDiagonal();
}

/// (3)
class LaplaceProposal {
 public:
  LaplaceProposal(const Eigen::VectorXd& mode, const Eigen::MatrixXd& covariance)
      : mode_(mode), root_(root_of(covariance)) {}

  Eigen::VectorXd operator()(firmware::Gaussian& normal) const {
    const Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(mode_.size(), [&] { return normal(); });
    double squares = 0.0;
    for (int i = 0; i < tail_degrees; ++i) squares += std::pow(normal(), 2);
    return mode_ + root_ * z * std::sqrt(tail_degrees / std::max(squares, 1e-12));
  }
  /// Logarithm of the density, up to a constant.
  [[nodiscard]] double log_density(const Eigen::VectorXd& u) const {
    const Eigen::VectorXd z = root_.triangularView<Eigen::Lower>().solve(u - mode_);
    return -0.5 * static_cast<double>(tail_degrees + u.size()) * std::log1p(z.squaredNorm() / tail_degrees);
  }

 private:
  Eigen::VectorXd mode_;
  Eigen::MatrixXd root_;
};

struct Chain {
  Eigen::VectorXd at;
  double log_density = never;
};

/// Mean and covariance of draws as they come.
class RunningCovariance {
 public:
  explicit RunningCovariance(const Eigen::MatrixXd& first)
      : mean_(Eigen::VectorXd::Zero(first.rows())), sum_(first * weight_of_first), count_(0.0) {}
  void add(const Eigen::VectorXd& u) {
    count_ += 1.0;
    const Eigen::VectorXd before = u - mean_;
    mean_ += before / count_;
    sum_ += before * (u - mean_).transpose();
  }
  [[nodiscard]] Eigen::MatrixXd covariance() const { return sum_ / (count_ + weight_of_first); }

 private:
  static constexpr double weight_of_first = 20.0;  // draws that the Laplace approximation counts for
  Eigen::VectorXd mean_;
  Eigen::MatrixXd sum_;
  double count_;
};

std::vector<Eigen::MatrixXd> halves(const std::vector<Eigen::MatrixXd>& chains) {
  std::vector<Eigen::MatrixXd> list;
  for (const Eigen::MatrixXd& chain : chains) {
    const Eigen::Index half = chain.cols() / 2;
    list.emplace_back(chain.leftCols(half));
    list.emplace_back(chain.rightCols(half));
  }
  return list;
}

struct Moments {
  double within = 0.0, between = 0.0;  ///< W and B of (1)
};
Moments moments_of(const std::vector<Eigen::MatrixXd>& chains, Eigen::Index coordinate) {
  const auto m = static_cast<double>(chains.size());
  double mean = 0.0, within = 0.0, between = 0.0;
  for (const auto& chain : chains) mean += chain.row(coordinate).mean() / m;
  for (const auto& chain : chains) {
    const double own = chain.row(coordinate).mean();
    within += (chain.row(coordinate).array() - own).square().sum() / static_cast<double>(chain.cols() - 1) / m;
    between += std::pow(own - mean, 2) / (m - 1.0);
  }
  return {within, between};
}

}  // namespace

Eigen::MatrixXd Samples::all() const {
  Eigen::Index columns = 0;
  for (const auto& chain : chains) columns += chain.cols();
  Eigen::MatrixXd together(chains.empty() ? 0 : chains.front().rows(), columns);
  Eigen::Index at = 0;
  for (const auto& chain : chains) {
    together.middleCols(at, chain.cols()) = chain;
    at += chain.cols();
  }
  return together;
}

Eigen::VectorXd split_rhat(const std::vector<Eigen::MatrixXd>& chains) {
  const std::vector<Eigen::MatrixXd> parts = halves(chains);
  const auto n = static_cast<double>(parts.front().cols());
  Eigen::VectorXd rhat(parts.front().rows());
  for (Eigen::Index i = 0; i < rhat.size(); ++i) {
    const Moments m = moments_of(parts, i);
    rhat(i) = m.within > 0.0 ? std::sqrt((m.within * (n - 1.0) / n + m.between) / m.within)
                             : (m.between > 0.0 ? std::numeric_limits<double>::max() : 1.0);
  }
  return rhat;
}

Eigen::VectorXd effective_draws(const std::vector<Eigen::MatrixXd>& chains) {
  const Eigen::Index n = chains.front().cols(), d = chains.front().rows();
  const double total = static_cast<double>(n) * static_cast<double>(chains.size());
  Eigen::VectorXd effective(d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const Moments m = moments_of(chains, i);
    const auto length = static_cast<double>(n);
    const double variance = m.within * (length - 1.0) / length + m.between;
    if (!(variance > 0.0)) {
      effective(i) = 0.0;
      continue;
    }
    const auto correlation = [&](Eigen::Index lag) {  // over the chains, around their own means
      double sum = 0.0;
      for (const auto& chain : chains) {
        const double mean = chain.row(i).mean();
        for (Eigen::Index k = lag; k < n; ++k) sum += (chain(i, k) - mean) * (chain(i, k - lag) - mean);
      }
      return 1.0 - (m.within - sum / total) / variance;
    };
    double sum = 1.0, last = std::numeric_limits<double>::max();
    for (Eigen::Index lag = 1; lag + 1 < n; lag += 2) {
      const double pair = std::min(last, correlation(lag) + correlation(lag + 1));
      if (pair <= 0.0) break;
      sum += 2.0 * pair;
      last = pair;
    }
    effective(i) = std::min(total / sum, total);
  }
  return effective;
}

Samples sample(const LogDensities& log_densities, const Eigen::VectorXd& mode, const Eigen::MatrixXd& covariance,
               const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const SamplerOptions& options) {
  constexpr auto chains = static_cast<std::size_t>(thresholds::chains);
  const std::size_t steps = std::max<std::size_t>(20, options.draws / chains);
  const auto adapting = static_cast<std::size_t>(thresholds::burn_in * static_cast<double>(steps));
  firmware::Gaussian normal(options.seed, 71);
  std::seed_seq words{static_cast<std::uint32_t>(options.seed), static_cast<std::uint32_t>(options.seed >> 32U), 72U};
  std::mt19937_64 engine(words);
  const auto uniform = [&engine] { return static_cast<double>(engine() >> 11U) * 0x1p-53; };
  const LaplaceProposal laplace(mode, covariance);
  RunningCovariance running(covariance);
  const double stride = 2.38 / std::sqrt(static_cast<double>(mode.size()));
  const auto inside = [&](const Eigen::VectorXd& u) {
    return (u.array() >= lower.array()).all() && (u.array() <= upper.array()).all();
  };
  // Proposals outside of the bounds cost nothing: the densities of the others are asked for together.
  const auto densities_of = [&](const std::vector<Eigen::VectorXd>& at) {
    std::vector<Eigen::VectorXd> asked;
    std::vector<std::size_t> whose;
    for (std::size_t c = 0; c < at.size(); ++c) {
      if (!inside(at[c])) continue;
      asked.push_back(at[c]);
      whose.push_back(c);
    }
    std::vector<double> values(at.size(), never);
    const std::vector<double> found = asked.empty() ? std::vector<double>{} : log_densities(asked);
    for (std::size_t i = 0; i < whose.size(); ++i) values[whose[i]] = std::isfinite(found[i]) ? found[i] : never;
    return values;
  };

  std::vector<Chain> state(chains);
  std::vector<Eigen::VectorXd> proposed(chains);
  for (auto& u : proposed) {
    u = laplace(normal);
    for (int attempt = 0; !inside(u) && attempt < 100; ++attempt) u = laplace(normal);
    u = u.cwiseMax(lower).cwiseMin(upper);
  }
  std::vector<double> values = densities_of(proposed);
  for (std::size_t c = 0; c < chains; ++c) state[c] = {proposed[c], values[c]};

  Samples samples;
  samples.chains.assign(chains, Eigen::MatrixXd(mode.size(), static_cast<Eigen::Index>(steps - adapting)));
  Eigen::MatrixXd walk = root_of(covariance);
  std::size_t accepted = 0;
  std::vector<bool> independent(chains);
  for (std::size_t step = 0; step < steps; ++step) {
    for (std::size_t c = 0; c < chains; ++c) {
      independent[c] = uniform() < thresholds::independent_share;
      const Eigen::VectorXd z = Eigen::VectorXd::NullaryExpr(mode.size(), [&] { return normal(); });
      proposed[c] = independent[c] ? laplace(normal) : Eigen::VectorXd(state[c].at + stride * (walk * z));
    }
    values = densities_of(proposed);
    for (std::size_t c = 0; c < chains; ++c) {
      double ratio = values[c] - state[c].log_density;
      if (independent[c]) ratio += laplace.log_density(state[c].at) - laplace.log_density(proposed[c]);
      const double threshold = std::log(std::max(uniform(), 1e-300));
      if (values[c] > never && (state[c].log_density == never || threshold < ratio)) {
        state[c] = {proposed[c], values[c]};
        ++accepted;
      }
      if (step < adapting) {
        running.add(state[c].at);
      } else {
        samples.chains[c].col(static_cast<Eigen::Index>(step - adapting)) = state[c].at;
      }
    }
    if (step < adapting) walk = root_of(running.covariance());
    if (options.progress) options.progress(static_cast<double>(step + 1) / static_cast<double>(steps));
  }
  samples.accepted = static_cast<double>(accepted) / static_cast<double>(steps * chains);
  samples.rhat = split_rhat(samples.chains);
  samples.effective = effective_draws(samples.chains);
  return samples;
}

}  // namespace host_sim::transfer
