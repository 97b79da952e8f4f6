// Kalman filter of the quarter car with its road.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/loop/kalman/estimator_equations.hpp"
#include "firmware/loop/kalman/innovation_monitor.hpp"
#include "firmware/loop/kalman/steady_gains.hpp"
#include "hal/sensor_source.hpp"
#include "hal/time.hpp"
#include "hal/valve_bank.hpp"
#include "model/components/duct_flows.hpp"

namespace firmware {

/// Estimates the states of EstimatorEquations with the covariances of SteadyGains, once a period:
///
///   (1)  predict  x ← Φ_n x + b_q Σ q|q| + b_F F_act      n ducts open; losses as in model::RigModel, fourth order
///   (2)  switch   model::DuctFlows: the flow of a closing duct ends, an opening one begins at rest
///   (3)  correct  e = y_i − (c_i + δ c_i A + ½ δ² c_i A²) x − d_i F_act,   k = P c_i/s,   s = c_iᵀ P c_i + r_i²,
///                 x ← x + k e,   P ← P − k c_iᵀ P               channel by channel, those that are there
///
///   (4)  predict  P ← Φ_n P Φ_nᵀ + Q_n             losses linearised; no duct open: a piston that stands still
///
///   (5)  widen    P ← P + a J,  a = max(0, (e²/m² − s)/(c_iᵀ J c_i)), m = 5    of z_r and zdd_r, before (3)
///
/// The anchor's P is carried along by (3) and (4), from the steady state's: after lost samples and after a switch of
/// ducts the innovations are as large as their s says. (5): an innovation of the foot point's own sensors beyond m
/// standard deviations is no noise of the described road. It was a limited command, a step, a pothole, a road of another
/// shape: the road has jumped, and P grows until the jump is one of m standard deviations. J is the covariance of the
/// described road's own motion relative to its foot point, of which the foot point moves as far as it gets in a period.
/// The jumps are expected to go on: a J/`wide_time` less each period. (3) in the form
/// of Joseph, P ← P − k qᵀ − q kᵀ + k s kᵀ with q = P c. From the anchor to the present P begins every period at the
/// steady state's for the lag and the number of ducts: what is missing there leaves the others the gains that they have
/// without it.
///
/// Samples count for the instant of their stamp: it chooses the period (the nearest) and δ, at most half a period. An
/// anchor state runs longest_lag() periods behind, where all samples are there; from it the newest state is computed
/// anew each period, with the samples that have come so far. So each period costs longest_lag() + 2 times (1)–(3) and
/// once (4), whatever the samples. A sample that is missing, bad or shown before (same stamp) is skipped; one that is
/// too old for the history is counted and left out. The innovations of the anchor are white and of variance 1 for a
/// right model, whichever channels are there: InnovationMonitor. Memory: 220 KiB for 16 states, 8 channels, 8 late
/// periods, 7 counts of ducts; no heap.
class KalmanFilter {
 public:
  /// Settings that pass EstimatorEquations::check(); `gains` is room for the construction and may be forgotten.
  KalmanFilter(const EstimatorEquations& equations, SteadyGains& gains, double period);

  /// The first state that no gain holds, with the number of open ducts; both −1: none. Then the filter is of no use.
  struct Unobservable {
    int state = -1, open = -1;
  };
  [[nodiscard]] const Unobservable& unobservable() const { return unobservable_; }

  /// One period: the samples that were read at `now`; bit i of `bad`: channel i is not to be used.
  void step(const hal::Frame& frame, std::uint32_t bad, hal::Time now);
  /// The ducts that are open from this instant on; before the first step: from the beginning.
  void switch_to(hal::Openings open);

  /// Forgets everything but its constants.
  void restart();

  [[nodiscard]] const EstimatorVector& state() const { return newest_.x; }
  [[nodiscard]] double wheel_load() const { return dot(wheel_load_row_, newest_.x); }              ///< true F_w [N]
  [[nodiscard]] double foot_point_velocity() const { return dot(foot_velocity_row_, newest_.x); }  ///< [m/s]
  [[nodiscard]] double core(int entry) const {  ///< model::CoreIndex; 0 without that state
    const int i = core_[static_cast<std::size_t>(entry)];
    return i < 0 ? 0.0 : newest_.x(i);
  }
  /// Σ ν² of the anchor's last period and how many innovations that were.
  [[nodiscard]] double nis() const { return nis_; }
  [[nodiscard]] int innovations() const { return innovation_count_; }
  [[nodiscard]] double innovation(int channel) const { return innovation_[static_cast<std::size_t>(channel)]; }
  /// Of the channel's last sample: what was expected of it, in terms of its deviation(), which is √s [unit of the channel].
  [[nodiscard]] double expected(int channel) const { return expected_[static_cast<std::size_t>(channel)]; }
  [[nodiscard]] double deviation(int channel) const { return deviation_[static_cast<std::size_t>(channel)]; }
  [[nodiscard]] const InnovationMonitor& monitor() const { return monitor_; }
  [[nodiscard]] std::uint32_t too_old() const { return too_old_; }  ///< samples
  /// Periods since the start in which the road moved otherwise than described: (5).
  [[nodiscard]] std::uint64_t wide_periods() const { return wide_periods_; }
  [[nodiscard]] int longest_lag() const { return longest_lag_; }

