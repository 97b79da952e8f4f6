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
///   (5)      F_s = k_b e + b_b ė + F_c + F_act + loads parallel to them
///   (6)–(9)  Fdva
///
/// Car state 4×1 [z_w, ż_w, z_b, ż_b], component state 2×1 [y m, ẏ m/s], joined 6×1 in this order.
template <class S>
class RigEquations {
 public:
  using CarState = Column<S, 4>;
  using ComponentState = Column<S, 2>;
  using JoinedState = Column<S, 6>;

  struct CarDrive {
    S z_r{}, v_r{};            ///< foot point [m], [m/s]
    S suspension_force{};      ///< F_s [N]
    S tyre_force{};            ///< what laws add to (3) [N]
    S wheel_guide_friction{};  ///< against ż_w [N]
    S body_guide_friction{};   ///< against ż_b [N]
  };
  struct ComponentDrive {
    S deflection{}, velocity{};  ///< e [m], ė [m/s]
    S minor_losses{};            ///< Σ_j q_j|q_j| [m⁶/s²]
    S piston_friction{};         ///< against ẏ [N]
  };
  struct JoinedDrive {
    S z_r{}, v_r{};                                                      ///< foot point [m], [m/s]
    S parallel_force{};                                                  ///< what laws and the actuator add to (5) [N]
    S tyre_force{};                                                      ///< what laws add to (3) [N]
    S minor_losses{};                                                    ///< Σ_j q_j|q_j| [m⁶/s²]
    S piston_friction{}, body_guide_friction{}, wheel_guide_friction{};  ///< [N]
  };

  explicit RigEquations(const RigParameters<S>& rig)
      : car_{rig.body.mass, rig.wheel.mass, rig.tyre.stiffness, rig.tyre.damping, rig.machine.virtual_damping},
        suspension_{rig.suspension.stiffness, rig.suspension.damping, S(0)},
        fdva_(rig.fdva),
        has_fdva_(rig.has_fdva) {
    if (has_fdva_) duct_ = Fdva<S>::duct(fdva_);
    rig.effects.act_on(suspension_);
    rig.effects.act_on(piston_);
    rig.effects.act_on(guides_);
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

  /// (5) without loads [N]
  [[nodiscard]] RIGTWIN_INLINE S component_force(const ComponentState& c, S deflection, S velocity) const {
    const S spring_damper = suspension_.stiffness * deflection + suspension_.damping * velocity;
    return has_fdva_ ? spring_damper + Fdva<S>::force(fdva_, deflection, c(0)) : spring_damper;
  }

  [[nodiscard]] ComponentState component(const ComponentState& c, const ComponentDrive& in, int open) const {
    ComponentState rate = ComponentState::Zero();
    if (!has_fdva_ || open == 0) return rate;
    const S net = Fdva<S>::force(fdva_, in.deflection, c(0)) - in.piston_friction;
    rate << c(1), Fdva<S>::piston_acceleration(fdva_, duct_, open, c(1), net) -
                      Fdva<S>::piston_deceleration_per_loss(fdva_, duct_) * in.minor_losses;
    return rate;
  }

  [[nodiscard]] JoinedState joined(const JoinedState& x, const JoinedDrive& in, int open) const {
    const CarState car_state = x.template head<4>();
    const ComponentState component_state = x.template tail<2>();
    const S deflection = x(0) - x(2), velocity = x(1) - x(3);  // (4)
    const S force = component_force(component_state, deflection, velocity) + in.parallel_force;
    JoinedState rate;
    rate << car(car_state, {in.z_r, in.v_r, force, in.tyre_force, in.wheel_guide_friction, in.body_guide_friction}),
        component(component_state, {deflection, velocity, in.minor_losses, in.piston_friction}, open);
    return rate;
  }

  [[nodiscard]] const typename QuarterCar<S>::Parameters& car() const { return car_; }
  [[nodiscard]] const SuspensionComponent<S>& suspension() const { return suspension_; }
  [[nodiscard]] const Piston<S>& piston() const { return piston_; }
  [[nodiscard]] const Guides<S>& guides() const { return guides_; }
  [[nodiscard]] const typename Fdva<S>::Parameters& fdva() const { return fdva_; }
  [[nodiscard]] const typename Fdva<S>::Duct& duct() const { return duct_; }
  [[nodiscard]] bool has_fdva() const { return has_fdva_; }

 private:
  [[nodiscard]] RIGTWIN_INLINE static typename QuarterCar<S>::State as_car(const CarState& x) {
    return {x(0), x(1), x(2), x(3)};
  }

  typename QuarterCar<S>::Parameters car_;
  S per_wheel_mass_{}, per_body_mass_{};  ///< 1/m_w, 1/m_b [1/kg]
  SuspensionComponent<S> suspension_;
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
