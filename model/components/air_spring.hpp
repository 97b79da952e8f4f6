// Air spring with active area.
#pragma once

#include "model/components/air_spring_parameters.hpp"
#include "model/components/subsystems.hpp"
#include "model/numerics/elementary.hpp"
#include "model/numerics/exact_discretisation.hpp"
#include "model/numerics/inline.hpp"
#include "model/numerics/select.hpp"

namespace model {

namespace gas {

inline constexpr double smallest = 0.25, largest = 4.0;  ///< v is kept within: beyond, no bellows keeps its shape

/// v^a for v in 0.25 … 4 and |a| ≤ 1:
///
///   ln v = n ln 2 + 2 artanh z,  z = (x − 1)/(x + 1),  x = v/2ⁿ in 0.75 … 1.5;   v^a = Σ (a ln v)^k/k!
///
/// |z| ≤ 0.2: eleven terms leave 4e-18; |a ln v| ≤ 1.39: powers up to the twentieth leave 8e-17. Rounding: 2e-15
/// relative.
template <class S>
[[nodiscard]] constexpr S power(S v, S a) {
  constexpr double ln2 = 0.6931471805599453;
  S x = v, whole = S(0);
  for (int i = 0; i < 2; ++i) {
    const auto above = x > S(1.5), below = x < S(0.75);
    whole += select(above, S(ln2), select(below, S(-ln2), S(0)));
    x *= select(above, S(0.5), select(below, S(2), S(1)));
  }
  const S z = (x - S(1)) / (x + S(1)), square = z * z;
  S series = S(1.0 / 21.0);
  for (int n = 19; n > 0; n -= 2) series = series * square + S(1.0 / n);
  const S y = a * (whole + S(2) * z * series);
  S sum = S(1);
  for (int n = 20; n > 0; --n) sum = S(1) + sum * y * S(1.0 / n);
  return sum;
}

}  // namespace gas

/// One or two bellows of gas between body and wheel, whose area an actuator changes.
///
///   (1)  F = (p₁ − p_a) A₁ − (p₂ − p_a) A₂ − F₀            F₀: its value at rest; second bellows: single without
///   (2)  A₁ = A (1 + u) + A′ s,   V₁ = V − A (1 + u) s − ½ A′ s² + V_u u        ∂V₁/∂s = −A₁
///   (3)  A₂ = A₂₀ (1 − u),        V₂ = V₂₀ + A₂ s − V_u u V₂₀/V                 ∂V₂/∂s = +A₂
///   (4)  p = p₀ g v^−κ,  v = V/V₀                          g: 1 on the adiabat of the state at rest
///   (5)  T ġ = μ v^(κ−1) − g                               heat to walls of constant temperature
///        ġ += κ v^(κ−1) θ μ̇                                mass μ = m/m₀; θ: its temperature, 1 for what comes in
///   (6)  u̇ = ω_a (u_c − u)   or   ü = ω_a² (u_c − u) − 2 ζ ω_a u̇;   |u| ≤ u_max, |u̇| ≤ r
///   (7)  u_c = −c_sky ż_b/k_u
///   (8)  μ̇ = r_l clamp((s_l ∓ z_l)/z_l, ±1) outside ±z_l,  T_l ṡ_l = s − s_l     levelling, first bellows
///        μ̇ −= leak p/p₀                                                          leak: choked flow
///
/// (5) is the first law of an ideal gas, (p V)˙ = −(κ − 1) p V̇ + (μ p₀V₀ − p V)/T, written for g, in which it is
/// linear. Small motions: F/s = k − k_r/(1 + sT): a Maxwell branch of stiffness k_r = (κ − 1) p₀A²/V; largest loss
/// angle atan((κ − 1)/(2√κ)) = 9.6° at √(1/κ)/(2πT).
///
///   (9)  k   = κ p₀A²/V + (p₀ − p_a) A′                    adiabatic
///   (10) k_u = (p₀ − p_a) A − κ p₀ A V_u/V                  second bellows: adds its own terms to (9), (10)
///
/// s: compression [m]; u: relative change of the area; v is kept within 0.25 … 4. A step is exact for V^(κ−1) that goes
/// straight through it and a held u_c; (6)'s limits act at its end. Source: (1)–(4), (9), (10) ideal gas; (5) Pelz and
/// Buttenbender, The dynamic stiffness of an air-spring, ISMA 2004.
template <class S>
class AirSpring {
 public:
  using Parameters = AirSpringParameters<S, true>;

