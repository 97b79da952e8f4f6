// The gains of the Kalman filter in the steady state.
#pragma once

#include <array>

#include "firmware/loop/kalman/estimator_equations.hpp"
#include "model/components/fdva.hpp"

namespace firmware {

/// Covariances of a filter that has run for long with n open ducts, and what it multiplies samples with.
///
///   (1)  Q  = ∫₀ʰ e^{As} ½ B Bᵀ e^{Aᵀs} ds + drift of the biases      by halving h 2¹² times, then Q ← Q + Φ Q Φᵀ
///  (1′)  Q  = b bᵀ/(2h),  b = ∫₀ʰ e^{As} B ds                             on a road with a bandwidth
///  (model::RoadFilter)
///   (2)  P  = Φ P (I + G P)⁻¹ Φᵀ + Q,   G = Σ c_i c_iᵀ/r_i²           Riccati equation, P before the samples
///   (3)  A ← A (I + G H)⁻¹ A,  G ← G + A (I + G H)⁻¹ G Aᵀ,  H ← H + Aᵀ H (I + G H)⁻¹ A     doubling, H → P
///   (4)  k_i = P c_i/s_i,  s_i = c_iᵀ P c_i + r_i²,  P ← (I − k_i c_iᵀ) P (I − k_i c_iᵀ)ᵀ + k_i r_i² k_iᵀ
///        one channel after another, in Joseph form
///
/// (1′): noise held for a period, as the road of a simulated rig has it. With (1) a filtered road's foot point would
/// have 5 % more variance in the innovations of zdd_r than it has.
///
/// (3) begins at A = Φᵀ, G, H = Q and does 2^k periods in k rounds; `rounds` = 17 are 131 s at 1 kHz. A state whose
/// variance still grows then is not observable. Φ is that of EstimatorEquations (3), whose piston velocity is found
/// from the undisturbed motion in two rounds.
///
/// Late channels: `lag` periods after an instant the samples of the channels whose usual age is at most that long are
/// there. lag = longest: all are, P of (2). From there to lag 0 a period each: predicted with Φ, Q, then (4) for
/// the channels that are there.
/// Source: (3) Chu, Fan, Lin, Wang, Structure-preserving algorithms for periodic discrete-time algebraic Riccati
/// equations, 2004; (4) Bucy and Joseph, 1968.
class SteadyGains {
 public:
  static constexpr int counts = static_cast<int>(model::duct_capacity) + 1;
  static constexpr int lags = longest_history + 1;
  static constexpr int rounds = 17;

  SteadyGains(const EstimatorEquations& equations, double period);

  /// The first state that is not observable with the channels, n ducts open; −1: all are.
  [[nodiscard]] int unobservable() const { return unobservable_; }
  [[nodiscard]] int longest_lag() const { return longest_lag_; }
  [[nodiscard]] int lag(int channel) const { return lag_[static_cast<std::size_t>(channel)]; }

  /// Computes everything for n open ducts, in place of the count before.
  void compute(int open);
  /// P at this lag, before the samples; longest_lag(): of (2).
  [[nodiscard]] const EstimatorMatrix& prior(int lag) const { return priors_[static_cast<std::size_t>(lag)]; }
  [[nodiscard]] const EstimatorMatrix& posterior() const { return posterior_; }    ///< at lag 0, after the samples
  [[nodiscard]] const EstimatorMatrix& stationary() const { return stationary_; }  ///< of the states, without samples
  [[nodiscard]] const EstimatorMatrix& transition() const { return transition_; }  ///< Φ, losses linearised
  [[nodiscard]] const EstimatorMatrix& noise() const { return noise_; }            ///< Q
  [[nodiscard]] double piston_rms() const { return piston_rms_; }                  ///< of the linearisation [m/s]

 private:
  void hold_noise(const EstimatorVector& held);
  void accumulate_noise(const EstimatorMatrix& a);
  void discretise(int open);
  void solve_riccati();
  void update(EstimatorMatrix& p, int channel) const;

  const EstimatorEquations& equations_;
  double period_;
  int n_;
  int unobservable_ = -1;
  int longest_lag_ = 0;
  double piston_rms_ = 0.0;
  std::array<int, estimator_channels> lag_{};
  std::array<EstimatorVector, estimator_channels> row_{};
  std::array<double, estimator_channels> variance_{};  ///< r_i²
  std::array<EstimatorMatrix, lags> priors_{};
  EstimatorMatrix transition_, noise_, prior_, posterior_, stationary_;
  mutable EstimatorMatrix work_1_, work_2_, work_3_, work_4_, work_5_;  ///< not on the stack of a board
};

}  // namespace firmware
