#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "tests/truth/sensor.hpp"
#include "tests/truth/signal.hpp"
#include "tests/truth/truth.hpp"

namespace truth {

/// Everything a run needs as plain numbers; 0 is "not there".
struct Numbers {
  Kind kind = Kind::quarter_car;
  double body = 0, wheel = 0, tyre = 0, tyre_damping = 0, spring = 0, damping = 0, virtual_damping = 0;
  bool fdva = false, locked = false;
  double coupling = 0, inertance = 0, laminar = 0, turbulent = 0;  ///< k_c, b, c, c₂ of n equal ducts
  double machine_delay = 0, machine_lag = 0, machine_turn = 0, machine_ratio = 0, machine_velocity = 0;
  double coulomb = 0, quadratic = 0, cubic_spring = 0, clearance = 0, bump = 0, gap = 0, mount = 0;
  double maxwell = 0, maxwell_time = 1, seal = 0;
  double body_friction = 0, wheel_friction = 0, body_damping = 0, wheel_damping = 0;
  bool lift_off = false;
  double tyre_cubic = 0, sensor_mass = 0, moving_mass = 0;
  double lopsided_damping = 0;                           ///< compression less rebound [N s/m]
  double static_friction = 0, stribeck_velocity = 1;     ///< above `coulomb`, decaying with velocity
  double wen = 0, wen_stiffness = 0, wen_unloading = 0;  ///< Bouc–Wen: largest force, initial stiffness, shape
  double wen_loading = 1;  ///< −1: stiffens as it loads, and `wen` is the force under which it is twice as stiff
  double ripple_length = 1, ripple_sine = 0, ripple_cosine = 0;
  // outside the catalogue
  double fade = 0, stiffening = 0;  ///< relative, over the record
  double cubic_damping = 0, asymmetry = 0;
  double parasite = 0, parasite_stiffness = 0, parasite_damping = 0;
  double leaf = 0, lopsided = 0, stroke_damping = 0;  ///< relative; the last two at a deflection of 20 mm
  double tyre_maxwell = 0, tyre_time = 1;
  double imbalance = 0, imbalance_turn = 0;
  double machine_curve = 0;  ///< relative, at a stroke of 20 mm
  // near the catalogue
  double power = 0, exponent = 1;                   ///< F = power |v|^exponent sgn v
  double smooth_friction = 0, smooth_velocity = 1;  ///< F = force tanh(v / velocity)
  double blow_off = 0, blow_off_velocity = 1;       ///< damping, a seventh of it beyond the velocity
  double bristle = 0, bristle_excess = 0, bristle_stiffness = 0, bristle_velocity = 1;  ///< LuGre
  double iwan = 0, iwan_travel = 1;  ///< eight equal elastic sliders: force of all, travel at which the last one slips
  double fractional = 0, fractional_exponent = 0.5;  ///< F = c dᵅx/dtᵅ [N s^α/m]
  double degressive = 0, degressive_velocity = 1;    ///< F = c v/(1 + |v|/w)
  double bypass = 0, bypass_width = 1;               ///< F = damping · bypass · v tanh(x/w)
  double machine_play = 0;                           ///< [m] whole width
  double tyre_drift = 0;                             ///< relative, over the record
  std::vector<Event> events;                         ///< times since the run's begin
};

[[nodiscard]] Numbers numbers_of(const Truth& truth);

/// A rig in motion: Runge–Kutta of order 4 between events. Events are the start and the end of sticking of each
/// friction and the ends of the free play, found by bisection; they are exact, so is the sign function. Corners without
/// a jump of force (bump stop, lift-off, v|v|) are stepped over: their error is of order h² and found by halving the
/// step.
class Rig {
 public:
  enum Index : std::size_t {
    zw,
    vw,
    zb,
    vb,
    y,
    vy,
    d,
    x,
    lag,
    res,
    vres,
    lagged_force,
    up,
    vp,
    wen,
    tyre_x,
    bristle,
    slider,              ///< force of the first of `sliders`, as a share of its limit
    creep = slider + 8,  ///< the first of `creeps`: where the damper of that Maxwell branch is
    state_count = creep + 18
  };
  static constexpr std::size_t sliders = creep - slider, creeps = state_count - creep;
  using State = std::array<double, state_count>;