  struct Bellows {
    S excess{};  ///< g − 1
    S target{};  ///< μ v^(κ−1) − 1 at this instant
  };
  struct State {
    Bellows first{}, second{};
    S mass{};          ///< μ − 1 of the first bellows
    S levelled{};      ///< s_l [m]
    S area{}, rate{};  ///< u, u̇ [1/s]
    S command{};       ///< u_c
    S at{};            ///< s of this state [m]
    S force{};         ///< F less the linear part k s [N]
  };

  AirSpring() = default;
  AirSpring(const Parameters& parameters, const AirSpringCondition<S>& changed, S period)
      : p_(parameters), changed_(changed), period_(period), kappa_(changed.polytropic_exponent) {
    pressure_ = p_.pressure + p_.ambient_pressure;
    counter_pressure_ = p_.counter_pressure + p_.ambient_pressure;
    double_ = p_.counter_area > S(0);
    stiffness_ = stiffness(p_, kappa_);
    heat_ = lag(p_.heat_time, period);
    level_ = lag(p_.levelling_time, period);
    mass_step_ = p_.levelling_rate * period;
    leak_step_ = changed.leak * period;
    constexpr double two_pi = 6.283185307179586;
    const S omega = S(two_pi) * p_.actuator_frequency;
    area_step_ = p_.actuator_rate > S(0) ? p_.actuator_rate * period : S(1);
    if (p_.actuator_damping > S(0)) {
      Block<S, 2, 2> a;
      a << S(0), S(1), S(-omega * omega), S(-2) * p_.actuator_damping * omega;
      const ExactDiscretisation<S, 2> exact(a, period);
      const Block<S, 2, 2>& e = exact.transition();
      const Column<S, 2> held = exact.held(Column<S, 2>(S(0), omega * omega));
      move_ = {e(0, 0), e(0, 1), e(1, 0), e(1, 1), held(0), held(1)};
    } else {
      const S kept = decaying(omega * period);
      move_ = {kept, S(0), S(0), S(0), S(1) - kept, S(0)};
    }
    area_per_velocity_ = p_.skyhook > S(0) ? -p_.skyhook / force_per_area(p_, kappa_) : S(0);
  }

  /// (9) [N/m]
  [[nodiscard]] static S stiffness(const Parameters& p, S kappa) {
    const S absolute = p.pressure + p.ambient_pressure, counter = p.counter_pressure + p.ambient_pressure;
    S k = kappa * absolute * p.area * p.area / p.volume + p.pressure * p.area_per_stroke;
    if (p.counter_area > S(0)) k += kappa * counter * p.counter_area * p.counter_area / p.counter_volume;
    return k;
  }
  /// (10) [N]
  [[nodiscard]] static S force_per_area(const Parameters& p, S kappa) {
    const S absolute = p.pressure + p.ambient_pressure, counter = p.counter_pressure + p.ambient_pressure;
    S k = p.pressure * p.area - kappa * absolute * p.area * p.volume_per_area / p.volume;
    if (p.counter_area > S(0)) {
      k += p.counter_pressure * p.counter_area - kappa * counter * p.counter_area * p.volume_per_area / p.volume;
    }
    return k;
  }
  /// k_r, stiffness of the Maxwell branch of the heat [N/m]
  [[nodiscard]] static S heat_stiffness(const Parameters& p, S kappa) {
    return stiffness(p, kappa) - stiffness(p, S(1));
  }
  /// (p₀ − p_a) A of both bellows: the load that it carries at rest [N]
  [[nodiscard]] static S load(const Parameters& p) { return p.pressure * p.area - p.counter_pressure * p.counter_area; }

