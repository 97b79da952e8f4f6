// The drive that makes the model follow a target: Gauss–Newton along the trajectory.
#pragma once

#include <functional>
#include <vector>

#include "host_sim/replicate/drive_limits.hpp"
#include "host_sim/replicate/stepped_rig.hpp"
#include "host_sim/replicate/target.hpp"

namespace host_sim::replicate {

/// A target channel as a tracking sees it.
struct TrackedChannel {
  FrequencyBand band;
  double weight;  ///< w_c [1/unit²]
};

/// Costs of the drive itself: what keeps it from running away where the target says nothing.
struct DriveCost {
  double position = 0.0;      ///< ρ_p [1/m²]
  double acceleration = 0.0;  ///< ρ_w [s⁴/m²]
};

/// Costs of a sample beyond a limit, half of them times the square of the excess.
struct LimitCost {
  double position = 0.0, speed = 0.0, acceleration = 0.0, force = 0.0;
};

/// Non-linear least squares over the accelerations w_k of the drive, with limits as constraints:
///
///   (1)  J = Σ_k ½ Σ_c w_c o_ck² + ½ ρ_p p_k² + ½ ρ_w w_k²,   o_c = B_c(q) (t_c − y_c)
///   (2)  |p_k| ≤ S,  |v_k| ≤ V,  |w_k| ≤ A,  |F_k| ≤ F_max
///
/// B_c: Butterworth high-pass and low-pass of fourth order at the edges of the band; y: the one step function. With
/// s = [rig, p, v, filters], each iteration linearises the step along the trajectory, s' = A s + B w, and solves the
/// linear least squares exactly by dynamic programming, from the end to the beginning:
///
///   (3)  Q_ww = BᵀPB + R,  Q_wx = BᵀPA + S,  Q_w = Bᵀq + r
///   (4)  K = −Q_wx/Q_ww,  κ = −Q_w/Q_ww,  P ← Q_xx − Q_wxᵀ Q_wx/Q_ww,  q ← Q_x − Q_wxᵀ Q_w/Q_ww
///
/// (4) run on the linear form gives the step δw_k, δs_k. Then the rig itself runs forward with
/// w_k + α δw_k + L (s_k − s̄_k − α δs_k), L the feedback of lead_by(): it keeps a step that a corner spoils from spoiling
/// what follows. α is chosen piece by piece: that of the least cost of the piece and of the next
/// thresholds::pieces_ahead. So a hard knock costs its own piece a shorter step, and no other.
///
/// (2) by the augmented Lagrangian: of each limited signal x the cost ½ σ (x + m − clamp(x + m))², and m ← its excess
/// after an iteration.
///
/// Work and memory are linear in the length. Sources: D. Q. Mayne, Int. J. Control 3 (1966), 85–95; W. Li, E. Todorov,
/// ICINCO 2004 (iterative LQR); T. Howell et al., IROS 2019 (its augmented Lagrangian). The choice of α by pieces is ours.
class Tracking {
 public:
  /// `rig` reads the channels of the target and, as the last, the force that is limited.
  /// They cost nothing until charge().
  Tracking(SteppedRig& rig, double period, std::vector<TrackedChannel> channels, const DriveCost& cost,
           const DriveLimits& limits);

  /// Starts with the drive that goes along these positions.
  void begin(const std::vector<double>& positions, const std::vector<std::vector<double>>& target);
  /// Another target, from where it is.
  void retarget(const std::vector<std::vector<double>>& target);
  /// Goes on with another rig of the same kind: with the same drive, or (`led`) led along the same motion by the
  /// feedback of lead_by().
  void exchange(SteppedRig& rig, bool led);
  /// Takes the feedback that leads the rig along a motion from this rig at rest, without corners.
  void lead_by(SteppedRig& linear);
  /// One iteration; by how much it lowers the best cost, relative to it.
  double iterate();
  /// From now on limits cost this; {}: nothing.
  void charge(const LimitCost& cost);
  /// Moves the multipliers of the limits on.
  void update_multipliers();

  [[nodiscard]] double cost() const { return cost_; }
  /// p_k of the best drive.
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }
  /// Channels of the last run, without the force.
  [[nodiscard]] const std::vector<std::vector<double>>& answer() const { return answer_; }
  /// √ of Σ_c w_c of the mean of o²: of one channel with the weight 1, the relative error.
  [[nodiscard]] double error() const;
  /// Largest excess of a limit ÷ the limit.
  [[nodiscard]] double excess() const { return excess_; }

 private:
  struct Section {  ///< of second order: b₀ … b₂, a₁, a₂
    double b0, b1, b2, a1, a2;
  };
  struct Filter {
    std::vector<Section> sections;
    std::size_t first;          ///< of its states in s
    std::vector<double> input;  ///< how the newest error enters its states
    std::vector<double> at;     ///< where each of its states goes, by rows; the last row: its output
    double through;             ///< the newest error in the output
  };
  struct Multipliers {
    std::vector<double> position, speed, acceleration, force;
  };
  struct CostToGo {
    std::vector<double> p, q;
  };

  static std::vector<Section> sections_of(const FrequencyBand& band, double period);
  double filtered(const Filter& filter, double error, double* states) const;
  double stage(std::size_t k, const double* outputs, const double* s, double w, double& excess) const;
  [[nodiscard]] std::size_t pieces() const;
  /// Of the rig at the start of a piece: of the run that is deviated from (set_), and of the next.
  [[nodiscard]] std::size_t slot(unsigned set, std::size_t piece) const { return set * pieces() + piece; }
  void keep_step(std::size_t k, const LinearStep& step);
  void linear_run();
  void run_again(bool led);
  void accept();
  void keep_best();
  void begin_from_best();
  void prepare_backward();
  void backward();
  void add_own_cost(std::size_t k, CostToGo& go);
  void fill_step(const LinearStep& step);
  template <class Visit>
  void blocks_of_row(std::size_t row, const Visit& visit) const;
  void carry_back(const CostToGo& go);
  void add_output_cost(double f, double weight, double value);
  void back_step(std::size_t k, const LinearStep& step, CostToGo& go);
  double run_piece(std::size_t piece, double before, double alpha, std::vector<double>& s, double& excess);
  bool forward();
  /// Goes on from the run whose pieces cost so much, if it is not much worse than the best.
  bool take(const std::vector<double>& costs, double excess);
  [[nodiscard]] double best_share(std::size_t piece, double share, const std::vector<double>& start);
  void count_cost();

  SteppedRig* rig_;
  std::vector<bool> unused_;
  double h_;
  std::vector<TrackedChannel> channels_;
  DriveCost own_;
  DriveLimits limits_;
  LimitCost limit_cost_;
  std::vector<Filter> filters_;
  std::vector<std::vector<double>> target_, answer_, next_answer_;
  std::vector<double> positions_;
  std::size_t size_ = 0, n_ = 0, rig_states_ = 0, piece_ = 1;
  unsigned set_ = 0;
  // by step: w, K, κ, s before it and behind the last, outputs of the filters and force at its end
  std::vector<double> w_, gain_, feed_, s_, outputs_;
  std::vector<double> step_w_, step_s_, leading_;
  std::vector<float> a_of_, y_of_;
  std::vector<double> next_w_, next_s_, next_outputs_;
  std::vector<double> best_w_;
  double best_cost_ = 0.0;
  Multipliers multipliers_;
  double cost_ = 0.0, excess_ = 0.0, damping_ = 0.0;
  std::vector<double> a_, b_, pa_, qxx_, qx_, qwx_, error_row_;  // of one step backward
  double qww_ = 0.0, qw_ = 0.0;
};

}  // namespace host_sim::replicate
