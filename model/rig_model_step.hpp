// The step of a rig (included by rig_model.hpp).
#pragma once

#include "model/rig_model.hpp"

namespace model {

template <class S, std::size_t D>
RigModel<S, D>::RigModel(const RigParameters<S>& rig, S period, Extent extent)
    : rig_(rig),
      equations_(rig),
      period_(period),
      extent_(extent),
      static_load_(QuarterCar<S>::static_wheel_load(equations_.car())) {
  require(!find_fault(rig, period, Line::longest), "a rig that passes find_fault");
  require(extent == Extent::whole_rig || rig.kind == RigKind::hil, "only a hil rig is modelled in parts");

  MachinePath<S> machine{};
  WheelLoadSensor<S> wheel_load{};
  rig.effects.act_on(machine);
  rig.effects.act_on(wheel_load);
  delay_ = machine.delay / period;
  has_delay_ = delay_ > S(0);
  mass_beyond_sensor_ = wheel_load.mass_beyond;
  rig.effects.for_each([&](const auto& slot) {
    if constexpr (requires { slot.effect.tyre_force(S{}, S{}, S{}); }) has_tyre_law_ = has_tyre_law_ || slot.active;
    if constexpr (requires { slot.effect.suspension_force(S{}, S{}); }) {
      has_suspension_law_ = has_suspension_law_ || slot.active;
    }
  });
  const auto& guides = equations_.guides();
  contacts_ = Friction({equations_.suspension().dry_friction, equations_.piston().dry_friction,
                        guides.wheel_dry_friction, guides.body_dry_friction});
  has_laws_ = contacts_.any() || has_tyre_law_ || has_suspension_law_;

  if (equations_.has_fdva()) {
    duct_step_ = DuctFlows<S>::step_of(equations_.fdva(), equations_.duct(), period);
  }
  if (has_car()) car_ = car_step();
  const int installed = equations_.has_fdva() ? equations_.fdva().ducts : 0;
  for (int open = 0; open <= installed; ++open) {
    if (joined()) joined_[static_cast<std::size_t>(open)] = joined_step(open);
    if (has_machine()) component_[static_cast<std::size_t>(open)] = component_step(open);
  }
}

template <class S, std::size_t D>
auto RigModel<S, D>::car_step() const -> CarStep {
  using Drive = typename Equations::CarDrive;
  const auto rates = [this](const Column<S, 4>& x, const Drive& in) { return equations_.car(x, in); };
  using Columns = StepColumns<S, 4>;
  const ExactDiscretisation<S, 4> step = Columns(Drive{}, rates, period_).step();
  return {step.transition(),
          step.hermite(Columns::entry(Drive{.z_r = S(1)}, rates), Columns::entry(Drive{.v_r = S(1)}, rates)),
          step.held(Columns::entry(Drive{.suspension_force = S(1)}, rates)),
          step.template continued<3>(Columns::entry(Drive{.tyre_force = S(1)}, rates))};
}

template <class S, std::size_t D>
auto RigModel<S, D>::component_step(int open) const -> ComponentStep {
  using Drive = typename Equations::ComponentDrive;
  const auto rates = [this, open](const Column<S, 2>& c, const Drive& in) { return equations_.component(c, in, open); };
  using Columns = StepColumns<S, 2>;
  const ExactDiscretisation<S, 2> step = Columns(Drive{}, rates, period_).step();
  ComponentStep m{
      step.transition(),
      step.hermite(Columns::entry(Drive{.deflection = S(1)}, rates), Columns::entry(Drive{.velocity = S(1)}, rates)),
      step.template continued<4>(Columns::entry(Drive{.minor_losses = S(1)}, rates)),
      {}};
  m.friction.setZero();
  m.friction.col(Friction::piston) = step.held(Columns::entry(Drive{.piston_friction = S(1)}, rates));
  return m;
}

template <class S, std::size_t D>
auto RigModel<S, D>::joined_step(int open) const -> JoinedStep {
  using Drive = typename Equations::JoinedDrive;
  const auto rates = [this, open](const Column<S, 6>& x, const Drive& in) { return equations_.joined(x, in, open); };
  using Columns = StepColumns<S, 6>;
  const ExactDiscretisation<S, 6> step = Columns(Drive{}, rates, period_).step();
  const Column<S, 6> parallel = Columns::entry(Drive{.parallel_force = S(1)}, rates);
  JoinedStep m{step.transition(),
               step.hermite(Columns::entry(Drive{.z_r = S(1)}, rates), Columns::entry(Drive{.v_r = S(1)}, rates)),
               step.straight(parallel),
               step.template continued<4>(Columns::entry(Drive{.minor_losses = S(1)}, rates)),
               step.template continued<3>(parallel),
               step.template continued<3>(Columns::entry(Drive{.tyre_force = S(1)}, rates)),
               {}};
  m.friction.col(Friction::suspension) = step.held(parallel);
  m.friction.col(Friction::piston) = step.held(Columns::entry(Drive{.piston_friction = S(1)}, rates));
  m.friction.col(Friction::body_guide) = step.held(Columns::entry(Drive{.body_guide_friction = S(1)}, rates));
  m.friction.col(Friction::wheel_guide) = step.held(Columns::entry(Drive{.wheel_guide_friction = S(1)}, rates));
  return m;
}

template <class S, std::size_t D>
auto RigModel<S, D>::start(S z_r, S deflection) const -> State {
  Column<S, 6> core;
  core << z_r, S(0), z_r, S(0), (joined() || has_car() ? S(0) : deflection), S(0);
  return start(core, Motion<S>{z_r, S(0), S(0)}, Stroke<S>{joined() || has_car() ? S(0) : deflection, S(0)});
}

template <class S, std::size_t D>
auto RigModel<S, D>::start(const Column<S, 6>& core, const Motion<S>& foot_point, const Stroke<S>& reached) const
    -> State {
  State x;
  x.core = core;
  x.foot_point = foot_point;
  x.reached = reached;
  x.line.start(reached, delay_);
  for (std::size_t i = 0; i <= Line::longest; ++i) {
    x.line.ago(i).position = reached.position + reached.velocity * period_ * (delay_ - S(i));
  }
  x.command = has_delay_ ? x.line.ago(0) : reached;
  x.ducts.start(first_ducts(equations_.has_fdva() ? equations_.fdva().open_ducts : 0));
  if (x.ducts.open_count() == 0) x.core(5) = S(0);
  start_laws(x);
  x.received_force = has_machine() ? component_force<true>(x) : S(0);
  return x;
}

template <class S, std::size_t D>
void RigModel<S, D>::step(State& x, const Input& in) const {
  if (has_laws_) return step_with_laws(x, in);
  advance<false>(x, in);
  if ((++x.steps & 63U) == 0U) flush(x);
}

template <class S, std::size_t D>
RIGTWIN_APART void RigModel<S, D>::step_with_laws(State& x, const Input& in) const {
  advance<true>(x, in);
  if ((++x.steps & 63U) == 0U) flush(x);
}

/// WithLaws: the rig has dry friction or nonlinear laws of tyre or suspension. Without them a step is a straight line.
template <class S, std::size_t D>
template <bool WithLaws>
RIGTWIN_INLINE void RigModel<S, D>::advance(State& x, const Input& in) const {
  if (joined()) return advance_joined<WithLaws>(x, in);
  Stroke<S> command = in.command;
  if (has_car()) {
    advance_car<WithLaws>(x, in);
    command = deflection(x);
  }
  if (has_machine()) {
    advance_machine<WithLaws>(x, command);
    x.received_force = component_force<WithLaws>(x) + in.force_noise;
  }
}

template <class S, std::size_t D>
template <bool WithLaws>
RIGTWIN_INLINE void RigModel<S, D>::advance_joined(State& x, const Input& in) const {
  const JoinedStep& m = joined_[static_cast<std::size_t>(x.ducts.open_count())];
  Packed<S, 6> next = m.foot_point.times(driven_by(x.foot_point, in.foot_point));
  m.actuator.add_to(next, {x.actuator_force, in.actuator_force});
  if (WithLaws && has_suspension_law_) m.suspension.add_to(next, newest_three(x.suspension_load));
  if (WithLaws && has_tyre_law_) m.tyre.add_to(next, newest_three(x.tyre_load));
  if (equations_.has_fdva()) m.losses.add_to(next, newest_four(x.ducts.losses()));
  next = next + m.state.times({x.core(0), x.core(1), x.core(2), x.core(3), x.core(4), x.core(5)});
  next.store(x.core);
  if (WithLaws && contacts_.any()) rub_joined(x);
  x.foot_point = in.foot_point;
  x.actuator_force = in.actuator_force;
  if (equations_.has_fdva()) x.ducts.advance(x.core(5), duct_step_);
  if constexpr (WithLaws) refresh_laws(x);
}

/// Dry friction of this step, on top of what moves freely.
template <class S, std::size_t D>
RIGTWIN_APART void RigModel<S, D>::rub_joined(State& x) const {
  const JoinedStep& m = joined_[static_cast<std::size_t>(x.ducts.open_count())];
  contacts_.solve(x.core, m.friction, x.friction, [](int contact, const Column<S, 6>& core) {
    switch (contact) {
      case Friction::suspension:
        return core(1) - core(3);
      case Friction::piston:
        return core(5);
      case Friction::body_guide:
        return core(3);
      default:
        return core(1);
    }
  });
}

template <class S, std::size_t D>
RIGTWIN_APART void RigModel<S, D>::rub_component(State& x) const {
  const ComponentStep& m = component_[static_cast<std::size_t>(x.ducts.open_count())];
  Column<S, 2> c = x.core.template tail<2>();
  contacts_.solve(c, m.friction, x.friction, [](int contact, const Column<S, 2>& component) {
    return contact == Friction::piston ? component(1) : S(0);
  });
  x.core.template tail<2>() = c;
}

template <class S, std::size_t D>
template <bool WithLaws>
RIGTWIN_INLINE void RigModel<S, D>::advance_car(State& x, const Input& in) const {
  Packed<S, 4> next = car_.foot_point.times(driven_by(x.foot_point, in.foot_point));
  if (WithLaws && has_tyre_law_) car_.tyre.add_to(next, newest_three(x.tyre_load));
  car_.force.add_to(next, {x.received_force});
  next = next + car_.state.times({x.core(0), x.core(1), x.core(2), x.core(3)});
  next.store(x.core.template head<4>());
  x.foot_point = in.foot_point;
  if (WithLaws && has_tyre_law_) x.tyre_load.push(tyre_law(x));
}

template <class S, std::size_t D>
template <bool WithLaws>
RIGTWIN_INLINE void RigModel<S, D>::advance_machine(State& x, const Stroke<S>& command) const {
  if (!has_car()) x.command = command;
  Stroke<S> reached = command;
  if (has_delay_) {
    x.line.push(command);
    reached = x.line.read(period_);
  }
  if (equations_.has_fdva()) {
    const ComponentStep& m = component_[static_cast<std::size_t>(x.ducts.open_count())];
    Packed<S, 2> c = m.state.times({x.core(4), x.core(5)});
    m.losses.add_to(c, newest_four(x.ducts.losses()));
    c = c + m.stroke.times(driven_by(x.reached, reached));
    c.store(x.core.template tail<2>());
    if (WithLaws && contacts_.any()) rub_component(x);
    x.ducts.advance(x.core(5), duct_step_);
  }
  x.reached = reached;
  if (WithLaws && has_suspension_law_) x.suspension_load.push(suspension_law(reached.position, reached.velocity));
}

template <class S, std::size_t D>
void RigModel<S, D>::open_ducts(State& x, OpenDucts open) const {
  require(equations_.has_fdva() && (open >> equations_.fdva().ducts) == 0, "only installed ducts can be opened");
  if (open != x.ducts.open()) x.core(5) = x.ducts.switch_to(open, x.core(5), duct_step_);
}

template <class S, std::size_t D>
S RigModel<S, D>::tyre_law(const State& x) const {
  const S deflection = x.foot_point.position - x.core(0);
  const S linear = equations_.tyre_force(x.core.template head<4>(), x.foot_point.position, x.foot_point.velocity);
  S force = linear;
  rig_.effects.for_each([&](const auto& slot) {
    if constexpr (requires { slot.effect.tyre_force(force, deflection, static_load_); }) {
      if (slot.active) force = slot.effect.tyre_force(force, deflection, static_load_);
    }
  });
  return force - linear;
}

template <class S, std::size_t D>
S RigModel<S, D>::suspension_law([[maybe_unused]] S deflection, [[maybe_unused]] S velocity) const {
  S force = S(0);
  rig_.effects.for_each([&](const auto& slot) {
    if constexpr (requires { slot.effect.suspension_force(deflection, velocity); }) {
      if (slot.active) force += slot.effect.suspension_force(deflection, velocity);
    }
  });
  return force;
}

template <class S, std::size_t D>
void RigModel<S, D>::refresh_laws(State& x) const {
  if (has_tyre_law_) x.tyre_load.push(tyre_law(x));
  if (has_suspension_law_) {
    const Stroke<S> d = deflection(x);
    x.suspension_load.push(suspension_law(d.position, d.velocity));
  }
}

template <class S, std::size_t D>
void RigModel<S, D>::start_laws(State& x) const {
  const Stroke<S> d = joined() ? deflection(x) : x.reached;
  if (has_suspension_law_) x.suspension_load.start(suspension_law(d.position, d.velocity));
  if (has_tyre_law_ && (joined() || has_car())) x.tyre_load.start(tyre_law(x));
  if (equations_.has_fdva()) {
    for (int i = 0; i < 4; ++i)
      x.ducts.advance(x.core(5),
                      typename DuctFlows<S>::Step{.decay = Pair<S>::both(S(1)), .piston_area = duct_step_.piston_area});
  }
}

/// F of a test machine's component, dry friction by the sign of the prescribed velocity.
template <class S, std::size_t D>
template <bool WithLaws>
RIGTWIN_INLINE S RigModel<S, D>::component_force(const State& x) const {
  S force = equations_.component_force(x.core.template tail<2>(), x.reached.position, x.reached.velocity);
  if (!WithLaws) return force;
  if (has_suspension_law_) force += x.suspension_load.now;
  const S friction = contacts_.limits()[Friction::suspension];
  if (friction > S(0)) {
    if (x.reached.velocity > S(0)) force += friction;
    if (x.reached.velocity < S(0)) force -= friction;
  }
  return force;
}

template <class S, std::size_t D>
RIGTWIN_INLINE S RigModel<S, D>::suspension_force(const State& x) const {
  if (!joined()) return has_machine() ? component_force<true>(x) : x.received_force;
  const Stroke<S> d = deflection(x);
  S force = equations_.component_force(x.core.template tail<2>(), d.position, d.velocity) + x.actuator_force +
            x.friction[Friction::suspension];
  if (has_suspension_law_) force += x.suspension_load.now;
  return force;
}

template <class S, std::size_t D>
Signals<S> RigModel<S, D>::signals(const State& x) const {
  return channels(x, has_machine() ? component_force<true>(x) : x.received_force, S(0));
}

template <class S, std::size_t D>
Signals<S> RigModel<S, D>::measured(const State& x) const {
  return channels(x, x.received_force, mass_beyond_sensor_);
}

/// `force`: F of a rig with a test machine; `mass_beyond`: between the sensor of F_w and the wheel spring.
template <class S, std::size_t D>
RIGTWIN_INLINE Signals<S> RigModel<S, D>::channels(const State& x, S force, S mass_beyond) const {
  Signals<S> s;
  if (joined()) {
    fill_car(s, x, suspension_force(x), mass_beyond);
    s[index(Channel::x_cmd)] = s[index(Channel::x_act)] = s[index(Channel::F)] = S(0);
    return s;
  }
  if (has_car()) {
    fill_car(s, x, x.received_force, mass_beyond);
    s[index(Channel::x_cmd)] = s[index(Channel::dz_b)];
  } else {
    s.fill(S(0));
    s[index(Channel::x_cmd)] = x.command.position;
  }
  s[index(Channel::x_act)] = x.reached.position;
  s[index(Channel::F)] = force;
  return s;
}

template <class S, std::size_t D>
RIGTWIN_INLINE void RigModel<S, D>::fill_car(Signals<S>& s, const State& x, S suspension_force, S mass_beyond) const {
  const S law = has_tyre_law_ ? x.tyre_load.now : S(0);
  const Column<S, 4> car = x.core.template head<4>();
  const S z_r = x.foot_point.position, v_r = x.foot_point.velocity;
  const Column<S, 4> rate = equations_.car(
      car, {z_r, v_r, suspension_force, law, x.friction[Friction::wheel_guide], x.friction[Friction::body_guide]});
  s[index(Channel::z_r)] = z_r;
  s[index(Channel::z_w)] = car(0);
  s[index(Channel::z_b)] = car(2);
  s[index(Channel::zdd_r)] = x.foot_point.acceleration;
  s[index(Channel::zdd_w)] = rate(1);
  s[index(Channel::zdd_b)] = rate(3);
  s[index(Channel::dz_w)] = z_r - car(0);
  s[index(Channel::dz_b)] = car(0) - car(2);
  s[index(Channel::F_w)] = equations_.tyre_force(car, z_r, v_r) + law + mass_beyond * x.foot_point.acceleration;
  s[index(Channel::F_act)] = x.actuator_force;
}

template <class S, std::size_t D>
S RigModel<S, D>::energy(const State& x) const {
  S e = S(0);
  Stroke<S> d = x.reached;
  if (joined() || has_car()) {
    e += QuarterCar<S>::energy(equations_.car(), {x.core(0), x.core(1), x.core(2), x.core(3)}, x.foot_point.position);
  }
  if (joined()) d = deflection(x);
  if (joined() || has_machine()) {
    e += S(0.5) * equations_.suspension().stiffness * d.position * d.position;
    if (equations_.has_fdva()) {
      const S spring = d.position - x.core(4);
      e += S(0.5) * equations_.fdva().coupling_stiffness * spring * spring +
           x.ducts.energy(x.core(5), duct_step_, equations_.duct().inertance);
    }
  }
  return e;
}

template <class S, std::size_t D>
RIGTWIN_APART void RigModel<S, D>::flush(State& x) const {
  const S least = S(1e-100);
  const auto flush_one = [least](S& value) {
    if (value < least && value > -least) value = S(0);
  };
  for (int i = 0; i < 6; ++i) flush_one(x.core(i));
  flush_one(x.received_force);
  flush_one(x.foot_point.position);
  flush_one(x.foot_point.velocity);
  x.ducts.flush(least);
}

}  // namespace model
