// The test machine behind its delay.
#pragma once

#include "model/components/subsystems.hpp"
#include "model/numerics/exact_discretisation.hpp"
#include "model/numerics/motion.hpp"
#include "model/numerics/select.hpp"

namespace model {

/// Dynamics of the machine path behind its delay: lag → resonance → rate limit.
///
///   (1)  T ẋ₁ + x₁ = u                              lag; x₁ = u without it
///   (2)  ẍ₂ + 2ζω ẋ₂ + ω² x₂ = ω² x₁,  ω = 2πf      resonance; x₂ = x₁ without it
///   (3)  x_act(k+1) = x_act(k) + clamp(x₂(k+1) − x_act(k), ± (v h − d)),  d = (v − ẋ_act)² h / 2(ẋ₂ − ẋ_act)
///
/// (1), (2) are exact for an input that moves on the cubic between two samples.
///
/// The correction d belongs to a step that begins below the limit, ẋ_act < v, and ends above it, ẋ₂ > v, while the
/// velocity grows evenly (mirrored below −v; 0 in all other steps). Without d the machine would be ahead by up to ẍ
/// h²/2 until it has caught up; with d it is ahead by h³ times the third derivative. A step in which the machine at its
/// limit meets a target that comes towards it faster than v goes up until they meet and down from there. The velocity
/// given by (3) is that of x₂ while the machine does not limit, ± v while it does. State 3×1 [x₁ m, x₂ m, ẋ₂ m/s]
/// (Machine::Index); input u: delayed command, position and velocity; output: position and velocity.
template <class S>
class Machine {
 public:
  enum Index : int { lagged, position, velocity };  ///< x₁, x₂, ẋ₂
  static constexpr int states = 3;
  using State = Column<S, states>;

  Machine() = default;
  Machine(const MachinePath<S>& path, S period) : path_(path), period_(period) {
    omega_ = S(2) * S(3.141592653589793) * path.resonance_frequency;
    if (!linear()) return;
    Block<S, states, states> a;
    for (int j = 0; j < states; ++j) a.col(j) = rates(State::Unit(j), S(0));
    const ExactDiscretisation<S, states> exact(a, period);
    transition_ = exact.transition();
    input_ = exact.hermite(rates(State::Zero(), S(1)), State::Zero());
  }

  /// Whether the machine is more than a delay.
  [[nodiscard]] bool any() const { return linear() || same(path_.rate_limit > S(0)); }
  [[nodiscard]] bool has_lag() const { return same(path_.lag > S(0)); }
  [[nodiscard]] bool has_resonance() const { return same(omega_ > S(0)); }
  [[nodiscard]] bool linear() const { return has_lag() || has_resonance(); }

  /// (1), (2)
  [[nodiscard]] State rates(const State& x, S u) const {
    State rate = State::Zero();
    if (has_lag()) rate(lagged) = (u - x(lagged)) / path_.lag;
    if (has_resonance()) {
      const S in = has_lag() ? x(lagged) : u;
      rate(position) = x(velocity);
      rate(velocity) = omega_ * (omega_ * (in - x(position)) - S(2) * path_.resonance_damping * x(velocity));
    }
    return rate;
  }

  /// x₂ of (1), (2), with its velocity.
  [[nodiscard]] Stroke<S> output(const State& x, const Stroke<S>& in) const {
    if (has_resonance()) return {x(position), x(velocity)};
    if (has_lag()) return {x(lagged), (in.position - x(lagged)) / path_.lag};
    return in;
  }

  /// At rest, or moving along with its input.
  [[nodiscard]] State start(const Stroke<S>& in) const {
    State x;
    x(lagged) = x(position) = in.position - in.velocity * path_.lag;
    x(velocity) = in.velocity;
    if (has_resonance()) x(position) -= S(2) * path_.resonance_damping / omega_ * in.velocity;
    return x;
  }

  /// One period with the input going from `before` to `now`; `reached`: x_act at its start. Returns it at its end.
  [[nodiscard]] Stroke<S> step(State& x, const Stroke<S>& before, const Stroke<S>& now,
                               const Stroke<S>& reached) const {
    if (linear()) {
      State next = input_.col(0) * before.position;
      next += input_.col(1) * before.velocity;
      next += input_.col(2) * now.position;
      next += input_.col(3) * now.velocity;
      for (int j = 0; j < states; ++j) next += transition_.col(j) * x(j);
      x = next;
    }
    Stroke<S> out = output(x, now);
    if (same(path_.rate_limit > S(0))) {
      const S distance = out.position - reached.position;
      const S up = longest_distance(reached.velocity, out.velocity);
      const S down = longest_distance(-reached.velocity, -out.velocity);
      const S turn_down = turning(reached.velocity, out.velocity, distance);
      const S turn_up = turning(-reached.velocity, -out.velocity, -distance);
      const Stroke<S> downwards{reached.position - down, -path_.rate_limit};
      const Stroke<S> upwards{reached.position + up, path_.rate_limit};
      const Stroke<S> turned_up{reached.position - path_.rate_limit * (S(2) * turn_up - period_), path_.rate_limit};
      const Stroke<S> turned_down{reached.position + path_.rate_limit * (S(2) * turn_down - period_),
                                  -path_.rate_limit};
      out = select(distance < -down, downwards, out);
      out = select(distance > up, upwards, out);
      out = select(turn_up > S(0), turned_up, out);
      out = select(turn_down > S(0), turned_down, out);
    }
    return out;
  }

 private:
  /// A machine that goes up at its limit meets a target that comes down faster than the limit; from there it goes down
  /// at its limit. The time of the meeting from the start of the step [s]; 0: they do not meet.
  [[nodiscard]] S turning(S before, S after, S distance) const {
    const S v = path_.rate_limit;
    const auto towards = before == v && after < -v;
    if (!any_lane(towards)) return S(0);
    const S met = (distance - after * period_) / (v - after);
    return select(towards && met > S(0) && met < period_, met, S(0));
  }

  /// v h − d
  [[nodiscard]] S longest_distance(S before, S after) const {
    const S v = path_.rate_limit, most = v * period_;
    const auto passes = before < v && after > v;
    if (!any_lane(passes)) return most;
    return select(passes, S(most - (v - before) * (v - before) * period_ / (S(2) * (after - before))), most);
  }

  MachinePath<S> path_{};
  S period_{1};
  S omega_{};
  Block<S, states, states> transition_ = Block<S, states, states>::Zero();
  Block<S, states, 4> input_ = Block<S, states, 4>::Zero();
};

}  // namespace model
