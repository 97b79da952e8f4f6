// The equations of a whole rig as one right-hand side.
#pragma once

#include "model/exact_discretisation.hpp"
#include "model/fdva.hpp"
#include "model/inline.hpp"
#include "model/places.hpp"
#include "model/quarter_car.hpp"
#include "model/rig_parameters.hpp"

namespace model {

/// Right-hand side of car, component, and both joined. All of it is linear in its arguments: what is nonlinear comes in
/// as a load (argument `…Drive`), so that the matrices of a step are this right-hand side evaluated at unit vectors and
/// no equation is written twice.
///
///   (1)–(4)  QuarterCar
///   (5)      F_s = F_p + F_act,   F_p = k_b e + b_b ė + F_c + k_r (e − r) + laws parallel to them
///   (5a)     T ṙ = e − r                                        relaxation
///   (5b)     k_m (d − e) = F_p                                  top mount; e = d without it
///   (6)–(9)  Fdva
///
/// d: deflection outside, e: what the component sees. Free play makes it see e + δ (loads free_play and
/// free_play_rate). (5b) is a differential equation of e with the damping b_b, and algebraic without damping; then a
/// damping that makes it settle within `settling` = 0.1 µs stands in, an error of ω · 0.1 µs, 1e-5 at 16 Hz, of the
/// component's force.
///
/// Car state 4×1 [z_w, ż_w, z_b, ż_b]; component state 4×1 [y m, ẏ m/s, r m, e m], of which a plain component, one
/// without relaxation and top mount, has the first two only; joined 8×1 in this order.
template <class S>
class RigEquations {
 public:
  using CarState = Column<S, 4>;
  using ComponentState = Column<S, 4>;
  using JoinedState = Column<S, 8>;
  static constexpr double settling = 1e-7;  ///< [s]

  struct CarDrive {
    S z_r{}, v_r{};            ///< foot point [m], [m/s]
    S suspension_force{};      ///< F_s [N]
    S tyre_force{};            ///< what laws add to (3) [N]
    S wheel_guide_friction{};  ///< against ż_w [N]
    S body_guide_friction{};   ///< against ż_b [N]
  };
  struct ComponentDrive {
    S deflection{}, velocity{};       ///< d [m], ḋ [m/s]
    S minor_losses{};                 ///< Σ_j q_j|q_j| [m⁶/s²]
    S piston_friction{};              ///< against ẏ [N]
    S parallel_force{};               ///< what laws add to F_p [N]
    S free_play{}, free_play_rate{};  ///< δ [m], δ̇ [m/s]
  };
  struct JoinedDrive {
    S z_r{}, v_r{};                                                      ///< foot point [m], [m/s]
    S actuator_force{};                                                  ///< F_act [N]
    S parallel_force{};                                                  ///< what laws add to F_p [N]
    S tyre_force{};                                                      ///< what laws add to (3) [N]
    S minor_losses{};                                                    ///< Σ_j q_j|q_j| [m⁶/s²]
    S piston_friction{}, body_guide_friction{}, wheel_guide_friction{};  ///< [N]
    S free_play{}, free_play_rate{};                                     ///< δ [m], δ̇ [m/s]
  };