 private:
  struct PerCount {
    EstimatorMatrix transition;
    EstimatorMatrix linear, noise;  ///< Φ_n, Q_n of (4)
    model::Block<double, estimator_states, 4> losses;
    model::Block<double, estimator_states, 2> actuator;
    std::array<std::array<EstimatorVector, 3>, estimator_channels> rows;  ///< c, c A, ½ c A²
    std::array<EstimatorMatrix, SteadyGains::lags> priors;                ///< P by lag
  };
  struct Estimate {
    EstimatorVector x = EstimatorVector::Zero();
    model::DuctFlows<double> ducts{};
  };
  struct Slot {
    hal::Openings open{};
    double actuator = 0.0;
    std::array<double, estimator_channels> value{}, offset{};  ///< offset: δ [s]
    std::array<bool, estimator_channels> there{};
  };

  [[nodiscard]] double dot(const EstimatorVector& a, const EstimatorVector& b) const;
  [[nodiscard]] static int count(hal::Openings open) {
    return model::count(static_cast<model::OpenDucts>(open.bits()));
  }
  [[nodiscard]] Slot& slot(int lag);
  void push(double actuator);
  void move_anchor();
  void place(const hal::Frame& frame, std::uint32_t bad, hal::Time now);
  void advance(Estimate& estimate, const Slot& from, const Slot& to) const;
  void predict_covariance(const Slot& from);
  void describe_jumps(const EstimatorEquations& equations, const EstimatorMatrix& stationary);
  [[nodiscard]] double expected_jumps() const;
  void add_jumps(EstimatorMatrix& p, double factor) const;
  /// (5) for a channel with this innovation, expected with this variance: what P and `projected` = P c gain. Returns a.
  double widen(std::size_t channel, double innovation, double variance, EstimatorMatrix& p,
               EstimatorVector& projected) const;
  /// The samples of one channel after the other; `p`: P before them, and after them.
  void correct(EstimatorVector& x, EstimatorMatrix& p, const Slot& at, InnovationMonitor* monitor);

  int states_, channels_, longest_lag_;
  double period_;
  model::DuctFlows<double>::Step flow_step_{};
  std::array<int, model::core_states> core_{};
  std::array<std::size_t, estimator_channels> channel_{};
  std::array<double, estimator_channels> gain_{}, offset_{}, delay_{};  ///< of the sensors
  std::array<double, estimator_channels> variance_{}, feedthrough_{};   ///< r², of F_act
  std::array<PerCount, SteadyGains::counts> by_count_{};
  EstimatorVector wheel_load_row_, foot_velocity_row_;
  EstimatorMatrix jumps_;                                         ///< J of (5)
  std::array<EstimatorVector, estimator_channels> jumps_seen_{};  ///< J c
  std::array<double, estimator_channels> jumps_variance_{};       ///< cᵀ J c; 0: no sensor of the foot point
  double expected_jumps_ = 0.0;                                   ///< a of (5) when the road last jumped
  int wide_left_ = 0;                                             ///< periods
  std::uint64_t wide_periods_ = 0;
  Unobservable unobservable_{};
  InnovationMonitor monitor_;

  bool started_ = false;
  hal::Time last_{};
  std::array<hal::Time, estimator_channels> last_taken_{};
  std::array<Slot, SteadyGains::lags + 1> slots_{};
  int newest_slot_ = 0;
  hal::Openings first_open_{};  ///< of the first instant
  Estimate anchor_{}, newest_{};
  EstimatorMatrix covariance_ = EstimatorMatrix::Zero();  ///< P of the anchor, after its samples
  EstimatorMatrix work_1_, work_2_;                       ///< not on the stack of a board
  double nis_ = 0.0;
  int innovation_count_ = 0;
  std::array<double, estimator_channels> innovation_{}, expected_{}, deviation_{};
  std::uint32_t too_old_ = 0;
};

}  // namespace firmware
