// A damping between wheel and body of the computed car, against the energy that a late interface feeds.
#pragma once

#include "firmware/loop/compensation/settings.hpp"

namespace firmware::compensation {

/// Adds a force b ẋ to the measured one.
///
/// virtual_damping: b constant. It takes out of the mode at ω what the delay feeds into it if b = (k/ω) sin ωτ; other
/// modes are damped too, and the component under test seems to have this damping.
/// adaptive_virtual_damping: only as long as the interface has fed more than the damper took,
///
///   (1)  W ← λ W − f (x⁺ − x),   D ← λ D + b (x⁺ − x)²/h,   λ = 1 − h/energy_memory
///   (2)  b grows by b_max h/damping_time a period while W > D, and falls by as much otherwise; within 0 … b_max
///
/// with f and x without their means, as EnergyGuard has them. A passive component takes energy: W < 0, b = 0.
/// Source: Osaki et al., HILS with delay compensation, 2010; (1) the passivity observer of Hannaford and Ryu,
/// Time-domain passivity control of haptic interfaces, IEEE Trans. Robotics and Automation 2002.
class InterfaceDamper {
 public:
  struct State {
    double damping = 0.0;  ///< b [N s/m]
    double fed = 0.0;      ///< W [J]
    double taken = 0.0;    ///< D [J]
    double mean_force = 0.0, mean_position = 0.0, position = 0.0;
  };

  InterfaceDamper(const Settings& settings, double period)
      : adaptive_(settings.kind == Kind::adaptive_virtual_damping),
        most_(settings.damping),
        period_(period),
        memory_(1.0 - period / settings.energy_memory),
        step_(settings.damping * period / settings.damping_time) {}

  void start(State& x, double position) const {
    x = {};
    x.mean_position = position;
    x.damping = adaptive_ ? 0.0 : most_;
  }

  /// The force measured at t_k and held until t_{k+1} [N], the wanted deflection at t_{k+1} [m].
  void step(State& x, double force, double position) const {
    if (!adaptive_) return;
    x.mean_force += (1.0 - memory_) * (force - x.mean_force);
    x.mean_position += (1.0 - memory_) * (position - x.mean_position);
    const double offset_free = position - x.mean_position;
    const double way = offset_free - x.position;
    x.position = offset_free;
    x.fed = memory_ * x.fed - (force - x.mean_force) * way;
    x.taken = memory_ * x.taken + x.damping * (way * way) / period_;
    x.damping += x.fed > x.taken ? step_ : -step_;
    if (x.damping < 0.0) x.damping = 0.0;
    if (x.damping > most_) x.damping = most_;
  }

  [[nodiscard]] double force(const State& x, double velocity) const { return x.damping * velocity; }

 private:
  bool adaptive_;
  double most_, period_, memory_, step_;
};

}  // namespace firmware::compensation