  explicit RigEquations(const RigParameters<S>& rig)
      : car_{rig.body.mass, rig.wheel.mass, rig.tyre.stiffness, rig.tyre.damping, rig.machine.virtual_damping},
        suspension_{.stiffness = rig.suspension.stiffness, .damping = rig.suspension.damping},
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
      inner_damping_ = suspension_.damping > least ? suspension_.damping : least;
    }
    car_.body_guide_damping = guides_.body_damping;
    car_.wheel_guide_damping = guides_.wheel_damping;
    if (rig.kind != RigKind::component_bench) {
      per_body_mass_ = S(1) / car_.body_mass;
      per_wheel_mass_ = S(1) / car_.wheel_mass;
    }
  }

  [[nodiscard]] RIGTWIN_INLINE S tyre_force(const CarState& x, S z_r, S v_r) const {
    return QuarterCar<S>::tyre_force(car_, as_car(x), z_r, v_r);
  }

  [[nodiscard]] RIGTWIN_INLINE CarState car(const CarState& x, const CarDrive& in) const {
    const S tyre = tyre_force(x, in.z_r, in.v_r) + in.tyre_force;
    const auto net = QuarterCar<S>::net_forces(car_, as_car(x), tyre, in.suspension_force);
    CarState rate;
    rate << x(1), (net.wheel - in.wheel_guide_friction) * per_wheel_mass_, x(3),
        (net.body - in.body_guide_friction) * per_body_mass_;
    return rate;
  }

  /// F_p of a plain component without loads [N]
  [[nodiscard]] RIGTWIN_INLINE S plain_force(S travel, S deflection, S velocity) const {
    const S spring_damper = suspension_.stiffness * deflection + suspension_.damping * velocity;
    return has_fdva_ ? spring_damper + Fdva<S>::force(fdva_, deflection, travel) : spring_damper;
  }

  /// F_p [N]: with a top mount what the mount carries, else (5)
  [[nodiscard]] S component_force(const ComponentState& c, const ComponentDrive& in) const {
    if (has_mount()) return suspension_.mount_stiffness * (in.deflection - c(3));
    return inner_force(c, in.deflection + in.free_play, in.velocity + in.free_play_rate) + in.parallel_force;
  }
  [[nodiscard]] S component_force(const ComponentState& c, S deflection, S velocity) const {
    return component_force(c, ComponentDrive{.deflection = deflection, .velocity = velocity});
  }

  /// (5a), (5b), (8a)
  [[nodiscard]] ComponentState component(const ComponentState& c, const ComponentDrive& in, int open) const {
    ComponentState rate = ComponentState::Zero();
    const S seen = (has_mount() ? c(3) : in.deflection) + in.free_play;
    if (has_mount()) {
      const S inside = inner_force(c, seen, S(0)) + suspension_.damping * in.free_play_rate + in.parallel_force;
      rate(3) = (suspension_.mount_stiffness * (in.deflection - c(3)) - inside) / inner_damping_;
    }
    if (has_relaxation()) rate(2) = (seen - c(2)) / suspension_.relaxation_time;
    if (!has_fdva_ || open == 0) return rate;
    const S net = Fdva<S>::force(fdva_, seen, c(0)) - in.piston_friction;
    rate(0) = c(1);
    rate(1) = Fdva<S>::piston_acceleration(fdva_, duct_, open, c(1), net) -
              Fdva<S>::piston_deceleration_per_loss(fdva_, duct_) * in.minor_losses;
    return rate;
  }

  [[nodiscard]] JoinedState joined(const JoinedState& x, const JoinedDrive& in, int open) const {
    const CarState car_state = x.template head<4>();
    const ComponentState component_state = x.template tail<4>();
    const ComponentDrive drive{x(0) - x(2),        x(1) - x(3),       in.minor_losses,  // (4)
                               in.piston_friction, in.parallel_force, in.free_play,    in.free_play_rate};
    const S force = component_force(component_state, drive) + in.actuator_force;
    JoinedState rate;
    rate << car(car_state, {in.z_r, in.v_r, force, in.tyre_force, in.wheel_guide_friction, in.body_guide_friction}),
        component(component_state, drive, open);
    return rate;
  }

  [[nodiscard]] bool has_mount() const { return suspension_.mount_stiffness > S(0); }
  [[nodiscard]] bool has_relaxation() const { return suspension_.relaxing_stiffness > S(0); }
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
  /// (5) without loads, on what the component sees
  [[nodiscard]] S inner_force(const ComponentState& c, S seen, S velocity) const {
    const S force = plain_force(c(0), seen, velocity);
    return has_relaxation() ? force + suspension_.relaxing_stiffness * (seen - c(2)) : force;
  }

  [[nodiscard]] RIGTWIN_INLINE static typename QuarterCar<S>::State as_car(const CarState& x) {
    return {x(0), x(1), x(2), x(3)};
  }

  typename QuarterCar<S>::Parameters car_;
  S per_wheel_mass_{}, per_body_mass_{};  ///< 1/m_w, 1/m_b [1/kg]
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

  /// rates(x, drive) → ẋ linear in both.
  template <class Drive, class Rates>
  StepColumns(const Drive& no_drive, const Rates& rates, S period) : step_(matrix(no_drive, rates), period) {}

  [[nodiscard]] const ExactDiscretisation<S, N>& step() const { return step_; }

  /// The column by which `drive`, one unit of one input, enters.
  template <class Drive, class Rates>
  [[nodiscard]] static Vector entry(const Drive& drive, const Rates& rates) {
    return rates(Vector::Zero().eval(), drive);
  }

 private:
  template <class Drive, class Rates>
  static Block<S, N, N> matrix(const Drive& no_drive, const Rates& rates) {
    Block<S, N, N> a;
    for (int j = 0; j < N; ++j) a.col(j) = rates(Vector::Unit(j).eval(), no_drive);
    return a;
  }

  ExactDiscretisation<S, N> step_;
};

}  // namespace model
