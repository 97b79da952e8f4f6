// The rig: one model, one step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "model/channel.hpp"
#include "model/delay_line.hpp"
#include "model/duct_flows.hpp"
#include "model/friction_contacts.hpp"
#include "model/machine.hpp"
#include "model/motion.hpp"
#include "model/pair.hpp"
#include "model/places.hpp"
#include "model/require.hpp"
#include "model/rig_equations.hpp"
#include "model/rig_parameters.hpp"
#include "model/sensors.hpp"

namespace model {

/// How much of a rig is modelled.
enum class Extent : unsigned char {
  whole_rig,     ///< everything: simulation, identification
  virtual_car,   ///< hil: only the car, its suspension force is measured (the firmware)
  test_machine,  ///< hil: only machine and component, the deflection is commanded (the simulated rig)
};

/// Which of these extents a model can take; what it cannot costs neither code nor memory.
enum class Scope : unsigned char {
  every_extent,  ///< of every kind of rig: simulation, identification
  virtual_car,   ///< Extent::virtual_car alone, no machine, component, sensor or delay line: what a controller carries
};

/// In the place of a part that a model of smaller scope does not have.
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
  std::optional<Bounds> bounds{};  ///< of an effect's parameter, where these are what it is outside of
};

/// nullopt, or the first thing that is wrong with `rig` when it runs with this period [s] and delay capacity [samples].
template <class S>
[[nodiscard]] std::optional<RigFault> find_fault(const RigParameters<S>& rig, S period, std::size_t longest_delay);

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
///
/// Kinds and extents:
///   quarter_car, whole_rig      foot_point, actuator_force → z_r … dz_b, F_w
///   hil, whole_rig              foot_point → car with F held → x_cmd → machine → component → F, once around a period
///   hil, virtual_car            foot_point, receive_force → x_cmd = deflection()
///   hil, test_machine           command → x_act, F
///   component_bench, whole_rig  command → x_act, F
///
/// Memory: all inside; DelayCapacity [samples] bounds the delay of the machine. After every 64 steps what has died away
/// below 1e-100 becomes zero, so that a silent rig never computes with denormal numbers.
template <class S = double, std::size_t DelayCapacity = 512, Scope scope = Scope::every_extent>
class RigModel {
 public:
  using Line = DelayLine<Stroke<S>, DelayCapacity, S>;
  static constexpr bool car_alone = scope == Scope::virtual_car;
  template <class Part>
  using UnlessCarAlone = std::conditional_t<car_alone, Without<Part>, Part>;

  /// Inputs at the end of a step.
  struct Input {
    Motion<S> foot_point{};  ///< z_r, ż_r, z̈_r
    Stroke<S> command{};     ///< x_cmd, ẋ_cmd of a test machine without car
    S actuator_force{};      ///< F_act [N]
    /// What the sensors add to each channel at the end of the step, nullptr for nothing. It passes through sensors that
    /// have effects, and around the loop of a hil rig.
    const Signals<S>* noise = nullptr;
  };

  /// Everything that changes. Copy it to keep an instant.
  struct State {
    Column<S, 8> core = Column<S, 8>::Zero();  ///< z_w, ż_w, z_b, ż_b, y, ẏ, r, e
    Motion<S> foot_point{};
    Stroke<S> command{};  ///< x_cmd
    Stroke<S> reached{};  ///< x_act
    S actuator_force{};   ///< F_act [N]
    S received_force{};   ///< F as the car got it [N]
    DuctFlows<S> ducts{};
    Recent<S> tyre_load{}, suspension_load{};  ///< what laws add to (3) and (5) [N]
    typename FrictionContacts<S>::Forces friction{};
    [[no_unique_address]] UnlessCarAlone<Line> line{};
    Stroke<S> delayed{};  ///< x_cmd behind the delay
    typename Machine<S>::State machine = Machine<S>::State::Zero();
    Recent<S> free_play{}, free_play_rate{};  ///< δ [m], δ̇ [m/s]
    [[no_unique_address]] UnlessCarAlone<typename Sensors<S>::State> sensors{};
    std::uint32_t steps = 0;
  };

