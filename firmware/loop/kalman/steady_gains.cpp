#include "firmware/loop/kalman/steady_gains.hpp"

#include <cmath>

#include "firmware/loop/kalman/square_matrices.hpp"
#include "model/numerics/exact_discretisation.hpp"

namespace firmware {
namespace {

using Matrix = EstimatorMatrix;
using Vector = EstimatorVector;
using model::absolute;
using model::CoreIndex;

void symmetrise(Matrix& p, int n) {
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < j; ++i) p(i, j) = p(j, i) = 0.5 * (p(i, j) + p(j, i));
  }
}

/// b ← a⁻¹ b by elimination with partial pivoting; a is used up.
void solve(Matrix& a, Matrix& b, int n) {
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) {
      if (absolute(a(i, k)) > absolute(a(pivot, k))) pivot = i;
    }
    for (int j = 0; j < n; ++j) {
      const double of_a = a(k, j), of_b = b(k, j);
      a(k, j) = a(pivot, j);
      a(pivot, j) = of_a;
      b(k, j) = b(pivot, j);
      b(pivot, j) = of_b;
    }
    for (int i = k + 1; i < n; ++i) {
      const double factor = a(i, k) / a(k, k);
      for (int j = k + 1; j < n; ++j) a(i, j) -= factor * a(k, j);
      for (int j = 0; j < n; ++j) b(i, j) -= factor * b(k, j);
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = n - 1; i >= 0; --i) {
      double sum = b(i, j);
      for (int k = i + 1; k < n; ++k) sum -= a(i, k) * b(k, j);
      b(i, j) = sum / a(i, i);
    }
  }
}

}  // namespace

SteadyGains::SteadyGains(const EstimatorEquations& equations, double period)
    : equations_(equations), period_(period), n_(equations.states()) {
  for (auto* matrix :
       {&transition_, &noise_, &prior_, &posterior_, &stationary_, &work_1_, &work_2_, &work_3_, &work_4_, &work_5_})
    matrix->setZero();
  const KalmanSettings& settings = equations.settings();
  for (int i = 0; i < equations.channels(); ++i) {
    const auto c = static_cast<std::size_t>(i);
    const model::Channel channel = equations.channel(i);
    const double rms = settings.noise[model::index(channel)];
    variance_[c] = rms * rms;
    const double age = settings.age[model::index(channel)] + equations.path(channel).delay;
    const double whole = age / period + 0.5;
    lag_[c] = whole >= longest_history ? longest_history : static_cast<int>(whole);
    if (lag_[c] > longest_lag_) longest_lag_ = lag_[c];
  }
  if (longest_lag_ == 0) longest_lag_ = 1;
  if (settings.history > 0) longest_lag_ = settings.history;
}

/// Noise of variance 1/(2h), held for a period, as model::RoadFilter steps: `held` is what a noise of 1 adds.
void SteadyGains::hold_noise(const EstimatorVector& held) {
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) noise_(i, j) = held(i) * held(j) / (2.0 * period_);
  }
}

/// White noise within the period, too (Van Loan's integral, by doubling). Uses work_1_, work_2_ and transition_.
void SteadyGains::accumulate_noise(const EstimatorMatrix& a) {
  constexpr int halvings = 12;
  const double step = period_ / static_cast<double>(1 << halvings);
  // The middle of a step stands for all of it: an error of (λ step)²/24, 1e-9 at λ = 1000 1/s.
  work_1_ = model::ExactDiscretisation<double, estimator_states>(a, 0.5 * step).transition();
  const Vector column = equations_.noise_column();
  Vector middle = Vector::Zero();
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) middle(i) += work_1_(i, j) * column(j);
  }
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) noise_(i, j) = 0.5 * step * middle(i) * middle(j);
  }
  multiply(transition_, work_1_, work_1_, n_);
  for (int k = 0; k < halvings; ++k) {
    multiply(work_1_, transition_, noise_, n_);
    multiply_transposed(work_2_, work_1_, transition_, n_);
    noise_ += work_2_;
    multiply(work_1_, transition_, transition_, n_);
    transition_ = work_1_;
  }
}

void SteadyGains::discretise(int open) {
  Matrix a = equations_.matrix(open);
  const int piston = equations_.core(CoreIndex::piston_velocity);
  if (piston >= 0) a(piston, piston) -= equations_.linear_loss(piston_rms_, open);
  const model::ExactDiscretisation<double, estimator_states> exact(a, period_);
  if (equations_.settings().bandwidth > 0.0) {
    hold_noise(exact.held(equations_.noise_column()));
  } else {
    accumulate_noise(a);
  }
  transition_ = exact.transition();
  const KalmanSettings& settings = equations_.settings();
  for (int i = 0; i < n_; ++i) {
    if (equations_.state(i).kind != EstimatorState::Kind::bias) continue;
    const double drift = settings.bias_drift * settings.noise[static_cast<std::size_t>(equations_.state(i).entry)];
    noise_(i, i) += drift * drift * period_;
  }
  symmetrise(noise_, n_);
  // A locked piston is known: it stands where it stood. Samples do not tell of it, and need not.
  for (const int locked : {equations_.core(CoreIndex::piston_travel), piston}) {
    if (open > 0 || locked < 0) continue;
    for (int i = 0; i < n_; ++i) transition_(i, locked) = transition_(locked, i) = 0.0;
  }
  // Without samples: S ← S + T S Tᵀ, T ← T². Biases and lone integrators grow; nobody asks for them.
  stationary_ = noise_;
  work_3_ = transition_;
  for (int k = 0; k < rounds; ++k) {
    multiply(work_1_, work_3_, stationary_, n_);
    multiply_transposed(work_2_, work_1_, work_3_, n_);
    stationary_ += work_2_;
    multiply(work_1_, work_3_, work_3_, n_);
    work_3_ = work_1_;
  }
}

