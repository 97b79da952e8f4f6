// The rig: one model, one step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "model/components/air_spring.hpp"
#include "model/components/channel.hpp"
#include "model/components/duct_flows.hpp"
#include "model/components/friction_contacts.hpp"
#include "model/components/machine.hpp"
#include "model/components/sensors.hpp"
#include "model/components/stroke_acceleration.hpp"
#include "model/components/subsystems.hpp"
#include "model/laws/placed_laws.hpp"
#include "model/numerics/delay_line.hpp"
#include "model/numerics/motion.hpp"
#include "model/numerics/pair.hpp"
#include "model/numerics/require.hpp"
#include "model/numerics/select.hpp"
#include "model/rig/rig_equations.hpp"
#include "model/rig/rig_parameters.hpp"
#include "model/rig/state_index.hpp"

namespace model {

/// The part of a rig that a model computes.
enum class ModelledPart : unsigned char {
  whole_rig,     ///< everything: simulation, identification
  virtual_car,   ///< hil: the car alone, its suspension force is measured (the firmware)
  test_machine,  ///< hil: machine and component alone, the deflection is commanded (the simulated rig)
};

/// The parts that a model can compute. The others cost neither code nor memory.
enum class ModelVariant : unsigned char {
  every_part,   ///< every part of every kind of rig: simulation, identification
  virtual_car,  ///< the virtual car alone, without machine, component, sensors and delay line: the controller
};

inline constexpr std::size_t usual_delay_capacity = 512;  ///< [samples] of the machine's delay line

/// Stands for a part that a variant of the model does not have.
template <class Part>
struct Without {};

/// Why parameters cannot be a rig: `table`.`key` must be `expected`.
struct RigFault {
  std::string_view table;
  std::string_view key;
  std::string_view expected;
  std::optional<Channel> channel{};  ///< of a sensor effect
  struct Bounds {
    double lower, upper;
  };
  std::optional<Bounds> bounds{};  ///< that an effect's parameter violates
};

/// The first fault of `rig` with this period [s] and this delay capacity [samples]; nullopt: none.
template <class S, LawCapacity laws>
[[nodiscard]] std::optional<RigFault> find_fault(const RigParameters<S, laws>& rig, S period,
                                                 std::size_t longest_delay);

/// A rig of any kind with its effects, in fixed steps.
///
/// Equations: RigEquations (1)–(9), Machine, Sensors, the catalogue of effects. A step takes the values of the inputs
/// at its end, knows those at its start, and costs the same whatever they are:
///
/// * Linear part: exact (ExactDiscretisation). The foot point and the deflection of a test machine move on the cubic
///   Hermite polynomial through position and velocity of both samples; F_act goes straight from sample to sample; the
///   force measured by a hardware-in-the-loop controller is held.
/// * Duct losses: explicit, fourth order; free play, laws of suspension and tyre: explicit, third order, which bears
///   stiffer laws (exponential Adams–Bashforth). Global error ∝ h⁴ and h³, smaller by the ratio of the nonlinear to the
///   linear force; at a kink of a law ∝ h².
/// * Dry friction: implicit, sharp (FrictionContacts).
/// * Laws from tables: implicit, second order (PlacedLaws).
/// * Air spring: its k is part of the linear part, the rest an explicit law, third order; a lever's offset and force
/// are
///   such laws, too.
///
/// Kinds of rig and their parts:
///   quarter_car, whole_rig      foot_point, actuator_force → z_r … dz_b, F_w; with effects of the machine foot_point
///   is
///                               z_cmd, and z_r what the machine reaches (z̈_r: StrokeAcceleration)
///   hil, whole_rig              foot_point → car with F held → x_cmd → machine → component → F, once around a period
///   hil, virtual_car            foot_point, receive_force → x_cmd = deflection()
///   hil, test_machine           command → x_act, F
///   component_bench, whole_rig  command → x_act, F
///   driven_mass, whole_rig      foot_point: F [N] and its rate → x_act, zdd_b
///
/// Memory: all inside; DelayCapacity [samples] bounds the delay of the machine. After every 64 steps values that have
/// decayed below 1e-100 become zero: a rig at rest never computes with denormal numbers.
template <class S = double, std::size_t DelayCapacity = usual_delay_capacity,
          ModelVariant variant = ModelVariant::every_part, LawCapacity capacity = law_capacity<S>>
class RigModel {
 public:
  using Line = DelayLine<Stroke<S>, DelayCapacity, S>;
  using Rig = RigParameters<S, capacity>;
  using LawsInSteps = PlacedLaws<S, capacity>;
  static constexpr bool car_alone = variant == ModelVariant::virtual_car;
  template <class Part>
  using UnlessCarAlone = std::conditional_t<car_alone, Without<Part>, Part>;
  static constexpr bool has_extensions = capacity.extensions;
  /// A microcontroller, whose programs have no laws of their own accord, has no mass that a force drives.
  static constexpr bool may_be_driven = !car_alone && usual_laws != no_laws;
  template <class Part>
  using IfExtensions = std::conditional_t<has_extensions, Part, Without<Part>>;
  template <class Part>
  using IfAirSpring = std::conditional_t<has_extensions && !car_alone, Part, Without<Part>>;
  static constexpr bool has_sensors = !car_alone && lane_count<S> == 1;
  /// Rigs side by side are simulated without the effects of sensors: these act on a channel afterwards.
  template <class Part>
  using IfSensors = std::conditional_t<has_sensors, Part, Without<Part>>;