  RigModel(const RigParameters<S>& rig, S period, Extent extent = car_alone ? Extent::virtual_car : Extent::whole_rig);

  /// At rest in the static equilibrium above a foot point at `z_r`, or with the machine resting at `deflection` (the
  /// component included: its coil spring is relaxed by the piston's travel y = deflection).
  [[nodiscard]] State start(S z_r = S(0), S deflection = S(0)) const;

  /// In mid-motion: car and piston as given, relaxation and top mount settled, machine as if it had always moved on
  /// with its present velocity.
  [[nodiscard]] State start(const Column<S, 6>& core, const Motion<S>& foot_point, const Stroke<S>& reached) const;

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

  /// True values at this instant.
  [[nodiscard]] Signals<S> signals(const State& x) const;
  /// What the rig's sensors say at this instant; `noise`: as in the Input of the step that led here.
  [[nodiscard]] Signals<S> measured(const State& x, const Signals<S>* noise = nullptr) const;
  /// z_w − z_b and its rate: the deflection a hil rig commands.
  [[nodiscard]] Stroke<S> deflection(const State& x) const { return {x.core(0) - x.core(2), x.core(1) - x.core(3)}; }
  /// Force of the component on the body, true value [N].
  [[nodiscard]] S suspension_force(const State& x) const;
  /// Stored energy of masses, springs and oil [J].
  [[nodiscard]] S energy(const State& x) const;

  /// Behind the delay of the test machine.
  [[nodiscard]] const UnlessCarAlone<Machine<S>>& machine() const { return machine_; }
  [[nodiscard]] const RigEquations<S>& equations() const { return equations_; }
  [[nodiscard]] const RigParameters<S>& parameters() const { return rig_; }
  [[nodiscard]] S period() const { return period_; }
  [[nodiscard]] Extent extent() const { return extent_; }

 private:
  using Equations = RigEquations<S>;
  using Friction = FrictionContacts<S>;
  static constexpr std::size_t counts = duct_capacity + 1;  ///< 0 … 6 ducts open

  struct CarStep {
    PackedColumns<S, 4, 4> state;
    PackedColumns<S, 4, 4> foot_point;
    PackedColumns<S, 4, 1> force;
    PackedColumns<S, 4, 3> tyre;
  };
  template <int N>  // 2: plain, 4: with relaxation or top mount
  struct ComponentStep {
    PackedColumns<S, N, N> state;
    PackedColumns<S, N, 4> stroke;
    PackedColumns<S, N, 4> losses;
    PackedColumns<S, N, 3> laws;
    std::array<PackedColumns<S, N, 3>, 2> free_play;
    Block<S, N, Friction::contacts> friction;
  };
  template <int N>  // 6: plain, 8: with relaxation or top mount
  struct JoinedStep {
    PackedColumns<S, N, N> state;
    PackedColumns<S, N, 4> foot_point;
    PackedColumns<S, N, 2> actuator;
    PackedColumns<S, N, 4> losses;
    PackedColumns<S, N, 3> suspension, tyre;
    std::array<PackedColumns<S, N, 3>, 2> free_play;
    Block<S, N, Friction::contacts> friction;
  };

  [[nodiscard]] bool joined() const { return !car_alone && rig_.kind == RigKind::quarter_car; }
  [[nodiscard]] bool has_car() const {
    return car_alone || (rig_.kind == RigKind::hil && extent_ != Extent::test_machine);
  }
  [[nodiscard]] bool has_machine() const { return !car_alone && !joined() && extent_ != Extent::virtual_car; }

  [[nodiscard]] CarStep car_step() const;
  template <int N>
  [[nodiscard]] ComponentStep<N> component_step(int open) const;
  template <int N>
  [[nodiscard]] JoinedStep<N> joined_step(int open) const;

