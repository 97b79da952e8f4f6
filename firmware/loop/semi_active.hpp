// Kalman filter and duct policy beside the control loop.
#pragma once

#include <optional>

#include "firmware/loop/companion.hpp"
#include "firmware/loop/duct_control/duct_policy.hpp"
#include "firmware/loop/guards/innovation_guard.hpp"
#include "firmware/loop/kalman/kalman_filter.hpp"

namespace firmware {

/// Velocities and wheel load from the filter, ducts from the policy. Both know where late valves stand. What a sensor
/// shows against all others ends a run (InnovationGuard).
class SemiActive final : public Companion {
 public:
  /// Settings that pass EstimatorEquations::check() and DuctPolicy::check(); `gains` is room for the construction. A
  /// rig without FDVA has no policy.
  SemiActive(const EstimatorEquations& equations, SteadyGains& gains, const DuctPolicySettings& policy, double period,
             const Supervision& supervision)
      : filter_(equations, gains, period), guard_(supervision, equations, period) {
    if (equations.ducts() > 0) policy_.emplace(equations, gains, policy, period);
  }

  [[nodiscard]] const KalmanFilter& filter() const { return filter_; }
  [[nodiscard]] Velocities velocities() const override {
    const double wheel = filter_.core(model::CoreIndex::wheel_velocity);
    const double body = filter_.core(model::CoreIndex::body_velocity);
    return {filter_.foot_point_velocity(), wheel, body, wheel - body};
  }
  [[nodiscard]] double wheel_load() const override { return filter_.wheel_load(); }
  [[nodiscard]] hal::Openings standing() const override { return policy_ ? policy_->standing() : hal::Openings{}; }

 private:
  void do_restart() override {
    filter_.restart();
    filter_.switch_to({});
  }
  void do_follow(const SampleGuard& samples, hal::Time now) override {
    filter_.step(samples.frame(), samples.bridged(), now);
  }
  std::optional<Trip> do_look(bool runs, hal::Time now) override {
    if (runs) return guard_.follow(filter_, now);
    guard_.start();
    return std::nullopt;
  }
  hal::Openings do_choose(hal::Openings planned) override {
    return policy_ ? policy_->choose(filter_.state(), planned) : planned;
  }
  void do_opened(hal::Openings openings) override {
    if (!policy_) return;
    policy_->told(openings);
    filter_.switch_to(policy_->standing());
  }

  KalmanFilter filter_;
  InnovationGuard guard_;
  std::optional<DuctPolicy> policy_{};
};

}  // namespace firmware