  /// Inputs at the end of a step.
  struct Input {
    Motion<S> foot_point{};  ///< z_r, ż_r, z̈_r; z_cmd of a quarter car with a machine; F, Ḟ of a driven_mass
    Stroke<S> command{};     ///< x_cmd, ẋ_cmd of a test machine without car
    S actuator_force{};      ///< F_act [N]
    /// Noise of each sensor at the end of the step; nullptr: none. It passes through sensors that have effects, and
    /// around the loop of a hil rig.
    const Signals<S>* noise = nullptr;
  };

  /// Of effects with memory: the force of each, and the deflection that it belongs to.
  struct History {
    std::array<S, history_laws> force{};
    S at{};
  };

  /// Everything that changes. A copy keeps the instant.
  struct State {
    Column<S, core_states> core = Column<S, core_states>::Zero();  ///< entries: CoreIndex
    Motion<S> foot_point{};
    Stroke<S> command{};  ///< x_cmd; z_cmd
    Stroke<S> reached{};  ///< x_act; z_r behind a machine
    S actuator_force{};   ///< F_act [N]
    S received_force{};   ///< F as the car got it [N]
    DuctFlows<S> ducts{};
    Recent<S> tyre_load{}, suspension_load{};  ///< of laws, added to (3) and (5) [N]
    typename FrictionContacts<S>::Forces friction{};
    [[no_unique_address]] typename LawsInSteps::State laws{};
    [[no_unique_address]] IfAirSpring<typename AirSpring<S>::State> air_spring{};
    [[no_unique_address]] UnlessCarAlone<Line> line{};
    Stroke<S> delayed{};  ///< x_cmd behind the delay
    typename Machine<S>::State machine = Machine<S>::State::Zero();
    [[no_unique_address]] UnlessCarAlone<History> history{};
    Recent<S> free_play{}, free_play_rate{};  ///< δ [m], δ̇ [m/s]
    S free_play_jump{}, load_jump{};  ///< [m/s], [N] added to the newest δ̇ and load where they drive: jump_share()
    [[no_unique_address]] UnlessCarAlone<StrokeAcceleration<S>>
        acceleration{};  ///< ẍ_act, with a moving mass only; z̈_r behind a machine
    [[no_unique_address]] IfSensors<typename Sensors<S>::State> sensors{};
    std::uint32_t steps = 0;
  };

  RigModel(const Rig& rig, S period,
           ModelledPart part = car_alone ? ModelledPart::virtual_car : ModelledPart::whole_rig);

  /// At rest in the static equilibrium above a foot point at `z_r`, or with the machine resting at `deflection` (the
  /// component included: its coil spring is relaxed by the piston's travel y = deflection).
  [[nodiscard]] State start(S z_r = S(0), S deflection = S(0)) const;

  /// In mid-motion: car and piston as given, relaxation and top mount settled, machine as if it had always moved on
  /// with its present velocity. `foot_point`: as in Input.
  [[nodiscard]] State start(const Column<S, plain_core_states>& core, const Motion<S>& foot_point,
                            const Stroke<S>& reached) const;

  /// One period.
  void step(State& x, const Input& in) const;

  /// virtual_car: the force measured at this instant [N], held until the next.
  void receive_force(State& x, S force) const { x.received_force = force; }

  /// Opens and closes ducts at this instant.
  void open_ducts(State& x, OpenDucts open) const;

  /// From now on the machine's delay slides to `delay` [s].
  void set_delay(State& x, S delay) const {
    if constexpr (!car_alone) x.line.set(delay / period_);
  }