  /// `force_sensor` is F's in a hil rig, where what it says goes back into the car; else nullptr.
  Rig(const Numbers& numbers, const Signal& signal, double h, double duration, Sensor* force_sensor);

  void step();  ///< one node on
  [[nodiscard]] State& state() { return s_; }

  /// All true values at the present node.
  struct Values {
    double z_r = 0, zdd_r = 0, zdd_w = 0, zdd_b = 0, wheel_load = 0, x_cmd = 0, x_act = 0, force = 0;
  };
  [[nodiscard]] Values values() const;

 private:
  enum Friction : std::size_t { suspension, body_guide, wheel_guide, piston, friction_count };
  struct Modes {
    std::array<int, friction_count> slip{};  ///< −1, 0 stuck, +1
    int play = 0;                            ///< −1, 0 free, +1
  };
  struct Rates {
    State rate{};
    std::array<double, friction_count> held{};  ///< friction force, of a stuck one what holding takes
    double wheel_load = 0, force = 0, x_act = 0, zdd_b = 0, zdd_w = 0;
  };

  /// What the component's own parts see, behind mount and free play.
  struct Deflection {
    double position = 0.0;
    bool friction_held = false;  ///< the component's dry friction sticks
  };

  [[nodiscard]] Rates rates(const State& s, double t) const;
  [[nodiscard]] double elastic(const State& s, double e, double spring) const;  ///< forces of the deflection e alone
  [[nodiscard]] Deflection component(const State& s, double t, double deflection, double velocity, Rates& r) const;
  [[nodiscard]] double undamped_behind_mount(const State& s, double deflection, double spring) const;
  void dissipative(const State& s, double e, double ev, double spring, double damping, Rates& r) const;
  void velocity_laws(const State& s, double ev, Rates& r) const;  ///< near those of the catalogue
  void memory_laws(const State& s, double e, double ev, Rates& r) const;
  [[nodiscard]] double pushed(const char* where, double t) const;  ///< by events [N]
  void piston_rates(const State& s, double e, Rates& r) const;
  [[nodiscard]] double tyre_load(const State& s, double t, const Motion& input, Rates& r) const;
  [[nodiscard]] double felt_force(const State& s, double t, Rates& r) const;  ///< by the virtual car of a hil rig
  /// Friction that slides is known; friction that sticks is the force that keeps the slip velocity at zero.
  void car_rates(const State& s, double t, bool friction_held, Rates& r) const;
  [[nodiscard]] State runge_kutta(double t, double h) const;
  [[nodiscard]] bool broken(const State& s, double t, bool repair);  ///< does the mode still fit? repair: change it
  [[nodiscard]] bool has(std::size_t friction) const;
  [[nodiscard]] double slip_velocity(std::size_t friction, const State& s) const;
  [[nodiscard]] double strength(std::size_t friction, double velocity) const;
  [[nodiscard]] double largest(std::size_t friction) const;
  void machine(const State& s, double t, double u, double uv, double* position, double* velocity, State* rate) const;
  [[nodiscard]] double machine_acceleration(double t, const Rates& r) const;  ///< ẍ_act of a bench without rate limit
  [[nodiscard]] bool located_play() const;
  void remember();

  Numbers n_;
  const Signal& signal_;
  double h_;
  double duration_;
  Sensor* force_sensor_;
  std::size_t node_ = 0;
  bool ideal_ = false;  ///< x_act and F go through nothing that remembers: friction may stick in a hil rig
  State s_{};
  Modes m_;
  double node_x_act_ = 0.0;
  double node_input_ = 0.0;       ///< what the rate limit follows, at the node
  std::vector<Motion> commands_;  ///< x_cmd at the nodes, for the machine's delay
};

}  // namespace truth