  [[nodiscard]] S stiffness() const { return stiffness_; }
  /// (7), within the stroke.
  [[nodiscard]] S skyhook(S body_velocity) const {
    return within(area_per_velocity_ * body_velocity, p_.actuator_stroke);
  }
  [[nodiscard]] bool has_skyhook() const { return p_.skyhook > S(0); }

  /// At a deflection, where the gas has the walls' temperature (`settled`) or is on the adiabat of the state at rest.
  [[nodiscard]] State start(S deflection, bool settled) const {
    State x;
    x.at = x.levelled = deflection;
    if (changed_.stuck) x.area = changed_.stuck_at;
    const Geometry now = geometry(deflection, x.area);
    x.first.target = now.first.root - S(1);
    if (double_) x.second.target = now.second.root - S(1);
    if (settled) {
      x.first.excess = x.first.target;
      x.second.excess = x.second.target;
    }
    x.force = force(x, now) - stiffness_ * deflection;
    return x;
  }

  /// One period, in which the deflection goes to `deflection`; the command is held.
  RIGTWIN_INLINE void step(State& x, S deflection) const {
    move_area(x);
    move_mass(x, deflection);
    x.at = deflection;
    const Geometry now = geometry(deflection, x.area);
    exchange(x.first, S(1) + x.mass, now.first.root);
    if (double_) exchange(x.second, S(1), now.second.root);
    x.force = force(x, now) - stiffness_ * deflection;
  }

  /// p₁, p₂ absolute [Pa]
  [[nodiscard]] S pressure(const State& x) const {
    return pressure_of(pressure_, x.first.excess, geometry(x.at, x.area).first);
  }
  [[nodiscard]] S counter_pressure(const State& x) const {
    return double_ ? pressure_of(counter_pressure_, x.second.excess, geometry(x.at, x.area).second) : S(0);
  }
  /// V₁, V₂ [m³]
  [[nodiscard]] S volume(const State& x) const { return geometry(x.at, x.area).first.volume * p_.volume; }
  [[nodiscard]] S counter_volume(const State& x) const {
    return double_ ? geometry(x.at, x.area).second.volume * p_.counter_volume : S(0);
  }
  /// (1) [N]
  [[nodiscard]] S total_force(const State& x) const { return x.force + stiffness_ * x.at; }

  /// Values that have decayed below `least` become zero.
  void flush(State& x, S least) const {
    for (S* value : {&x.first.excess, &x.first.target, &x.second.excess, &x.second.target, &x.mass, &x.levelled,
                     &x.area, &x.rate, &x.command, &x.at, &x.force}) {
      *value = select(*value<least&& * value> - least, S(0), *value);
    }
  }

 private:
  /// y of T ẏ = w − y after a period in which w goes straight from w₀ to w₁: w₁ − ramp (w₁ − w₀) + kept (y₀ − w₀)
  struct Lag {
    S kept{}, ramp{};
    [[nodiscard]] RIGTWIN_INLINE S after(S y, S from, S to) const {
      return to - ramp * (to - from) + kept * (y - from);
    }
  };
  struct Chamber {
    S area{};    ///< A [m²]
    S volume{};  ///< v
    S root{};    ///< v^(κ−1)
  };
  struct Geometry {
    Chamber first{}, second{};
  };
  struct Actuator {
    S position_by_position{}, position_by_rate{}, rate_by_position{}, rate_by_rate{}, position{}, rate{};
  };