  /// From now on the area of the air spring goes to `area` (relative change). A rig that has its body and a skyhook
  /// commands it itself.
  void command_area(State& x, S area) const {
    if constexpr (has_extensions && !car_alone) x.air_spring.command = area;
  }

  /// True values at this instant.
  [[nodiscard]] Signals<S> signals(const State& x) const;
  /// The readings of the rig's sensors at this instant; `noise`: as in the Input of the step that led here.
  [[nodiscard]] Signals<S> measured(const State& x, const Signals<S>* noise = nullptr) const;
  /// z_w − z_b and its rate.
  [[nodiscard]] Stroke<S> deflection(const State& x) const {
    return {x.core(CoreIndex::wheel_position) - x.core(CoreIndex::body_position),
            x.core(CoreIndex::wheel_velocity) - x.core(CoreIndex::body_velocity)};
  }
  /// The travel of a component at this suspension deflection: behind the lever, if there is one.
  [[nodiscard]] Stroke<S> component_stroke(const Stroke<S>& d) const {
    if constexpr (has_extensions) {
      if (rig_.lever.any()) return lever_.over(d);
    }
    return d;
  }
  /// The acceleration of that travel, where the suspension deflection has this acceleration.
  [[nodiscard]] S component_acceleration(const Stroke<S>& d, S acceleration) const {
    if constexpr (has_extensions) {
      if (rig_.lever.any()) {
        return lever_.ratio(d.position) * acceleration + lever_.slope(d.position) * d.velocity * d.velocity;
      }
    }
    return acceleration;
  }
  /// Force of the component on the body, true value [N].
  [[nodiscard]] S suspension_force(const State& x) const;
  /// Stored energy of masses, springs and oil [J].
  [[nodiscard]] S energy(const State& x) const;

  /// Behind the delay of the test machine.
  [[nodiscard]] const UnlessCarAlone<Machine<S>>& machine() const { return machine_; }
  [[nodiscard]] const RigEquations<S>& equations() const { return equations_; }
  [[nodiscard]] const Rig& parameters() const { return rig_; }
  /// A quarter car whose foot point is moved by a machine with effects: z_r is not z_cmd.
  [[nodiscard]] bool has_foot_machine() const { return has_foot_machine_; }
  [[nodiscard]] S period() const { return period_; }
  [[nodiscard]] ModelledPart part() const { return part_; }

 private:
  using Equations = RigEquations<S>;
  using Friction = FrictionContacts<S>;
  static constexpr std::size_t counts = duct_capacity + 1;  ///< 0 … 6 ducts open

  /// By place: force held at f₀, and its change Δ, straight through the step.
  template <int N>
  struct LawColumn {
    Column<S, N> held = Column<S, N>::Zero(), ramp = held;
    Stroke<S> at_held{}, at_ramp{};  ///< motion of the place itself
  };
  template <int N>
  using LawColumns = std::array<LawColumn<N>, force_places>;
  template <int N>
  using IfLaws = std::conditional_t<LawsInSteps::possible, LawColumns<N>, Without<LawColumns<N>>>;

  struct CarStep {
    PackedColumns<S, car_states, car_states> state;
    PackedColumns<S, car_states, 4> foot_point;
    PackedColumns<S, car_states, 1> force;
    PackedColumns<S, car_states, 3> tyre;
    [[no_unique_address]] IfLaws<car_states> tables{};
  };
  template <int N>  // plain_component_states or component_states
  struct ComponentStep {
    PackedColumns<S, N, N> state;
    PackedColumns<S, N, 4> stroke;
    PackedColumns<S, N, 4> losses;
    PackedColumns<S, N, 3> laws;
    std::array<PackedColumns<S, N, 3>, 2> free_play;
    Block<S, N, Friction::contacts> friction;
    [[no_unique_address]] IfLaws<N> tables{};
  };
  template <int N>  // plain_core_states or core_states
  struct JoinedStep {
    PackedColumns<S, N, N> state;
    PackedColumns<S, N, 4> foot_point;
    PackedColumns<S, N, 2> actuator;
    PackedColumns<S, N, 4> losses;
    PackedColumns<S, N, 3> suspension, tyre;
    std::array<PackedColumns<S, N, 3>, 2> free_play;
    Block<S, N, Friction::contacts> friction;
    [[no_unique_address]] IfLaws<N> tables{};
  };