void SteadyGains::solve_riccati() {
  Matrix& a = work_1_;
  Matrix& g = posterior_;  // used as room until the end
  Matrix& h = prior_;
  a = transition_.transpose();
  g.setZero();
  for (int c = 0; c < equations_.channels(); ++c) {
    const Vector& row = row_[static_cast<std::size_t>(c)];
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i < n_; ++i) g(i, j) += row(i) * row(j) / variance_[static_cast<std::size_t>(c)];
    }
  }
  h = noise_;
  std::array<double, estimator_states> before{};
  for (int k = 0; k < rounds; ++k) {
    for (int i = 0; i < n_; ++i) before[static_cast<std::size_t>(i)] = h(i, i);
    multiply(work_2_, g, h, n_);
    for (int i = 0; i < n_; ++i) work_2_(i, i) += 1.0;
    // With W = I + G H:  a' = a W⁻¹ a,  g' = g + a W⁻¹ g aᵀ,  h' = h + aᵀ h W⁻¹ a
    work_3_ = a;
    work_4_ = work_2_;
    solve(work_4_, work_3_, n_);  // W⁻¹ a
    work_4_ = g;
    solve(work_2_, work_4_, n_);  // W⁻¹ g
    multiply(work_2_, a, work_4_, n_);
    multiply_transposed(work_4_, work_2_, a, n_);
    g += work_4_;
    symmetrise(g, n_);
    multiply(work_2_, h, work_3_, n_);
    work_4_ = a.transpose();
    multiply(work_5_, work_4_, work_2_, n_);
    h += work_5_;
    symmetrise(h, n_);
    multiply(work_2_, a, work_3_, n_);
    a = work_2_;
  }
  for (int i = 0; i < n_ && unobservable_ < 0; ++i) {
    if (h(i, i) > 1.5 * before[static_cast<std::size_t>(i)] && h(i, i) > 0.0) unobservable_ = i;
  }
}

/// (4)
void SteadyGains::update(EstimatorMatrix& p, int channel) const {
  const Vector& row = row_[static_cast<std::size_t>(channel)];
  const double variance = variance_[static_cast<std::size_t>(channel)];
  Vector projected = Vector::Zero();
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) projected(i) += p(i, j) * row(j);
  }
  double total = variance;
  for (int i = 0; i < n_; ++i) total += row(i) * projected(i);
  const Vector gain = projected / total;
  work_1_.setZero();
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) work_1_(i, j) = (i == j ? 1.0 : 0.0) - gain(i) * row(j);
  }
  multiply(work_2_, work_1_, p, n_);
  multiply_transposed(p, work_2_, work_1_, n_);
  for (int j = 0; j < n_; ++j) {
    for (int i = 0; i < n_; ++i) p(i, j) += gain(i) * variance * gain(j);
  }
  symmetrise(p, n_);
}

void SteadyGains::compute(int open) {
  piston_rms_ = 0.0;
  const int piston = equations_.core(CoreIndex::piston_velocity);
  discretise(open);
  for (int round = 0; round < 2 && piston >= 0 && open > 0; ++round) {
    piston_rms_ = std::sqrt(stationary_(piston, piston));
    discretise(open);
  }
  for (int c = 0; c < equations_.channels(); ++c) {
    row_[static_cast<std::size_t>(c)] = equations_.row(equations_.channel(c), open, true);
    for (const int locked : {equations_.core(CoreIndex::piston_travel), piston}) {
      if (open == 0 && locked >= 0) row_[static_cast<std::size_t>(c)](locked) = 0.0;
    }
  }
  solve_riccati();
  // A few periods as the filter does them take off the rounding of (3).
  constexpr int polishing = 20;
  for (int k = 0; k < polishing; ++k) {
    for (int c = 0; c < equations_.channels(); ++c) update(prior_, c);
    multiply(work_1_, transition_, prior_, n_);
    multiply_transposed(prior_, work_1_, transition_, n_);
    prior_ += noise_;
  }
  posterior_ = prior_;
  for (int lag = longest_lag_; lag >= 0; --lag) {
    if (lag < longest_lag_) {
      multiply(work_1_, transition_, posterior_, n_);
      multiply_transposed(posterior_, work_1_, transition_, n_);
      posterior_ += noise_;
    }
    priors_[static_cast<std::size_t>(lag)] = posterior_;
    for (int c = 0; c < equations_.channels(); ++c) {
      if (lag == longest_lag_ || this->lag(c) <= lag) update(posterior_, c);
    }
  }
}

}  // namespace firmware