  [[nodiscard]] static Lag lag(S time_constant, S period) {
    const ExactDiscretisation<S, 1> exact(Block<S, 1, 1>(S(-1) / time_constant), period);
    return {exact.transition()(0), exact.held(Column<S, 1>(S(1)))(0) / period};
  }
  [[nodiscard]] RIGTWIN_INLINE static S within(S value, S limit) {
    return select(value > limit, limit, select(value < -limit, S(-limit), value));
  }
  [[nodiscard]] RIGTWIN_INLINE Chamber chamber(S area, S volume) const {
    const S v =
        select(volume < S(gas::smallest), S(gas::smallest), select(volume > S(gas::largest), S(gas::largest), volume));
    return {area, v, gas::power(v, S(kappa_ - S(1)))};
  }
  /// (2), (3)
  [[nodiscard]] RIGTWIN_INLINE Geometry geometry(S s, S u) const {
    const S area = p_.area * (S(1) + u), grown = p_.volume_per_area * u / p_.volume;
    Geometry g{.first = chamber(area + p_.area_per_stroke * s,
                                S(1) + grown - (area + S(0.5) * p_.area_per_stroke * s) * s / p_.volume)};
    if (double_) {
      const S counter = p_.counter_area * (S(1) - u);
      g.second = chamber(counter, S(1) - grown + counter * s / p_.counter_volume);
    }
    return g;
  }
  /// (4)
  [[nodiscard]] RIGTWIN_INLINE static S pressure_of(S at_rest, S excess, const Chamber& c) {
    return at_rest * (S(1) + excess) / (c.volume * c.root);
  }
  /// (5) without mass flow
  RIGTWIN_INLINE void exchange(Bellows& b, S mass, S root) const {
    const S target = mass * root - S(1);
    b.excess = heat_.after(b.excess, b.target, target);
    b.target = target;
  }
  /// (1)
  [[nodiscard]] RIGTWIN_INLINE S force(const State& x, const Geometry& g) const {
    S f = (pressure_of(pressure_, x.first.excess, g.first) - p_.ambient_pressure) * g.first.area -
          (pressure_ - p_.ambient_pressure) * p_.area;
    if (double_) {
      f -= (pressure_of(counter_pressure_, x.second.excess, g.second) - p_.ambient_pressure) * g.second.area -
           (counter_pressure_ - p_.ambient_pressure) * p_.counter_area;
    }
    return f;
  }
  /// (6)
  RIGTWIN_INLINE void move_area(State& x) const {
    if (changed_.stuck) return;
    const S command = within(x.command, p_.actuator_stroke), before = x.area;
    const S area = move_.position_by_position * x.area + move_.position_by_rate * x.rate + move_.position * command;
    const S rate = move_.rate_by_position * x.area + move_.rate_by_rate * x.rate + move_.rate * command;
    const S moved = within(area - before, area_step_);
    const auto limited = moved < area - before || moved > area - before;
    x.area = within(before + moved, p_.actuator_stroke);
    const auto stopped = limited || x.area >= p_.actuator_stroke || x.area <= -p_.actuator_stroke;
    x.rate = select(stopped, S((x.area - before) / period_), rate);
  }
  /// (8); what comes or goes carries its enthalpy.
  RIGTWIN_INLINE void move_mass(State& x, S deflection) const {
    x.levelled = level_.after(x.levelled, x.at, deflection);
    if (!(mass_step_ > S(0)) && !(leak_step_ > S(0))) return;
    const S band = p_.levelling_band, beyond = within((absolute(x.levelled) - band) / band, S(1));
    const S pumped = select(beyond > S(0), S(mass_step_ * beyond), S(0));
    const S wanted = select(x.levelled < S(0), S(-pumped), pumped);
    const S mass = S(1) + x.mass, on_adiabat = S(1) + x.first.excess;
    const Chamber c = geometry(x.at, x.area).first;
    const S own = on_adiabat / mass;  // v^(κ−1) θ of the gas inside
    const S lost = leak_step_ * on_adiabat / (c.volume * c.root) + select(wanted < S(0), S(-wanted), S(0));
    const S gained = select(wanted > S(0), wanted, S(0));
    x.first.excess += kappa_ * (gained * c.root - lost * own);
    x.mass += gained - lost;
  }

  Parameters p_{};
  AirSpringCondition<S> changed_{};
  S period_{1};
  S kappa_{};
  S pressure_{}, counter_pressure_{};  ///< absolute, at rest [Pa]
  S stiffness_{};                      ///< (9) [N/m]
  S area_per_velocity_{};              ///< of (7) [s/m]
  S mass_step_{}, leak_step_{};        ///< of a period
  S area_step_{};                      ///< highest |Δu| of a period
  Lag heat_{}, level_{};
  Actuator move_{};
  bool double_ = false;
};

}  // namespace model
