// The equations of a whole rig as one right-hand side.
#pragma once

#include "model/components/air_spring.hpp"
#include "model/components/fdva.hpp"
#include "model/components/quarter_car.hpp"
#include "model/components/subsystems.hpp"
#include "model/numerics/exact_discretisation.hpp"
#include "model/numerics/inline.hpp"
#include "model/numerics/select.hpp"
#include "model/rig/rig_parameters.hpp"
#include "model/rig/state_index.hpp"

namespace model {

/// What the effects of a rig make of its air spring.
template <class S, LawCapacity capacity>
[[nodiscard]] AirSpringCondition<S> condition_of_air_spring(const RigParameters<S, capacity>& rig) {
  AirSpringCondition<S> condition{};
  if constexpr (capacity.extensions) {
    condition.polytropic_exponent = rig.air_spring.polytropic_exponent;
    rig.effects.act_on(condition);
  }
  return condition;
}

/// Stiffness of the component's springs at rest, all but the FDVA's: of gas that moves fast (`slow`: as slowly as
/// heat).
template <class S, LawCapacity capacity>
[[nodiscard]] S spring_stiffness(const RigParameters<S, capacity>& rig, bool slow = false) {
  S stiffness = rig.suspension.stiffness;
  if constexpr (capacity.extensions) {
    const S exponent = slow ? S(1) : condition_of_air_spring(rig).polytropic_exponent;
    if (rig.air_spring.fitted) stiffness += AirSpring<S>::stiffness(rig.air_spring, exponent);
  }
  return stiffness;
}

/// Right-hand side of car, component, and both joined, linear in state and input. Nonlinear forces enter as inputs
/// (`…Input`). The matrices of a step are this right-hand side evaluated at unit vectors: no equation is written twice.
///
///   (1)–(4)  QuarterCar
///   (5)      F_s = F_p + F_act,   F_p = k_b e + b_b ė + F_c + k_r (e − r) + laws parallel to them
///   (5a)     T ṙ = e − r                                        relaxation
///   (5b)     k_m (d − e) = F_p                                  top mount; e = d without it
///   (6)–(9)  Fdva
///   (10)     m ẍ = F − F_p,   x = d = −z_b     driven_mass: the body above a wheel that stands still, z_w = z_r = 0
///
/// d: deflection outside, e: deflection behind the top mount. With free play the component is deflected by e + δ
/// (inputs free_play and free_play_rate). With the damping b_b (5b) is a differential equation of e. Without damping it
/// would be algebraic: a damping that lets e settle within `settling` = 0.1 µs replaces it, with an error of ω · 0.1 µs
/// of the component's force, 1e-5 at 16 Hz.
///
/// Car state 4×1 [z_w, ż_w, z_b, ż_b]; component state 4×1 [y m, ẏ m/s, r m, e m]; joined 8×1 in this order
/// (state_index.hpp). An air spring's k (AirSpring (9)) is part of k_b; the rest of its force is a law. A plain
/// component, without relaxation and top mount, has y and ẏ only.
template <class S>
class RigEquations {
 public:
  using CarState = Column<S, car_states>;
  using ComponentState = Column<S, component_states>;
  using JoinedState = Column<S, core_states>;
  static constexpr double settling = 1e-7;  ///< [s]

  struct CarInput {
    S z_r{}, v_r{};            ///< foot point [m], [m/s]
    S suspension_force{};      ///< F_s [N]
    S tyre_force{};            ///< of laws, added to (3) [N]
    S wheel_guide_friction{};  ///< against ż_w [N]
    S body_guide_friction{};   ///< against ż_b [N]
  };
  struct ComponentInput {
    S deflection{}, velocity{};       ///< d [m], ḋ [m/s]
    S minor_losses{};                 ///< Σ_j q_j|q_j| [m⁶/s²]
    S piston_friction{};              ///< against ẏ [N]
    S parallel_force{};               ///< of laws, added to F_p [N]
    S free_play{}, free_play_rate{};  ///< δ [m], δ̇ [m/s]
  };
  struct JoinedInput {
    S z_r{}, v_r{};                                                      ///< foot point [m], [m/s]
    S actuator_force{};                                                  ///< F_act [N]
    S parallel_force{};                                                  ///< of laws, added to F_p [N]
    S tyre_force{};                                                      ///< of laws, added to (3) [N]
    S minor_losses{};                                                    ///< Σ_j q_j|q_j| [m⁶/s²]
    S piston_friction{}, body_guide_friction{}, wheel_guide_friction{};  ///< [N]
    S free_play{}, free_play_rate{};                                     ///< δ [m], δ̇ [m/s]
    S driving_force{};                                                   ///< of a driven_mass, F of (10) [N]
  };