  [[nodiscard]] bool driven_by_force() const { return may_be_driven && rig_.kind == RigKind::driven_mass; }
  /// Body and component move together.
  [[nodiscard]] bool joined() const {
    return !car_alone && (rig_.kind == RigKind::quarter_car || rig_.kind == RigKind::driven_mass);
  }
  [[nodiscard]] bool has_car() const {
    return car_alone || (rig_.kind == RigKind::hil && part_ != ModelledPart::test_machine);
  }
  [[nodiscard]] bool has_air_spring() const { return !car_alone && rig_.air_spring.fitted; }
  [[nodiscard]] bool has_lever() const { return rig_.lever.any(); }
  /// The lever is part of the equations of motion, and not between two programs.
  [[nodiscard]] bool lever_joined() const { return joined() && has_lever(); }
  /// Force at the wheel of a measured force of the component.
  [[nodiscard]] RIGTWIN_INLINE S received_at_wheel(const State& x) const {
    if constexpr (has_extensions) {
      if (has_lever()) return lever_.force(deflection(x).position, x.received_force);
    }
    return x.received_force;
  }
  [[nodiscard]] bool any_sensor() const {
    if constexpr (has_sensors) {
      return sensors_.any();
    } else {
      return false;
    }
  }
  [[nodiscard]] bool has_machine() const { return !car_alone && !joined() && part_ != ModelledPart::virtual_car; }

  [[nodiscard]] CarStep car_step() const;
  template <int N>
  [[nodiscard]] ComponentStep<N> component_step(int open) const;
  template <int N>
  [[nodiscard]] JoinedStep<N> joined_step(int open) const;

  void general_step(State& x, const Input& in) const;
  template <bool General>
  void advance(State& x, const Input& in) const;
  template <bool General>
  void advance_rig(State& x, const Input& in) const;
  template <bool General, int N>
  void advance_joined(const JoinedStep<N>& m, State& x, const Input& in, const Motion<S>& foot_point) const;
  template <bool General>
  void advance_car(State& x, const Input& in) const;
  template <bool General>
  void advance_machine(State& x, const Stroke<S>& command) const;
  template <bool General>
  [[nodiscard]] Stroke<S> through_machine(State& x, const Stroke<S>& command) const;
  [[nodiscard]] Motion<S> through_foot_machine(State& x, const Motion<S>& command) const;
  template <bool General, int N>
  void advance_component(const ComponentStep<N>& m, State& x, const Stroke<S>& reached) const;
  template <int N>
  void apply_friction(const Block<S, N, Friction::contacts>& columns, State& x,
                      const Column<S, core_states>& before) const;
  template <int first, int N>
  void apply_laws(const LawColumns<N>& columns, State& x, const Motion<S>& foot_point) const;
  void finish_laws(State& x, bool start) const;
  void find_law_places();
  template <int first, int N>
  [[nodiscard]] LawColumn<N> law_column(const ExactDiscretisation<S, N>& step, LawPlace place,
                                        const Column<S, N>& b) const;
  template <int first, class Part>
  [[nodiscard]] Stroke<S> at_place(LawPlace place, const Part& part, const Motion<S>& foot_point) const;
  [[nodiscard]] Stroke<S> seen_by_law(LawPlace place, const State& x, Stroke<S> motion) const;
  /// What a sensor with a curve of its own shows; F gets it in the step, because it goes around the loop.
  [[nodiscard]] S shown_by_law(Channel channel, S truth) const {
    if constexpr (LawsInSteps::possible) {
      if (laws_.at(LawPlace::sensor)) return laws_.reading(channel, truth);
    }
    return truth;
  }
  void show_by_laws(Signals<S>& s) const {
    for (std::size_t c = 0; c < channel_count; ++c) {
      if (channel_at(c) != Channel::F) s[c] = shown_by_law(channel_at(c), s[c]);
    }
  }
  [[nodiscard]] Signals<S> shown_by_laws(Signals<S> s) const {
    if (law_readings()) show_by_laws(s);
    return s;
  }
  [[nodiscard]] bool law_forces() const { return LawsInSteps::possible && law_place_count_ > 0; }
  [[nodiscard]] bool law_readings() const { return LawsInSteps::possible && has_law_readings_; }
  [[nodiscard]] S law_force(const State& x, LawPlace place) const {
    if constexpr (LawsInSteps::possible) {
      return x.laws.force[index(place)];
    } else {
      return S(0);
    }
  }
  void refresh_laws(State& x) const;
  [[nodiscard]] S air_spring_law(State& x, S deflection) const;
  [[nodiscard]] S lever_law(const State& x, S parallel) const;
  void vary_delay(State& x) const;
  void start_machine(State& x, const Stroke<S>& reached) const;
  void start_behind_mount(State& x) const;
  [[nodiscard]] S ahead_behind_mount(State& x, S inside) const;
  void start_laws(State& x) const;
  void flush(State& x) const;