  void step_with_laws(State& x, const Input& in) const;
  template <bool WithLaws>
  void advance(State& x, const Input& in) const;
  template <bool WithLaws>
  void advance_rig(State& x, const Input& in) const;
  template <bool WithLaws, int N>
  void advance_joined(const JoinedStep<N>& m, State& x, const Input& in) const;
  template <bool WithLaws>
  void advance_car(State& x, const Input& in) const;
  template <bool WithLaws>
  void advance_machine(State& x, const Stroke<S>& command) const;
  template <bool WithLaws, int N>
  void advance_component(const ComponentStep<N>& m, State& x, const Stroke<S>& reached) const;
  template <int N>
  void rub(const Block<S, N, Friction::contacts>& columns, State& x, const Column<S, 8>& before) const;
  void refresh_laws(State& x) const;
  void start_machine(State& x, const Stroke<S>& reached) const;
  void start_laws(State& x) const;
  void flush(State& x) const;

  [[nodiscard]] Signals<S> channels(const State& x, S force, S mass_beyond) const;
  void fill_car(Signals<S>& s, const State& x, S suspension_force, S mass_beyond) const;
  [[nodiscard]] S tyre_law(const State& x) const;
  [[nodiscard]] S suspension_law(const Stroke<S>& seen) const;
  [[nodiscard]] Stroke<S> offset(const Stroke<S>& inner) const;
  [[nodiscard]] Stroke<S> outer_stroke(const State& x) const { return joined() ? deflection(x) : x.reached; }
  [[nodiscard]] Stroke<S> inner_stroke(const State& x) const;
  [[nodiscard]] typename Equations::ComponentDrive component_drive(const State& x) const;
  /// The component sees no deflection: what free play takes away is all there is.
  [[nodiscard]] bool inside_free_play(const State& x) const {
    const S half = S(0.5) * equations_.suspension().free_play;
    const S taken = x.free_play.now;
    return taken < half && taken > -half;
  }
  template <int N>
  [[nodiscard]] RIGTWIN_INLINE static std::array<S, static_cast<std::size_t>(N)> entries(const Column<S, 8>& core,
                                                                                         int from) {
    std::array<S, static_cast<std::size_t>(N)> values;
    for (int i = 0; i < N; ++i) values[static_cast<std::size_t>(i)] = core(from + i);
    return values;
  }
  void sense(State& x, const Signals<S>* noise) const;
  template <bool WithLaws>
  [[nodiscard]] S component_force(const State& x) const;
  [[nodiscard]] S prescribed_force(const State& x) const;

  RigParameters<S> rig_;
  Equations equations_;
  S period_;
  Extent extent_;
  S static_load_;
  S delay_;
  S mass_beyond_sensor_;
  bool has_tyre_law_ = false;
  bool has_suspension_law_ = false;
  bool has_laws_ = false;
  bool has_delay_ = false;
  bool has_free_play_ = false;
  Friction contacts_;
  [[no_unique_address]] UnlessCarAlone<Machine<S>> machine_{};
  [[no_unique_address]] UnlessCarAlone<Sensors<S>> sensors_{};
  typename DuctFlows<S>::Step duct_step_{};
  CarStep car_{};
  [[no_unique_address]] UnlessCarAlone<std::array<ComponentStep<2>, counts>> component_{};
  [[no_unique_address]] UnlessCarAlone<std::array<JoinedStep<6>, counts>> joined_{};
  [[no_unique_address]] UnlessCarAlone<std::array<ComponentStep<4>, counts>> elaborate_component_{};
  [[no_unique_address]] UnlessCarAlone<std::array<JoinedStep<8>, counts>> elaborate_joined_{};
};

/// The car of a hil rig as numbers, for the controller: RigModel's own code, and nothing else of it.
template <class S = double>
using VirtualCar = RigModel<S, 512, Scope::virtual_car>;

}  // namespace model

#include "model/rig_check.hpp"
#include "model/rig_model_step.hpp"

namespace model {

// Compiled once, in rig_model.cpp and virtual_car.cpp.
extern template std::optional<RigFault> find_fault(const RigParameters<double>& rig, double period,
                                                   std::size_t longest);
extern template class RigModel<double>;
extern template class RigModel<double, 512, Scope::virtual_car>;

}  // namespace model
