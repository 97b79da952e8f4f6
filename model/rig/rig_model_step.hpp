// The step of a rig (included by rig_model.hpp).
#pragma once

#include "model/rig/rig_model.hpp"

namespace model {

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RigModel<S, D, variant, capacity>::RigModel(const Rig& rig, S period, ModelledPart part)
    : rig_(rig),
      equations_(rig),
      period_(period),
      part_(part),
      static_load_(QuarterCar<S>::static_wheel_load(equations_.car())) {
  if constexpr (lane_count<S> == 1) {
    require(!find_fault(rig, period, Line::longest), "a rig that passes find_fault");
  }
  require(part == ModelledPart::whole_rig || rig.kind == RigKind::hil, "only a hil rig is modelled in parts");
  require(!car_alone || part == ModelledPart::virtual_car, "a part that this variant of the model has");

  MachinePath<S> machine{};
  WheelLoadSensor<S> wheel_load{};
  LoadCell<S> load_cell{};
  rig.effects.act_on(machine);
  rig.effects.act_on(wheel_load);
  rig.effects.act_on(load_cell);
  delay_ = machine.delay / period;
  has_delay_ = same(delay_ > S(0)) || (!car_alone && rig.delay_variation.any());
  mass_beyond_sensor_ = wheel_load.mass_beyond;
  moving_mass_ = load_cell.moving_mass;
  if constexpr (!car_alone) {
    machine_ = Machine<S>(machine, period);
  }
  if constexpr (has_sensors) {
    if (part != ModelledPart::virtual_car) sensors_ = Sensors<S>(rig.effects.sensor_paths(), period);
  }
  has_free_play_ = same(equations_.suspension().free_play > S(0));
  has_moving_mass_ = same(moving_mass_ > S(0));
  rig.effects.for_each([&](const auto& slot) {
    if constexpr (requires { slot.effect.tyre_force(S{}, S{}, S{}); }) has_tyre_law_ = has_tyre_law_ || slot.active;
    if constexpr (requires { slot.effect.suspension_force(S{}, S{}); }) {
      has_suspension_law_ = has_suspension_law_ || slot.active;
    }
    if constexpr (requires { slot.effect.force_after(S{}, S{}); }) {
      has_suspension_law_ = has_suspension_law_ || slot.active;
    }
  });
  if constexpr (has_extensions) {
    if (rig.lever.any()) lever_ = Lever<S>(rig.lever, rig.body.mass);
    if constexpr (!car_alone) {
      if (rig.air_spring.fitted) air_spring_ = AirSpring<S>(rig.air_spring, condition_of_air_spring(rig), period);
    }
  }
  has_suspension_law_ = has_suspension_law_ || has_air_spring() || lever_joined();
  const auto& guides = equations_.guides();
  contacts_ = Friction({equations_.suspension().dry_friction, equations_.piston().dry_friction,
                        guides.wheel_dry_friction, guides.body_dry_friction});
  if constexpr (LawsInSteps::possible) {
    laws_ = LawsInSteps(rig.laws, period);
    find_law_places();
    has_law_readings_ = laws_.at(LawPlace::sensor);
  }
  if (has_car()) car_ = car_step();
  if constexpr (car_alone) {
    needs_general_step_ = has_tyre_law_ || laws_.any() || has_lever();
  } else {
    has_foot_machine_ = joined() && (has_delay_ || machine_.any());
    needs_general_step_ = has_foot_machine_ || contacts_.any() || has_tyre_law_ || has_suspension_law_ ||
                          has_free_play_ || machine_.any() || any_sensor() || !equations_.plain() || has_moving_mass_ ||
                          laws_.any() || laws_.at(LawPlace::sensor) || has_lever() || rig.delay_variation.any();
    if (equations_.has_fdva()) {
      duct_step_ = DuctFlows<S>::step_of(equations_.fdva(), equations_.duct(), period);
    }
    const int installed = equations_.has_fdva() ? equations_.fdva().ducts : 0;
    for (int open = 0; open <= installed; ++open) {
      const auto n = static_cast<std::size_t>(open);
      if (equations_.plain()) {
        if (joined()) joined_[n] = joined_step<plain_core_states>(open);
        if (has_machine()) component_[n] = component_step<plain_component_states>(open);
      } else {
        if (joined()) elaborate_joined_[n] = joined_step<core_states>(open);
        if (has_machine()) elaborate_component_[n] = component_step<component_states>(open);
      }
    }
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
auto RigModel<S, D, variant, capacity>::car_step() const -> CarStep {
  using CarInput = typename Equations::CarInput;
  const auto rates = [this](const Column<S, car_states>& x, const CarInput& in) { return equations_.car(x, in); };
  using Columns = StepColumns<S, car_states>;
  const ExactDiscretisation<S, car_states> step = Columns(CarInput{}, rates, period_).step();
  const Column<S, car_states> tyre = Columns::entry(CarInput{.tyre_force = S(1)}, rates);
  CarStep m{step.transition(),
            step.hermite(Columns::entry(CarInput{.z_r = S(1)}, rates), Columns::entry(CarInput{.v_r = S(1)}, rates)),
            step.held(Columns::entry(CarInput{.suspension_force = S(1)}, rates)), step.template continued<3>(tyre)};
  if constexpr (LawsInSteps::possible) m.tables[index(LawPlace::tyre)] = law_column<0>(step, LawPlace::tyre, tyre);
  return m;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <int N>
auto RigModel<S, D, variant, capacity>::component_step(int open) const -> ComponentStep<N> {
  using ComponentInput = typename Equations::ComponentInput;
  const auto rates = [this, open](const Column<S, N>& c, const ComponentInput& in) -> Column<S, N> {
    typename Equations::ComponentState all = Equations::ComponentState::Zero();
    all.template head<N>() = c;
    return equations_.component(all, in, open).template head<N>();
  };
  using Columns = StepColumns<S, N>;
  const ExactDiscretisation<S, N> step = Columns(ComponentInput{}, rates, period_).step();
  const Column<S, N> parallel = Columns::entry(ComponentInput{.parallel_force = S(1)}, rates);
  ComponentStep<N> m{step.transition(),
                     step.hermite(Columns::entry(ComponentInput{.deflection = S(1)}, rates),
                                  Columns::entry(ComponentInput{.velocity = S(1)}, rates)),
                     step.template continued<4>(Columns::entry(ComponentInput{.minor_losses = S(1)}, rates)),
                     step.template continued<3>(parallel),
                     {step.template continued<3>(Columns::entry(ComponentInput{.free_play = S(1)}, rates)),
                      step.template continued<3>(Columns::entry(ComponentInput{.free_play_rate = S(1)}, rates))},
                     Block<S, N, Friction::contacts>::Zero()};
  const Column<S, N> piston = Columns::entry(ComponentInput{.piston_friction = S(1)}, rates);
  m.friction.col(Friction::suspension) = step.held(parallel);
  m.friction.col(Friction::piston) = step.held(piston);
  if constexpr (LawsInSteps::possible) {
    constexpr int first = CoreIndex::piston_travel;
    m.tables[index(LawPlace::suspension)] = law_column<first>(step, LawPlace::suspension, parallel);
    m.tables[index(LawPlace::piston)] = law_column<first>(step, LawPlace::piston, piston);
  }
  return m;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <int N>
auto RigModel<S, D, variant, capacity>::joined_step(int open) const -> JoinedStep<N> {
  using JoinedInput = typename Equations::JoinedInput;
  const auto rates = [this, open](const Column<S, N>& x, const JoinedInput& in) -> Column<S, N> {
    typename Equations::JoinedState all = Equations::JoinedState::Zero();
    all.template head<N>() = x;
    return equations_.joined(all, in, open).template head<N>();
  };
  using Columns = StepColumns<S, N>;
  const ExactDiscretisation<S, N> step = Columns(JoinedInput{}, rates, period_).step();
  const Column<S, N> parallel = Columns::entry(JoinedInput{.parallel_force = S(1)}, rates);
  const bool driven = driven_by_force();
  const Column<S, N> drive =
      Columns::entry(driven ? JoinedInput{.driving_force = S(1)} : JoinedInput{.z_r = S(1)}, rates);
  const Column<S, N> drive_rate = Columns::entry(driven ? JoinedInput{} : JoinedInput{.v_r = S(1)}, rates);
  JoinedStep<N> m{step.transition(),
                  step.hermite(drive, drive_rate),
                  step.straight(Columns::entry(JoinedInput{.actuator_force = S(1)}, rates)),
                  step.template continued<4>(Columns::entry(JoinedInput{.minor_losses = S(1)}, rates)),
                  step.template continued<3>(parallel),
                  step.template continued<3>(Columns::entry(JoinedInput{.tyre_force = S(1)}, rates)),
                  {step.template continued<3>(Columns::entry(JoinedInput{.free_play = S(1)}, rates)),
                   step.template continued<3>(Columns::entry(JoinedInput{.free_play_rate = S(1)}, rates))},
                  {}};
  const Column<S, N> piston = Columns::entry(JoinedInput{.piston_friction = S(1)}, rates);
  const Column<S, N> body_guide = Columns::entry(JoinedInput{.body_guide_friction = S(1)}, rates);
  const Column<S, N> wheel_guide = Columns::entry(JoinedInput{.wheel_guide_friction = S(1)}, rates);
  m.friction.col(Friction::suspension) = step.held(parallel);
  m.friction.col(Friction::piston) = step.held(piston);
  m.friction.col(Friction::body_guide) = step.held(body_guide);
  m.friction.col(Friction::wheel_guide) = step.held(wheel_guide);
  if constexpr (LawsInSteps::possible) {
    const Column<S, N> tyre = Columns::entry(JoinedInput{.tyre_force = S(1)}, rates);
    m.tables[index(LawPlace::suspension)] = law_column<0>(step, LawPlace::suspension, parallel);
    m.tables[index(LawPlace::tyre)] = law_column<0>(step, LawPlace::tyre, tyre);
    m.tables[index(LawPlace::piston)] = law_column<0>(step, LawPlace::piston, piston);
    m.tables[index(LawPlace::body_guide)] = law_column<0>(step, LawPlace::body_guide, body_guide);
    m.tables[index(LawPlace::wheel_guide)] = law_column<0>(step, LawPlace::wheel_guide, wheel_guide);
  }
  return m;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
auto RigModel<S, D, variant, capacity>::start(S z_r, S deflection) const -> State {
  const S resting = joined() || has_car() ? S(0) : deflection;
  Column<S, plain_core_states> core = Column<S, plain_core_states>::Zero();
  core(CoreIndex::wheel_position) = core(CoreIndex::body_position) = z_r;
  core(CoreIndex::piston_travel) = resting;
  return start(core, Motion<S>{z_r, S(0), S(0)}, Stroke<S>{resting, S(0)});
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
auto RigModel<S, D, variant, capacity>::start(const Column<S, plain_core_states>& core, const Motion<S>& foot_point,
                                              const Stroke<S>& reached) const -> State {
  State x;
  x.core.template head<plain_core_states>() = core;
  x.foot_point = foot_point;
  x.reached = reached;
  if constexpr (car_alone) {
    if (has_tyre_law_) x.tyre_load.start(tyre_law(x));
    if (law_forces()) finish_laws(x, true);
  } else {
    Stroke<S> entering = reached;  // behind the delay
    if (has_foot_machine_) {
      entering = {foot_point.position - foot_point.velocity * period_ * delay_, foot_point.velocity};
      x.reached = machine_.output(machine_.start(entering), entering);
      x.foot_point = {x.reached.position, x.reached.velocity, foot_point.acceleration};
    }
    start_machine(x, entering);
  }
  return x;
}

/// Machine and component of a state that has car, foot point and stroke.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::start_machine(State& x, const Stroke<S>& reached) const {
  if constexpr (!car_alone) {
    x.line.start(reached, delay_);
    for (std::size_t i = 0; i <= Line::longest; ++i) {
      x.line.ago(i).position = reached.position + reached.velocity * period_ * (delay_ - S(i));
    }
    x.command = has_delay_ ? x.line.ago(0) : reached;
    x.delayed = reached;
    x.machine = machine_.start(reached);
    x.ducts.start(first_ducts(equations_.has_fdva() ? equations_.fdva().open_ducts : 0));
    if (x.ducts.open_count() == 0) x.core(CoreIndex::piston_velocity) = S(0);
    const S outside = outer_stroke(x).position;
    x.core(CoreIndex::relaxed_deflection) = x.core(CoreIndex::inner_deflection) = outside;
    if (equations_.has_mount()) start_behind_mount(x);
    start_laws(x);
    x.received_force = has_machine() ? shown_by_law(Channel::F, component_force<true>(x)) : S(0);
    if constexpr (has_sensors) {
      if (!sensors_.any()) return;
      sensors_.start(x.sensors, shown_by_laws(channels(x, x.received_force, mass_beyond_sensor_)), nullptr);
      if (has_machine()) x.received_force = sensors_.reading(x.sensors, Channel::F, x.received_force);
    }
  }
}

/// (5b) with ė = ẋ, where the relaxing branch carries nothing: what is behind the mount moves along with what is before
/// it. At rest, and where nothing bends, one linear equation of e; else Newton's method.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::start_behind_mount(State& x) const {
  const bool bends = has_suspension_law_ || law_forces();
  const S difference = S(bends ? 1e-7 : 1.0);  // [m]
  S inside = bends ? outer_stroke(x).position : S(0);
  for (int rounds = bends ? 8 : 1; rounds > 0; --rounds) {
    const S left = ahead_behind_mount(x, inside);
    inside -= left * difference / (ahead_behind_mount(x, inside + difference) - left);
  }
  x.core(CoreIndex::relaxed_deflection) = x.core(CoreIndex::inner_deflection) = inside;
}

/// ė − ẋ where e is `inside`, with the laws of that motion.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_NOINLINE S RigModel<S, D, variant, capacity>::ahead_behind_mount(State& x, S inside) const {
  const Stroke<S> outside = outer_stroke(x), seen{inside, outside.velocity};
  x.core(CoreIndex::relaxed_deflection) = x.core(CoreIndex::inner_deflection) = inside;
  S bent = has_suspension_law_ ? suspension_law(seen) : S(0);
  if constexpr (LawsInSteps::possible) {
    if (laws_.at(LawPlace::suspension)) {
      laws_.start(LawPlace::suspension, x.laws, seen);
      bent += law_force(x, LawPlace::suspension);
    }
  }
  const typename Equations::ComponentInput in{
      .deflection = outside.position, .velocity = outside.velocity, .parallel_force = bent};
  const auto rate = equations_.component(x.core.template tail<component_states>(), in, x.ducts.open_count());
  return rate(ComponentIndex::inner_deflection) - outside.velocity;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::step(State& x, const Input& in) const {
  if (needs_general_step_) return general_step(x, in);
  advance<false>(x, in);
  if ((++x.steps & 63U) == 0U) flush(x);
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_NOINLINE void RigModel<S, D, variant, capacity>::general_step(State& x, const Input& in) const {
  advance<true>(x, in);
  if ((++x.steps & 63U) == 0U) flush(x);
}

/// General = false: the rig has a linear component with quadratic duct losses and a machine with no more than a delay.
/// Its step has no branches.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::advance(State& x, const Input& in) const {
  if constexpr (car_alone) {
    advance_car<General>(x, in);
  } else {
    advance_rig<General>(x, in);
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::advance_rig(State& x, const Input& in) const {
  if constexpr (General && has_extensions && !car_alone) {
    if (has_air_spring() && air_spring_.has_skyhook() && (joined() || has_car())) {
      x.air_spring.command = air_spring_.skyhook(x.core(CoreIndex::body_velocity));
    }
  }
  if (joined()) {
    const auto move = [&](const Motion<S>& foot_point) {
      if (General && !equations_.plain()) {
        advance_joined<General>(elaborate_joined_[static_cast<std::size_t>(x.ducts.open_count())], x, in, foot_point);
      } else {
        advance_joined<General>(joined_[static_cast<std::size_t>(x.ducts.open_count())], x, in, foot_point);
      }
    };
    move(General && has_foot_machine_ ? through_foot_machine(x, in.foot_point) : in.foot_point);
  } else {
    Stroke<S> command = in.command;
    if (has_car()) {
      advance_car<General>(x, in);
      command = General ? component_stroke(deflection(x)) : deflection(x);
    }
    if (has_machine()) {
      advance_machine<General>(x, command);
      x.received_force = component_force<General>(x);
      if (General) x.received_force = shown_by_law(Channel::F, x.received_force + inertia_force(x));
      if (in.noise != nullptr && !(General && any_sensor())) x.received_force += (*in.noise)[index(Channel::F)];
    }
  }
  if (General && any_sensor()) sense(x, in.noise);
}

/// The readings of this instant; the reading of F goes around the loop.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_NOINLINE void RigModel<S, D, variant, capacity>::sense(State& x, const Signals<S>* noise) const {
  if constexpr (has_sensors) {
    const S force = x.received_force;
    sensors_.step(x.sensors, shown_by_laws(channels(x, force, mass_beyond_sensor_)), noise);
    if (!has_machine()) return;
    x.received_force =
        sensors_.reading(x.sensors, Channel::F, noise != nullptr ? force + (*noise)[index(Channel::F)] : force);
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General, int N>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::advance_joined(const JoinedStep<N>& m, State& x, const Input& in,
                                                                      const Motion<S>& foot_point) const {
  Packed<S, N> next = m.foot_point.times(driven_by(x.foot_point, foot_point));
  m.actuator.add_to(next, {x.actuator_force, in.actuator_force});
  if (General && has_suspension_law_) m.suspension.add_to(next, newest_three(x.suspension_load, x.load_jump));
  if (General && has_tyre_law_) m.tyre.add_to(next, newest_three(x.tyre_load));
  if (General && (has_free_play_ || lever_joined())) {
    m.free_play[0].add_to(next, newest_three(x.free_play));
    m.free_play[1].add_to(next, newest_three(x.free_play_rate, x.free_play_jump));
  }
  if (equations_.has_fdva()) m.losses.add_to(next, newest_four(x.ducts.losses()));
  next = next + m.state.times(entries<N>(x.core, CoreIndex::wheel_position));
  if (General && contacts_.any()) {
    const Column<S, core_states> before = x.core;
    next.store(x.core);
    if constexpr (LawsInSteps::possible) {
      if (law_forces()) apply_laws<0, N>(m.tables, x, foot_point);
    }
    apply_friction(m.friction, x, before);
  } else {
    next.store(x.core);
    if constexpr (General && LawsInSteps::possible) {
      if (law_forces()) apply_laws<0, N>(m.tables, x, foot_point);
    }
  }
  x.foot_point = foot_point;
  x.actuator_force = in.actuator_force;
  if (equations_.has_fdva()) x.ducts.advance(x.core(CoreIndex::piston_velocity), duct_step_);
  if constexpr (General) refresh_laws(x);
}

/// Adds dry friction to the step that led from `before` to x without it. With a top mount the friction acts behind the
/// mount, on e, which has no mass: the distance that e moves in the step takes the place of a velocity.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <int N>
RIGTWIN_NOINLINE void RigModel<S, D, variant, capacity>::apply_friction(const Block<S, N, Friction::contacts>& columns,
                                                                        State& x,
                                                                        const Column<S, core_states>& before) const {
  using Layout = StateLayout<N>;
  constexpr int first = Layout::has_car ? 0 : int{CoreIndex::piston_travel};  // of these N in the core
  constexpr int piston_velocity = Layout::component + ComponentIndex::piston_velocity;
  constexpr int inner_deflection = N - 1;  // the last, where the component is not plain
  const S inner_before = before(CoreIndex::inner_deflection);
  Column<S, N> all = x.core.template segment<N>(first);
  Column<S, N> start = before.template segment<N>(first);
  const bool mount = !Layout::is_plain && equations_.has_mount();
  if (mount) {
    all(inner_deflection) -= inner_before;
    start(inner_deflection) = S(0);
  }
  typename Friction::Forces limits = contacts_.limits();
  if (has_free_play_) {
    limits[Friction::suspension] = select(inside_free_play(x), S(0), limits[Friction::suspension]);  // no contact
  }
  contacts_.solve(all, start, columns, limits, x.friction, [&](int contact, const Column<S, N>& v) {
    if (contact == Friction::piston) return v(piston_velocity);
    if (contact == Friction::suspension && mount) return v(inner_deflection);
    if constexpr (Layout::has_car) {
      if (contact == Friction::suspension) return v(CoreIndex::wheel_velocity) - v(CoreIndex::body_velocity);
      return contact == Friction::body_guide ? v(CoreIndex::body_velocity) : v(CoreIndex::wheel_velocity);
    }
    return S(0);
  });
  if (mount) all(inner_deflection) += inner_before;
  x.core.template segment<N>(first) = all;
}

/// Position and velocity at a place where a law acts, linear in core and foot point; `part` is the core from `first`
/// on. Behind a top mount e has no mass, hence no velocity of its own.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <int first, class Part>
RIGTWIN_INLINE Stroke<S> RigModel<S, D, variant, capacity>::at_place(LawPlace place, const Part& part,
                                                                     const Motion<S>& foot_point) const {
  constexpr int end = first + Part::RowsAtCompileTime;
  if constexpr (end > CoreIndex::inner_deflection) {
    if (place == LawPlace::suspension && equations_.has_mount()) {
      return {part(CoreIndex::inner_deflection - first), S(0)};
    }
  }
  if constexpr (end > CoreIndex::piston_velocity) {
    if (place == LawPlace::piston) {
      return {part(CoreIndex::piston_travel - first), part(CoreIndex::piston_velocity - first)};
    }
  }
  if constexpr (first == 0) {
    const S z_w = part(CoreIndex::wheel_position), v_w = part(CoreIndex::wheel_velocity);
    const S z_b = part(CoreIndex::body_position), v_b = part(CoreIndex::body_velocity);
    if (place == LawPlace::suspension) return {z_w - z_b, v_w - v_b};
    if (place == LawPlace::tyre) return {foot_point.position - z_w, foot_point.velocity - v_w};
    if (place == LawPlace::wheel_guide) return {z_w, v_w};
    if (place == LawPlace::body_guide) return {z_b, v_b};
  }
  return {};
}

/// The motion that a law sees: behind the free play, and behind a top mount with the mean velocity of the step in place
/// of a velocity.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
Stroke<S> RigModel<S, D, variant, capacity>::seen_by_law(LawPlace place, const State& x, Stroke<S> motion) const {
  if constexpr (LawsInSteps::possible) {
    if (place != LawPlace::suspension) return motion;
    if (has_free_play_) {
      const Stroke<S> taken = offset(motion);
      motion = {motion.position + taken.position, motion.velocity + taken.velocity};
    }
    if (equations_.has_mount()) {
      motion.velocity = (motion.position - x.laws.at[index(LawPlace::suspension)].position) / period_;
    }
  }
  return motion;
}

/// Places that exist in this rig and have laws: a hil rig's machine has no wheel, a car alone no suspension.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::find_law_places() {
  for (std::size_t p = 0; p < force_places; ++p) {
    const auto place = static_cast<LawPlace>(p);
    const bool tyre = place == LawPlace::tyre, component = place == LawPlace::suspension || place == LawPlace::piston;
    const bool exists = joined() || (tyre && has_car()) || (component && has_machine());
    if (exists && laws_.at(place)) law_places_[law_place_count_++] = place;
  }
}

/// How a force at a place, which enters by column b, moves the state in a step: held, and growing from 0 to 1. The
/// state's part of N entries begins at `first`.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <int first, int N>
auto RigModel<S, D, variant, capacity>::law_column(const ExactDiscretisation<S, N>& step, LawPlace place,
                                                   const Column<S, N>& b) const -> LawColumn<N> {
  LawColumn<N> column{step.held(b), step.monomial(b, 1)};
  const auto motion = [&](const Column<S, N>& unit) {
    Stroke<S> moves = at_place<first>(place, unit, Motion<S>{});
    if (place == LawPlace::suspension && equations_.has_mount()) moves.velocity = moves.position / period_;
    return moves;
  };
  column.at_held = motion(column.held);
  column.at_ramp = motion(column.ramp);
  return column;
}

/// Adds the laws to the step that led to x without them, one place after the other. A motion that is prescribed is left
/// to finish_laws().
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <int first, int N>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::apply_laws(const LawColumns<N>& columns, State& x,
                                                                  const Motion<S>& foot_point) const {
  constexpr bool has_wheel = first == CoreIndex::wheel_position;
  constexpr bool has_component = first + N > CoreIndex::piston_travel;
  const auto moves = [this](LawPlace place) {
    if (place == LawPlace::piston) return has_component;
    if (place == LawPlace::suspension) return has_component && (has_wheel || equations_.has_mount());
    return has_wheel;
  };
  Column<S, N> core = x.core.template segment<N>(first);
  for (std::size_t i = 0; i < law_place_count_; ++i) {
    const LawPlace place = law_places_[i];
    if (moves(place)) core += columns[index(place)].held * x.laws.force[index(place)];
  }
  for (std::size_t i = 0; i < law_place_count_; ++i) {
    const LawPlace place = law_places_[i];
    if (!moves(place)) continue;
    const LawColumn<N>& column = columns[index(place)];
    const Stroke<S> free = seen_by_law(place, x, at_place<first>(place, core, foot_point));
    const auto change = laws_.change(place, x.laws, free, column.at_ramp, column.at_held);
    core += (column.ramp + (column.held - column.ramp) * change.weight) * change.delta;
  }
  x.core.template segment<N>(first) = core;
}

/// The laws at the end of a step, or (`start`) where a simulation begins.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::finish_laws(State& x, bool start) const {
  if constexpr (LawsInSteps::possible) {
    for (std::size_t i = 0; i < law_place_count_; ++i) {
      const LawPlace place = law_places_[i];
      const bool prescribed = place == LawPlace::suspension && !joined() && !equations_.has_mount();
      const Stroke<S> motion = prescribed ? x.reached : at_place<0>(place, x.core, x.foot_point);
      if (start) {
        Stroke<S> seen = seen_by_law(place, x, motion);
        if (place == LawPlace::suspension && equations_.has_mount()) seen.velocity = outer_stroke(x).velocity;
        laws_.start(place, x.laws, seen);
      } else {
        laws_.finish(place, x.laws, seen_by_law(place, x, motion));
      }
    }
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::advance_car(State& x, const Input& in) const {
  Packed<S, 4> next = car_.foot_point.times(driven_by(x.foot_point, in.foot_point));
  if (General && has_tyre_law_) car_.tyre.add_to(next, newest_three(x.tyre_load));
  car_.force.add_to(next, {General ? received_at_wheel(x) : x.received_force});
  next = next + car_.state.times(entries<car_states>(x.core, CoreIndex::wheel_position));
  next.store(x.core.template head<car_states>());
  if constexpr (General && LawsInSteps::possible) {
    if (laws_.at(LawPlace::tyre)) apply_laws<0, car_states>(car_.tables, x, in.foot_point);
  }
  x.foot_point = in.foot_point;
  if (General && has_tyre_law_) x.tyre_load.push(tyre_law(x));
  if (General && law_forces() && !has_machine()) finish_laws(x, false);
}

/// The motion behind delay, lag, resonance and rate limit at the end of the step.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General>
RIGTWIN_INLINE Stroke<S> RigModel<S, D, variant, capacity>::through_machine(State& x, const Stroke<S>& command) const {
  Stroke<S> reached = command;
  if (has_delay_) {
    if constexpr (General && has_extensions && !car_alone) {
      if (rig_.delay_variation.any()) vary_delay(x);
    }
    x.line.push(command);
    reached = x.line.read(period_);
  }
  if (General && machine_.any()) {
    const Stroke<S> delayed = reached;
    reached = machine_.step(x.machine, x.delayed, delayed, x.reached);
    x.delayed = delayed;
  }
  return reached;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_NOINLINE Motion<S> RigModel<S, D, variant, capacity>::through_foot_machine(State& x,
                                                                                   const Motion<S>& command) const {
  if constexpr (car_alone) {
    return command;
  } else {
    x.command = {command.position, command.velocity};
    const Stroke<S> reached = through_machine<true>(x, x.command);
    x.acceleration.step(x.reached, reached, period_);
    x.reached = reached;
    return {reached.position, reached.velocity, x.acceleration.value()};
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::advance_machine(State& x, const Stroke<S>& command) const {
  if (!has_car()) x.command = command;
  const Stroke<S> reached = through_machine<General>(x, command);
  if (General && !equations_.plain()) {
    advance_component<General>(elaborate_component_[static_cast<std::size_t>(x.ducts.open_count())], x, reached);
  } else if (equations_.has_fdva()) {
    advance_component<General>(component_[static_cast<std::size_t>(x.ducts.open_count())], x, reached);
  }
  if constexpr (General && !car_alone) {
    if (has_moving_mass_) x.acceleration.step(x.reached, reached, period_);
  }
  x.reached = reached;
  if constexpr (General) refresh_laws(x);
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General, int N>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::advance_component(const ComponentStep<N>& m, State& x,
                                                                         const Stroke<S>& reached) const {
  Packed<S, N> c = m.state.times(entries<N>(x.core, CoreIndex::piston_travel));
  if (equations_.has_fdva()) m.losses.add_to(c, newest_four(x.ducts.losses()));
  if (General && has_free_play_ && !equations_.has_mount()) {
    // the deflection is prescribed: free play changes what is prescribed
    const Stroke<S> before = offset(x.reached), after = offset(reached);
    c = c +
        m.stroke.times(driven_by(Stroke<S>{x.reached.position + before.position, x.reached.velocity + before.velocity},
                                 Stroke<S>{reached.position + after.position, reached.velocity + after.velocity}));
  } else {
    c = c + m.stroke.times(driven_by(x.reached, reached));
  }
  if (General && equations_.has_mount()) {  // laws and free play act on e, which is free
    if (has_suspension_law_) m.laws.add_to(c, newest_three(x.suspension_load, x.load_jump));
    if (has_free_play_) {
      m.free_play[0].add_to(c, newest_three(x.free_play));
      m.free_play[1].add_to(c, newest_three(x.free_play_rate, x.free_play_jump));
    }
  }
  if (General && (contacts_.any() || law_forces())) {
    const Column<S, core_states> before = x.core;
    c.store(x.core.template segment<N>(CoreIndex::piston_travel));
    if constexpr (LawsInSteps::possible) {
      if (law_forces()) apply_laws<CoreIndex::piston_travel, N>(m.tables, x, x.foot_point);
    }
    if (contacts_.any()) apply_friction(m.friction, x, before);
  } else {
    c.store(x.core.template segment<N>(CoreIndex::piston_travel));
  }
  if (equations_.has_fdva()) x.ducts.advance(x.core(CoreIndex::piston_velocity), duct_step_);
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::open_ducts(State& x, OpenDucts open) const {
  require(equations_.has_fdva() && (open >> equations_.fdva().ducts) == 0, "only installed ducts can be opened");
  if (open != x.ducts.open())
    x.core(CoreIndex::piston_velocity) = x.ducts.switch_to(open, x.core(CoreIndex::piston_velocity), duct_step_);
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::tyre_law(const State& x) const {
  const S deflection = x.foot_point.position - x.core(CoreIndex::wheel_position);
  const S linear =
      equations_.tyre_force(x.core.template head<car_states>(), x.foot_point.position, x.foot_point.velocity);
  S force = linear;
  rig_.effects.for_each([&](const auto& slot) {
    if constexpr (requires { slot.effect.tyre_force(force, deflection, static_load_); }) {
      if (slot.active) force = slot.effect.tyre_force(force, deflection, static_load_);
    }
  });
  return force - linear;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::suspension_law(const Stroke<S>& seen) const {
  S force = S(0);
  rig_.effects.for_each([&](const auto& slot) {
    if constexpr (requires { slot.effect.suspension_force(seen.position, seen.velocity); }) {
      if (slot.active) force += slot.effect.suspension_force(seen.position, seen.velocity);
    }
  });
  return force;
}

/// The laws with memory after the travel that led to this deflection.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::history_law(State& x, S deflection) const {
  S sum = S(0);
  if constexpr (!car_alone) {
    const S travel = deflection - x.history.at;
    std::size_t i = 0;
    rig_.effects.for_each([&](const auto& slot) {
      if constexpr (requires { slot.effect.force_after(travel, travel); }) {
        S& force = x.history.force[i++];
        if (slot.active) sum += force = slot.effect.force_after(force, travel);
      }
    });
    x.history.at = deflection;
  }
  return sum;
}

/// The part of an inner stroke that free play takes: all of it inside, half the gap outside.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
Stroke<S> RigModel<S, D, variant, capacity>::offset(const Stroke<S>& inner) const {
  const S half = S(0.5) * equations_.suspension().free_play;
  const auto above = inner.position > half, below = inner.position < -half;
  return {select(above, S(-half), select(below, half, S(-inner.position))),
          select(above || below, S(0), S(-inner.velocity))};
}

/// Returns θ − ½ where free play began or ended in this step, after the share θ of it, and 0 in all other steps.
///
/// There δ̇ and the laws of the component jump from a to b. A sample counts with a whole period, so that the samples at
/// both ends of the step hold as much as a jump at θ = ½:
///
///   θ a + (1 − θ) b = (a + b)/2 + (θ − ½)(a − b),   1 − θ = |(|e| − g/2)/(ė h)|
///
/// The last term, added to the newest sample, makes the impulse of a knock right to second order.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::jump_share(const State& x, const Stroke<S>& inner) const {
  const S half = S(0.5) * equations_.suspension().free_play;
  const S distance = absolute(inner.position);
  const auto outside = distance > half;
  const S was = select(inside_free_play(x), S(1), S(0)), is = select(outside, S(0), S(1));
  const S beyond = absolute(distance - half), moved = absolute(inner.velocity * period_);
  const auto in_this_step = beyond < moved;
  const S since = select(in_this_step, beyond / select(in_this_step, moved, S(1)), S(1));  // 1 − θ
  return absolute(is - was) * (S(0.5) - since);
}

/// e and ė: behind the top mount, before the free play.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
Stroke<S> RigModel<S, D, variant, capacity>::inner_stroke(const State& x) const {
  if (!equations_.has_mount()) return outer_stroke(x);
  const auto rate =
      equations_.component(x.core.template tail<component_states>(), component_input(x), x.ducts.open_count());
  return {x.core(CoreIndex::inner_deflection), rate(ComponentIndex::inner_deflection)};
}

/// ė of (5b) with the laws of this instant, c ė + F(e, ė) + others = c ė₀ + before, where ė₀ is that of (5b) with the
/// loads of the step before. With these alone a damping law would be late by up to a step. Newton's method: of
/// v|v| four steps leave 1e-6 where the loads before were half wrong. A law that falls with ė has the slope c.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::inner_velocity(const Stroke<S>& with_loads_before, S before, S others) const {
  constexpr int rounds = 4;
  const S difference = S(1e-4);  // [m/s]
  const S damping = equations_.inner_damping();
  const S wanted = damping * with_loads_before.velocity + before - others;
  Stroke<S> seen = with_loads_before;
  for (int i = 0; i < rounds; ++i) {
    const S force = suspension_law(seen);
    const S rise = (suspension_law({seen.position, seen.velocity + difference}) - force) / difference;
    seen.velocity -= (damping * seen.velocity + force - wanted) / (damping + select(rise > S(0), rise, S(0)));
  }
  return seen.velocity;
}

/// The loads of this instant on the component.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
auto RigModel<S, D, variant, capacity>::component_input(const State& x) const -> typename Equations::ComponentInput {
  const Stroke<S> outside = outer_stroke(x);
  S parallel = x.friction[Friction::suspension];
  S piston = x.friction[Friction::piston];
  if (has_suspension_law_) parallel += x.suspension_load.now;
  if (law_forces()) {
    parallel += law_force(x, LawPlace::suspension);
    piston += law_force(x, LawPlace::piston);
  }
  return {.deflection = outside.position,
          .velocity = outside.velocity,
          .minor_losses = x.ducts.losses().now,
          .piston_friction = piston,
          .parallel_force = parallel,
          .free_play = x.free_play.now,
          .free_play_rate = x.free_play_rate.now};
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::refresh_laws(State& x) const {
  if (has_tyre_law_ && joined()) x.tyre_load.push(tyre_law(x));
  if (has_suspension_law_ || has_free_play_) {
    Stroke<S> seen = inner_stroke(x);
    S knock = S(0);  // θ − ½ of jump_share()
    if (lever_joined()) {
      const Stroke<S> travel = component_stroke(seen);
      x.free_play.push(travel.position - seen.position);
      x.free_play_rate.push(travel.velocity - seen.velocity);
      seen = travel;
    } else if (has_free_play_) {
      const Stroke<S> taken = offset(seen);
      knock = jump_share(x, seen);
      x.free_play.push(taken.position);
      push_jumping(x.free_play_rate, x.free_play_jump, taken.velocity, knock);
      seen = {seen.position + taken.position, seen.velocity + taken.velocity};
    }
    if (has_suspension_law_) {
      const S history = history_law(x, seen.position);
      const S air = has_air_spring() ? air_spring_law(x, seen.position) : S(0);
      if (equations_.has_mount() && !has_free_play_) {
        seen.velocity = inner_velocity(seen, x.suspension_load.now, history + air);
      }
      S load = suspension_law(seen) + history;
      if (has_air_spring()) load += air;
      if (lever_joined()) load += lever_law(x, load);
      push_jumping(x.suspension_load, x.load_jump, load, knock);
    }
  }
  if (law_forces()) finish_laws(x, false);
}

/// The force of the air spring at the end of a step, less its linear part.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::air_spring_law(State& x, S deflection) const {
  if constexpr (has_extensions && !car_alone) {
    air_spring_.step(x.air_spring, deflection);
    return x.air_spring.force;
  } else {
    return S(0);
  }
}

/// What a lever adds to the force of the component behind it. `parallel`: laws of the component.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::lever_law(const State& x, S parallel) const {
  if constexpr (has_extensions && !car_alone) {
    const Stroke<S> d = deflection(x);
    const S force =
        equations_.component_force(x.core.template tail<component_states>(), {.deflection = d.position,
                                                                              .velocity = d.velocity,
                                                                              .parallel_force = parallel,
                                                                              .free_play = x.free_play.now,
                                                                              .free_play_rate = x.free_play_rate.now});
    return lever_.force(d.position, force) - force;
  } else {
    return S(0);
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::vary_delay(State& x) const {
  if constexpr (has_extensions && !car_alone) {
    const S delay = delay_ + rig_.delay_variation.deviation(x.steps, period_) / period_;
    x.line.jump(select(delay > S(0), delay, S(0)));
  }
}

/// Laws with memory begin without a force.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::start_history(State& x) const {
  if constexpr (!car_alone) {
    const S inner = equations_.has_mount() ? x.core(CoreIndex::inner_deflection) : outer_stroke(x).position;
    x.history = {.force = {}, .at = has_free_play_ ? S(inner + offset(Stroke<S>{inner, S(0)}).position) : inner};
    if constexpr (has_extensions) {
      if (lever_joined()) x.history.at = component_stroke({inner, S(0)}).position;
      if (has_air_spring()) {
        const S velocity = outer_stroke(x).velocity;
        const bool settled = !(velocity < S(0)) && !(velocity > S(0));
        x.air_spring = air_spring_.start(x.history.at, settled);
      }
    }
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
void RigModel<S, D, variant, capacity>::start_laws(State& x) const {
  if (has_tyre_law_ && has_car()) x.tyre_load.start(tyre_law(x));
  start_history(x);
  constexpr int samples = 4;  // now, before, earlier, earliest
  for (int i = 0; i < samples; ++i) {
    refresh_laws(x);
    if (equations_.has_fdva()) {
      x.ducts.advance(x.core(CoreIndex::piston_velocity),
                      typename DuctFlows<S>::Step{.decay = Pair<S>::both(S(1)), .piston_area = duct_step_.piston_area});
    }
  }
  if (law_forces()) finish_laws(x, true);
}

/// F of a test machine's component. Where the deflection is prescribed dry friction follows the sign of its velocity.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
template <bool General>
RIGTWIN_INLINE S RigModel<S, D, variant, capacity>::component_force(const State& x) const {
  if (!General) return equations_.plain_force(x.core(CoreIndex::piston_travel), x.reached.position, x.reached.velocity);
  return prescribed_force(x);
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_NOINLINE S RigModel<S, D, variant, capacity>::prescribed_force(const State& x) const {
  S force = equations_.component_force(x.core.template tail<component_states>(), component_input(x));
  if (equations_.has_mount()) return force;
  const S friction = contacts_.limits()[Friction::suspension];
  if (same(friction > S(0))) {
    const S velocity = x.reached.velocity + x.free_play_rate.now;
    force = select(velocity > S(0), S(force + friction), select(velocity < S(0), S(force - friction), force));
  }
  return force;
}

/// Of the mass between load cell and component.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_INLINE S RigModel<S, D, variant, capacity>::inertia_force(const State& x) const {
  if constexpr (car_alone) {
    return S(0);
  } else {
    return has_moving_mass_ ? moving_mass_ * x.acceleration.value() : S(0);
  }
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_INLINE S RigModel<S, D, variant, capacity>::suspension_force(const State& x) const {
  if (!joined()) return has_machine() ? component_force<true>(x) : x.received_force;
  if (!needs_general_step_) {
    const Stroke<S> d = deflection(x);
    return equations_.plain_force(x.core(CoreIndex::piston_travel), d.position, d.velocity) + x.actuator_force;
  }
  return equations_.component_force(x.core.template tail<component_states>(), component_input(x)) + x.actuator_force;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
Signals<S> RigModel<S, D, variant, capacity>::signals(const State& x) const {
  return channels(x, has_machine() ? component_force<true>(x) : x.received_force, S(0));
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
Signals<S> RigModel<S, D, variant, capacity>::measured(const State& x, const Signals<S>* noise) const {
  Signals<S> s = channels(x, x.received_force, mass_beyond_sensor_);
  if (law_readings()) show_by_laws(s);
  if (noise != nullptr) {
    for (std::size_t c = 0; c < channel_count; ++c) s[c] += (*noise)[c];
    if (!joined() && has_machine()) s[index(Channel::F)] = x.received_force;  // got its noise in the step
  }
  if constexpr (has_sensors) {
    if (sensors_.any()) sensors_.read(x.sensors, s);
  }
  return s;
}

/// `force`: F of a rig with a test machine; `mass_beyond`: between the sensor of F_w and the wheel spring.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_INLINE Signals<S> RigModel<S, D, variant, capacity>::channels(const State& x, S force, S mass_beyond) const {
  if constexpr (may_be_driven) {
    if (driven_by_force()) return driven_channels(x);
  }
  Signals<S> s;
  if (joined()) {
    fill_car(s, x, suspension_force(x), mass_beyond);
    s[index(Channel::x_cmd)] = s[index(Channel::x_act)] = s[index(Channel::F)] = S(0);
    s[index(Channel::z_cmd)] = has_foot_machine_ ? x.command.position : x.foot_point.position;
    return s;
  }
  if (has_car()) {
    fill_car(s, x, received_at_wheel(x), mass_beyond);
    s[index(Channel::z_cmd)] = S(0);
    s[index(Channel::x_cmd)] = component_stroke({s[index(Channel::dz_b)], S(0)}).position;
  } else {
    s.fill(S(0));
    s[index(Channel::x_cmd)] = x.command.position;
  }
  s[index(Channel::x_act)] = x.reached.position;
  s[index(Channel::F)] = force;
  return s;
}

/// Of a driven_mass: x = d and (10) as a car whose body is driven.
template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_NOINLINE Signals<S> RigModel<S, D, variant, capacity>::driven_channels(const State& x) const {
  Signals<S> s;
  s.fill(S(0));
  const S force = x.foot_point.position;
  const Column<S, car_states> car = x.core.template head<car_states>();
  const Column<S, car_states> rate = equations_.car(car, {.suspension_force = suspension_force(x) - force});
  s[index(Channel::x_act)] = deflection(x).position;
  s[index(Channel::zdd_b)] = -rate(CoreIndex::body_velocity);
  s[index(Channel::F)] = force;
  return s;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_INLINE void RigModel<S, D, variant, capacity>::fill_car(Signals<S>& s, const State& x, S suspension_force,
                                                                S mass_beyond) const {
  S law = has_tyre_law_ ? x.tyre_load.now : S(0);
  S wheel_guide = x.friction[Friction::wheel_guide], body_guide = x.friction[Friction::body_guide];
  if (law_forces()) {
    law += law_force(x, LawPlace::tyre);
    wheel_guide += law_force(x, LawPlace::wheel_guide);
    body_guide += law_force(x, LawPlace::body_guide);
  }
  const Column<S, car_states> car = x.core.template head<car_states>();
  const S z_r = x.foot_point.position, v_r = x.foot_point.velocity;
  const Column<S, car_states> rate = equations_.car(car, {z_r, v_r, suspension_force, law, wheel_guide, body_guide});
  s[index(Channel::z_r)] = z_r;
  s[index(Channel::z_w)] = car(CoreIndex::wheel_position);
  s[index(Channel::z_b)] = car(CoreIndex::body_position);
  s[index(Channel::zdd_r)] = x.foot_point.acceleration;
  s[index(Channel::zdd_w)] = rate(CoreIndex::wheel_velocity);
  s[index(Channel::zdd_b)] = rate(CoreIndex::body_velocity);
  s[index(Channel::dz_w)] = z_r - car(CoreIndex::wheel_position);
  s[index(Channel::dz_b)] = car(CoreIndex::wheel_position) - car(CoreIndex::body_position);
  s[index(Channel::F_w)] = equations_.tyre_force(car, z_r, v_r) + law + mass_beyond * x.foot_point.acceleration;
  s[index(Channel::F_act)] = x.actuator_force;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
S RigModel<S, D, variant, capacity>::energy(const State& x) const {
  S e = S(0);
  Stroke<S> d = x.reached;
  if (joined() || has_car()) {
    e += QuarterCar<S>::energy(equations_.car(), Equations::as_car(x.core.template head<car_states>()),
                               x.foot_point.position);
  }
  if (joined()) d = deflection(x);
  if (joined() || has_machine()) {
    e += S(0.5) * equations_.suspension().stiffness * d.position * d.position;
    if (equations_.has_fdva()) {
      const S spring = d.position - x.core(CoreIndex::piston_travel);
      e += S(0.5) * equations_.fdva().coupling_stiffness * spring * spring +
           x.ducts.energy(x.core(CoreIndex::piston_velocity), duct_step_, equations_.duct().inertance);
    }
  }
  return e;
}

template <class S, std::size_t D, ModelVariant variant, LawCapacity capacity>
RIGTWIN_NOINLINE void RigModel<S, D, variant, capacity>::flush(State& x) const {
  const S least = S(1e-100);
  const auto flush_one = [least](S& value) { value = select(value < least && value > -least, S(0), value); };
  for (int i = 0; i < core_states; ++i) flush_one(x.core(i));
  for (int i = 0; i < Machine<S>::states; ++i) flush_one(x.machine(i));
  flush_one(x.received_force);
  if constexpr (LawsInSteps::possible) laws_.flush(x.laws, least);
  if constexpr (has_extensions && !car_alone) {
    if (has_air_spring()) air_spring_.flush(x.air_spring, least);
  }
  for (Stroke<S>* stroke : {&x.command, &x.reached, &x.delayed}) {
    flush_one(stroke->position);
    flush_one(stroke->velocity);
  }
  flush_one(x.foot_point.position);
  flush_one(x.foot_point.velocity);
  if constexpr (!car_alone) {
    x.ducts.flush(least);
    for (S& force : x.history.force) flush_one(force);
    flush_one(x.history.at);
    if constexpr (has_sensors) {
      if (sensors_.any()) sensors_.flush(x.sensors, least);
    }
    const auto at_rest = x.core(CoreIndex::wheel_position) == S(0) && x.core(CoreIndex::body_position) == S(0);
    if (has_delay_ && any_lane(at_rest)) {  // the line would move the rig again
      for (std::size_t i = 0; i < Line::longest && i < 64; ++i) {
        for (S* value : {&x.line.ago(i).position, &x.line.ago(i).velocity}) {
          *value = select(at_rest && *value<least&& * value> - least, S(0), *value);
        }
      }
    }
  }
}

}  // namespace model
