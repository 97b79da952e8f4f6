// Shapes white noise into the motion of a foot point on a road.
#pragma once

#include <cmath>

#include "model/numerics/exact_discretisation.hpp"
#include "model/numerics/motion.hpp"
#include "model/numerics/require.hpp"

namespace model {

/// Shaping filter from white noise to the vertical motion of a foot point that travels over an ISO 8608 road.
///
///   (1)  ż₀ = −2π f_c z₀ + 2π n₀ √(G_d v) w                  road: G(f) = G_d n₀² v/(f² + f_c²), one-sided S_w = 1
///   (2)  p̈  = ω² (z₀ − p) − 2 cos(π/8) ω ṗ
///   (3)  z̈  = ω² (p − z) − 2 cos(3π/8) ω ż,   ω = 2π f_b     Butterworth low-pass, fourth order, −3 dB at f_b
///
/// Without (2), (3) the velocity would be white noise, which no wheel and no cylinder follows: the tyre's contact patch
/// averages over its length L (−3 dB at 0.44 v/L, about 100 Hz at 100 km/h), a servo-hydraulic cylinder
/// ends at about 40 Hz. Up to f_b/2 the spectrum is that of (1) within 0.4 %.
///
/// Noise: independent normal samples of variance 1/(2h), each held for a period h (S_w = 1 one-sided; a variance of 1/h
/// would be 3 dB too loud). State 5×1 [z₀ m, p m, ṗ m/s, z m, ż m/s] (RoadFilter::Index), exact
/// step.
/// Source: (1) ISO 8608:2016 class means with waviness 2; Hać, Suspension optimization of a 2-DOF vehicle model, 1985.
template <class S>
class RoadFilter {
 public:
  struct Parameters {
    S roughness;  ///< G_d(n₀) [m³], n₀ = 0.1 1/m
    S speed;      ///< v [m/s]
    S cut_off;    ///< f_c [Hz]: below it the spectrum is flat
    S bandwidth;  ///< f_b [Hz]
  };
  enum Index : int { road, contact, contact_velocity, foot_point, foot_point_velocity };  ///< z₀, p, ṗ, z, ż
  static constexpr int states = 5;
  using State = Column<S, states>;

  static constexpr double reference_wave_number = 0.1;  ///< n₀ [1/m]

  RoadFilter(const Parameters& p, S period)
      : omega_(S(2) * pi * p.bandwidth),
        gain_(S(2) * pi * S(reference_wave_number) * root(p.roughness * p.speed)),
        corner_(S(2) * pi * p.cut_off) {
    require(p.roughness >= S(0) && p.speed > S(0), "roughness and speed of a road");
    require(p.cut_off >= S(0) && p.bandwidth > S(0), "frequencies of a road filter");
    Block<S, states, states> a;
    for (int j = 0; j < states; ++j) a.col(j) = rates(State::Unit(j), S(0));
    const ExactDiscretisation<S, states> step(a, period);
    transition_ = step.transition();
    noise_ = step.held(rates(State::Zero(), S(1)));
  }

  /// (1)–(3)
  [[nodiscard]] State rates(const State& x, S w) const {
    State rate;
    rate(road) = gain_ * w - corner_ * x(road);
    rate(contact) = x(contact_velocity);
    rate(contact_velocity) =
        omega_ * (omega_ * (x(road) - x(contact)) - S(1.847759065022573) * x(contact_velocity));  // 2 cos(π/8)
    rate(foot_point) = x(foot_point_velocity);
    rate(foot_point_velocity) = omega_ * (omega_ * (x(contact) - x(foot_point)) -
                                          S(0.7653668647301796) * x(foot_point_velocity));  // 2 cos(3π/8)
    return rate;
  }

  /// One period with noise w [1/√Hz] held.
  [[nodiscard]] State step(const State& x, S w) const {
    State next = noise_ * w;
    for (int j = 0; j < states; ++j) next += transition_.col(j) * x(j);
    return next;
  }

  [[nodiscard]] Motion<S> motion(const State& x) const {
    return {x(foot_point), x(foot_point_velocity), rates(x, S(0))(foot_point_velocity)};
  }

 private:
  [[nodiscard]] static S root(S value) {
    using std::sqrt;
    return sqrt(value);
  }

  static constexpr S pi = S(3.141592653589793);
  S omega_, gain_, corner_;
  Block<S, states, states> transition_;
  State noise_;
};

}  // namespace model
