// Which number of open ducts a prediction prefers.
#pragma once

#include <array>

#include "firmware/loop/duct_control/duct_settings.hpp"
#include "firmware/loop/kalman/estimator_equations.hpp"
#include "firmware/loop/kalman/steady_gains.hpp"
#include "hal/valve_bank.hpp"

namespace firmware {

/// The number of periods nearest to a time ≥ 0.
[[nodiscard]] inline int nearest_periods(double time, double period) {
  const double periods = time / period + 0.5;
  return static_cast<int>(periods);
}

/// Predicts the car over a horizon of H periods, with n open ducts for the first K of them and m for the rest, and takes
/// the n of the smallest
///
///   (1)  J_nm(x) = Σ_{k=1…H} x_kᵀ C x_k,   x_{k+1} = Φ_n x_k up to k = K, then S_nm once and Φ_m
///   (2)  C = Σ w r rᵀ/scale²               rows r of wheel load, body acceleration, component force, stroke
///
/// S_nm: what a switching leaves of the piston's velocity, min(n, m)/n. The m is decided again when its time comes.
/// The prediction is linear (losses linearised as in SteadyGains, road without further noise), so (1) is a quadratic
/// form whose matrix is computed beforehand, M_nn′ = Σ (Φ_nᵀ)ᵏ C Φ_nᵏ + (Φ_nᵀ)ᴷ S_nmᵀ M_m S_nm Φ_nᴷ: a rollout of any
/// length costs N²/2 multiplications for each of the 49 pairs, and gives the number that the sum step by step would
/// give.
///
/// Valves that come late: the state is first predicted to the instant at which the valves will have moved, with the
/// ducts that are on their way until then. There the flow of closing ducts ends, and (1) begins.
/// Pressure peak of a closing duct with flow velocity u, l and t_c its length and closing time, c = 1400 m/s in oil:
///
///   (3)  Δp = ρ u min(c, 2 l/t_c)          Joukowsky, and Michaud where the valve is slower than the wave
///
/// A number of ducts that closes some at a higher peak than allowed is no candidate.
/// Source: (1) Bertsekas, Dynamic programming and optimal control, 2012 (rollout of constant policies); (3) Wylie and
/// Streeter, Fluid transients in systems, 1993.
class Rollout {
 public:
  static constexpr int counts = SteadyGains::counts;
  static constexpr int longest_delay = 64;      ///< periods
  static constexpr double sound = 1400.0;       ///< c [m/s]
  static constexpr double change_after = 0.02;  ///< K periods are the nearest to this time [s], at most the horizon

  /// `gains` is room for the construction.
  Rollout(const EstimatorEquations& equations, SteadyGains& gains, const DuctPolicySettings& settings, double period);

  /// One period on with these ducts open, linear; `before`: open until now.
  void advance(EstimatorVector& x, hal::Openings before, hal::Openings open) const;
  /// The number of ducts to be open from x on; `open`: those that are until then.
  [[nodiscard]] int best(const EstimatorVector& x, hal::Openings open) const;
  /// (1)
  [[nodiscard]] double cost(const EstimatorVector& x, int open, int later) const;
  [[nodiscard]] int change() const { return change_; }  ///< K
  /// (3) [Pa], when ducts with the piston at this velocity close.
  [[nodiscard]] double pressure_peak(double piston_velocity, int open) const;
  [[nodiscard]] double highest_peak() const { return highest_peak_; }

 private:
  /// A symmetric matrix: column by column its half above the diagonal.
  using Form = std::array<double, static_cast<std::size_t>(estimator_states) * (estimator_states + 1) / 2>;

  /// M ← Φᵀ (C + M) Φ, `periods` times.
  void continue_cost(EstimatorMatrix& m, const EstimatorMatrix& c, int open, int periods) const;
  void keep(Form& form, const EstimatorMatrix& m) const;
  void compute_forms(const EstimatorMatrix& c, int horizon);
  void switch_ducts(EstimatorVector& x, hal::Openings before, hal::Openings open) const;

  int states_, ducts_;
  int piston_;  ///< state of its velocity
  double highest_peak_;
  double peak_per_velocity_;  ///< of one open duct [Pa s/m]
  int change_;                ///< K
  std::array<EstimatorMatrix, counts> transition_;
  std::array<std::array<Form, counts>, counts> forms_{};  ///< M_nm
};

}  // namespace firmware