  [[nodiscard]] Signals<S> channels(const State& x, S force, S mass_beyond) const;
  void fill_car(Signals<S>& s, const State& x, S suspension_force, S mass_beyond) const;
  [[nodiscard]] Signals<S> driven_channels(const State& x) const;
  [[nodiscard]] S tyre_law(const State& x) const;
  [[nodiscard]] S suspension_law(const Stroke<S>& seen) const;
  [[nodiscard]] S history_law(State& x, S deflection) const;
  void start_history(State& x) const;
  [[nodiscard]] Stroke<S> offset(const Stroke<S>& inner) const;
  [[nodiscard]] Stroke<S> outer_stroke(const State& x) const { return joined() ? deflection(x) : x.reached; }
  [[nodiscard]] Stroke<S> inner_stroke(const State& x) const;
  [[nodiscard]] S inner_velocity(const Stroke<S>& with_loads_before, S before, S others) const;
  [[nodiscard]] typename Equations::ComponentInput component_input(const State& x) const;
  /// Free play takes the whole deflection: the component is not deflected.
  [[nodiscard]] auto inside_free_play(const State& x) const {
    const S half = S(0.5) * equations_.suspension().free_play;
    const S taken = x.free_play.now;
    return taken < half && taken > -half;
  }
  [[nodiscard]] S jump_share(const State& x, const Stroke<S>& inner) const;
  static void push_jumping(Recent<S>& samples, S& jump, S value, S share) {
    const S next_jump = share * (samples.now - value);
    samples.now += jump;
    samples.push(value);
    jump = next_jump;
  }
  template <int N>
  [[nodiscard]] RIGTWIN_INLINE static std::array<S, static_cast<std::size_t>(N)> entries(
      const Column<S, core_states>& core, int from) {
    std::array<S, static_cast<std::size_t>(N)> values;
    for (int i = 0; i < N; ++i) values[static_cast<std::size_t>(i)] = core(from + i);
    return values;
  }
  void sense(State& x, const Signals<S>* noise) const;
  template <bool General>
  [[nodiscard]] S component_force(const State& x) const;
  [[nodiscard]] S prescribed_force(const State& x) const;
  [[nodiscard]] S inertia_force(const State& x) const;

  Rig rig_;
  Equations equations_;
  S period_;
  ModelledPart part_;
  S static_load_;
  S delay_;
  S mass_beyond_sensor_;
  S moving_mass_;
  bool has_tyre_law_ = false;
  bool has_suspension_law_ = false;
  bool needs_general_step_ = false;  ///< laws, friction, free play, relaxation, top mount, machine or sensor effects
  bool has_delay_ = false;
  bool has_free_play_ = false;
  bool has_moving_mass_ = false;
  bool has_foot_machine_ = false;
  std::uint8_t law_place_count_ = 0;
  bool has_law_readings_ = false;
  Friction contacts_;
  [[no_unique_address]] UnlessCarAlone<Machine<S>> machine_{};
  [[no_unique_address]] IfSensors<Sensors<S>> sensors_{};
  typename DuctFlows<S>::Step duct_step_{};
  CarStep car_{};
  [[no_unique_address]] UnlessCarAlone<std::array<ComponentStep<plain_component_states>, counts>> component_{};
  [[no_unique_address]] UnlessCarAlone<std::array<JoinedStep<plain_core_states>, counts>> joined_{};
  [[no_unique_address]] UnlessCarAlone<std::array<ComponentStep<component_states>, counts>> elaborate_component_{};
  [[no_unique_address]] UnlessCarAlone<std::array<JoinedStep<core_states>, counts>> elaborate_joined_{};
  std::array<LawPlace, force_places> law_places_{};  ///< that exist in this rig and have laws
  [[no_unique_address]] LawsInSteps laws_{};
  [[no_unique_address]] IfAirSpring<AirSpring<S>> air_spring_{};
  [[no_unique_address]] IfExtensions<Lever<S>> lever_{};
};

/// The computed car of a hil rig, for the controller: RigModel's own code without the other parts.
template <class S = double>
using VirtualCar = RigModel<S, 512, ModelVariant::virtual_car>;

}  // namespace model

#include "model/rig/rig_check.hpp"
#include "model/rig/rig_model_step.hpp"

namespace model {

// Compiled once, in rig_model.cpp and virtual_car.cpp.
extern template std::optional<RigFault> find_fault(const RigParameters<double>& rig, double period,
                                                   std::size_t longest);
extern template class RigModel<double>;
extern template class RigModel<double, 512, ModelVariant::virtual_car>;

}  // namespace model