  template <LawCapacity capacity>
  explicit RigEquations(const RigParameters<S, capacity>& rig)
      : car_{.body_mass = rig.body.mass,
             .wheel_mass = rig.wheel.mass,
             .tyre_stiffness = rig.tyre.stiffness,
             .tyre_damping = rig.tyre.damping,
             .virtual_damping = rig.machine.virtual_damping},
        suspension_{.stiffness = spring_stiffness(rig), .damping = rig.suspension.damping},
        fdva_(rig.fdva),
        has_fdva_(rig.has_fdva) {
    if (has_fdva_) duct_ = Fdva<S>::duct(fdva_);
    rig.effects.act_on(suspension_);
    rig.effects.act_on(piston_);
    rig.effects.act_on(guides_);
    if (has_mount()) {
      const S stiffness = suspension_.mount_stiffness + suspension_.stiffness + suspension_.relaxing_stiffness +
                          (has_fdva_ ? fdva_.coupling_stiffness : S(0));
      const S least = stiffness * S(settling);
      inner_damping_ = select(suspension_.damping > least, suspension_.damping, least);
    }
    car_.body_guide_damping = guides_.body_damping;
    car_.wheel_guide_damping = guides_.wheel_damping;
    if (rig.kind != RigKind::component_bench) per_body_mass_ = S(1) / car_.body_mass;
    if (rig.kind != RigKind::component_bench && rig.kind != RigKind::driven_mass) {
      per_wheel_mass_ = S(1) / car_.wheel_mass;
    }
  }

  [[nodiscard]] RIGTWIN_INLINE S tyre_force(const CarState& x, S z_r, S v_r) const {
    return QuarterCar<S>::tyre_force(car_, as_car(x), z_r, v_r);
  }

  [[nodiscard]] RIGTWIN_INLINE CarState car(const CarState& x, const CarInput& in) const {
    const S tyre = tyre_force(x, in.z_r, in.v_r) + in.tyre_force;
    const auto net = QuarterCar<S>::net_forces(car_, as_car(x), tyre, in.suspension_force);
    CarState rate;
    rate << x(CoreIndex::wheel_velocity), (net.wheel - in.wheel_guide_friction) * per_wheel_mass_,
        x(CoreIndex::body_velocity), (net.body - in.body_guide_friction) * per_body_mass_;
    return rate;
  }

  /// F_p of a plain component without loads [N]
  [[nodiscard]] RIGTWIN_INLINE S plain_force(S travel, S deflection, S velocity) const {
    const S spring_damper = suspension_.stiffness * deflection + suspension_.damping * velocity;
    return has_fdva_ ? spring_damper + Fdva<S>::force(fdva_, deflection, travel) : spring_damper;
  }

  /// F_p [N]: with a top mount the force of the mount, else (5)
  [[nodiscard]] S component_force(const ComponentState& c, const ComponentInput& in) const {
    if (has_mount()) return suspension_.mount_stiffness * (in.deflection - c(ComponentIndex::inner_deflection));
    return inner_force(c, in.deflection + in.free_play, in.velocity + in.free_play_rate) + in.parallel_force;
  }
  [[nodiscard]] S component_force(const ComponentState& c, S deflection, S velocity) const {
    return component_force(c, ComponentInput{.deflection = deflection, .velocity = velocity});
  }

  /// (5a), (5b), (8a)
  [[nodiscard]] ComponentState component(const ComponentState& c, const ComponentInput& in, int open) const {
    ComponentState rate = ComponentState::Zero();
    const S seen = (has_mount() ? c(ComponentIndex::inner_deflection) : in.deflection) + in.free_play;
    if (has_mount()) {
      const S inside = inner_force(c, seen, S(0)) + suspension_.damping * in.free_play_rate + in.parallel_force;
      rate(ComponentIndex::inner_deflection) =
          (suspension_.mount_stiffness * (in.deflection - c(ComponentIndex::inner_deflection)) - inside) /
          inner_damping_;
    }
    if (has_relaxation()) {
      rate(ComponentIndex::relaxed_deflection) =
          (seen - c(ComponentIndex::relaxed_deflection)) / suspension_.relaxation_time;
    }
    if (!has_fdva_ || open == 0) return rate;
    const S net = Fdva<S>::force(fdva_, seen, c(ComponentIndex::piston_travel)) - in.piston_friction;
    rate(ComponentIndex::piston_travel) = c(ComponentIndex::piston_velocity);
    rate(ComponentIndex::piston_velocity) =
        Fdva<S>::piston_acceleration(fdva_, duct_, open, c(ComponentIndex::piston_velocity), net) -
        Fdva<S>::piston_deceleration_per_loss(fdva_, duct_) * in.minor_losses;
    return rate;
  }

