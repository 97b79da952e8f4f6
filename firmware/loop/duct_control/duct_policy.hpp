// Decides which ducts are open.
#pragma once

#include <array>
#include <string_view>

#include "firmware/loop/duct_control/rollout.hpp"
#include "hal/valve_bank.hpp"

namespace firmware {

/// The policy of [valves]: from the states of a car to its open ducts, once a period.
///
///   force_velocity   all installed ducts while F_c ż_w > 0, else none (F_c = k_c (dz_b − y)): the spring of the
///   absorber
///                    is let go where it would push the wheel on
///   rollout          Rollout::best of the state at which the valves arrive
///
/// What both respect: after a switching the ducts stay for `dwell` (so at most 1/dwell switchings a second); closing is
/// put off while the pressure peak would be too high; the valves' delay is known: their places on the way are in
/// `queue`. Trips are the control loop's business: then the safe position is written, whatever a policy says.
class DuctPolicy {
 public:
  /// What makes settings unfit for a rig, or an empty text.
  [[nodiscard]] static std::string_view check(const DuctPolicySettings& settings,
                                              const model::RigParameters<double>& rig, double period);

  DuctPolicy(const EstimatorEquations& equations, SteadyGains& gains, const DuctPolicySettings& settings,
             double period);

  /// The ducts to be told to the valves now; `x` at this instant. `planned` where the policy is the plan.
  [[nodiscard]] hal::Openings choose(const EstimatorVector& x, hal::Openings planned);
  /// What the valves were told now.
  void told(hal::Openings openings);
  /// Where the valves stand from now on.
  [[nodiscard]] hal::Openings standing() const { return standing_; }
  [[nodiscard]] const Rollout& rollout() const { return rollout_; }

 private:
  [[nodiscard]] hal::Openings queued(int ahead) const;

  DuctPolicySettings settings_;
  Rollout rollout_;
  int ducts_, delay_, dwell_;
  int wheel_position_, wheel_velocity_, body_position_, piston_travel_, piston_velocity_;
  int since_switching_ = 0;
  bool started_ = false;
  hal::Openings last_{}, standing_{};
  std::array<hal::Openings, Rollout::longest_delay + 1> queue_{};  ///< told, by period, in a ring
  int newest_ = 0;
};

}  // namespace firmware