  [[nodiscard]] JoinedState joined(const JoinedState& x, const JoinedInput& in, int open) const {
    const CarState car_state = x.template head<car_states>();
    const ComponentState component_state = x.template tail<component_states>();
    const ComponentInput component_input{
        .deflection = x(CoreIndex::wheel_position) - x(CoreIndex::body_position),  // (4)
        .velocity = x(CoreIndex::wheel_velocity) - x(CoreIndex::body_velocity),
        .minor_losses = in.minor_losses,
        .piston_friction = in.piston_friction,
        .parallel_force = in.parallel_force,
        .free_play = in.free_play,
        .free_play_rate = in.free_play_rate};
    const S force = component_force(component_state, component_input) + in.actuator_force - in.driving_force;
    JoinedState rate;
    rate << car(car_state, {.z_r = in.z_r,
                            .v_r = in.v_r,
                            .suspension_force = force,
                            .tyre_force = in.tyre_force,
                            .wheel_guide_friction = in.wheel_guide_friction,
                            .body_guide_friction = in.body_guide_friction}),
        component(component_state, component_input, open);
    return rate;
  }

  [[nodiscard]] RIGTWIN_INLINE static typename QuarterCar<S>::State as_car(const CarState& x) {
    return {.z_w = x(CoreIndex::wheel_position),
            .v_w = x(CoreIndex::wheel_velocity),
            .z_b = x(CoreIndex::body_position),
            .v_b = x(CoreIndex::body_velocity)};
  }

  [[nodiscard]] bool has_mount() const { return same(suspension_.mount_stiffness > S(0)); }
  [[nodiscard]] S inner_damping() const { return inner_damping_; }  ///< of (5b), > 0
  [[nodiscard]] bool has_relaxation() const { return same(suspension_.relaxing_stiffness > S(0)); }
  /// No relaxation, no top mount: two states.
  [[nodiscard]] bool plain() const { return !has_mount() && !has_relaxation(); }

  [[nodiscard]] const typename QuarterCar<S>::Parameters& car() const { return car_; }
  [[nodiscard]] const SuspensionComponent<S>& suspension() const { return suspension_; }
  [[nodiscard]] const Piston<S>& piston() const { return piston_; }
  [[nodiscard]] const Guides<S>& guides() const { return guides_; }
  [[nodiscard]] const typename Fdva<S>::Parameters& fdva() const { return fdva_; }
  [[nodiscard]] const typename Fdva<S>::Duct& duct() const { return duct_; }
  [[nodiscard]] bool has_fdva() const { return has_fdva_; }

 private:
  /// (5) without loads, at the deflection e + δ
  [[nodiscard]] S inner_force(const ComponentState& c, S seen, S velocity) const {
    const S force = plain_force(c(ComponentIndex::piston_travel), seen, velocity);
    if (!has_relaxation()) return force;
    return force + suspension_.relaxing_stiffness * (seen - c(ComponentIndex::relaxed_deflection));
  }

  typename QuarterCar<S>::Parameters car_;
  S per_wheel_mass_{}, per_body_mass_{};  ///< 1/m_w, 1/m_b [1/kg]; 0: it stands still
  SuspensionComponent<S> suspension_;
  S inner_damping_{};  ///< of (5b) [N s/m]
  Piston<S> piston_{};
  Guides<S> guides_{};
  typename Fdva<S>::Parameters fdva_;
  typename Fdva<S>::Duct duct_{};
  bool has_fdva_;
};

/// Matrices of one step, from the right-hand side at unit vectors.
template <class S, int N>
class StepColumns {
 public:
  using Vector = Column<S, N>;

  /// rates(x, input) → ẋ linear in both.
  template <class Input, class Rates>
  StepColumns(const Input& no_input, const Rates& rates, S period) : step_(matrix(no_input, rates), period) {}

  [[nodiscard]] const ExactDiscretisation<S, N>& step() const { return step_; }

  /// The column by which `input`, one unit of one input, enters.
  template <class Input, class Rates>
  [[nodiscard]] static Vector entry(const Input& input, const Rates& rates) {
    return rates(Vector::Zero().eval(), input);
  }

 private:
  template <class Input, class Rates>
  static Block<S, N, N> matrix(const Input& no_input, const Rates& rates) {
    Block<S, N, N> a;
    for (int j = 0; j < N; ++j) a.col(j) = rates(Vector::Unit(j).eval(), no_input);
    return a;
  }

  ExactDiscretisation<S, N> step_;
};

}  // namespace model
