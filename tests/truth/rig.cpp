#include "tests/truth/rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace truth {
namespace {

constexpr double gravity = 9.81;
using std::numbers::pi;
constexpr double large_stroke = 20e-3;  // [m]

double sign(double v) { return v > 0.0 ? 1.0 : (v < 0.0 ? -1.0 : 0.0); }

/// v with c₁ v + c₂ v|v| + friction·sgn v = r.
double velocity_under(double r, double c1, double c2, double friction) {
  const double rest = std::abs(r) - friction;
  if (rest <= 0.0) return 0.0;
  // The root of c₂ v² + c₁ v − rest without cancellation.
  return sign(r) * 2.0 * rest / (c1 + std::sqrt(c1 * c1 + 4.0 * c2 * rest));
}

/// An effect of the catalogue into the numbers; std::invalid_argument where the rig has no place for it.
void put(const Effect& effect, Numbers& n) {
  const bool car = n.kind == Kind::quarter_car;
  const auto p = [&](const char* key) { return effect.parameters.at(key); };
  const auto only = [&](bool exists) {
    if (!exists) throw std::invalid_argument(effect.name + " does not exist on a " + name_of(n.kind));
  };
  const std::string& name = effect.name;
  if (name == "actuator_delay")
    only(!car), n.machine_delay = p("delay");
  else if (name == "actuator_lag")
    only(!car), n.machine_lag = p("time_constant");
  else if (name == "actuator_resonance")
    only(!car), n.machine_turn = 2.0 * pi * p("frequency"), n.machine_ratio = p("damping_ratio");
  else if (name == "actuator_rate_limit")
    only(!car), n.machine_velocity = p("velocity");
  else if (name == "coulomb_friction")
    n.coulomb = p("force");
  else if (name == "viscous_damping")
    n.damping += p("damping");
  else if (name == "quadratic_damping")
    n.quadratic = p("coefficient");
  else if (name == "progressive_spring")
    n.cubic_spring = p("cubic_stiffness");
  else if (name == "bump_stop")
    n.clearance = p("clearance"), n.bump = p("stiffness");
  else if (name == "backlash")
    n.gap = p("gap");
  else if (name == "top_mount")
    n.mount = p("stiffness");
  else if (name == "relaxation")
    n.maxwell = p("stiffness"), n.maxwell_time = p("time_constant");
  else if (name == "seal_friction")
    only(n.fdva && !n.locked), n.seal = p("force");
  else if (name == "body_guide_friction")
    only(car), n.body_friction = p("force");
  else if (name == "wheel_guide_friction")
    only(car), n.wheel_friction = p("force");
  else if (name == "body_guide_damping")
    only(car), n.body_damping = p("damping");
  else if (name == "wheel_guide_damping")
    only(car), n.wheel_damping = p("damping");
  else if (name == "tyre_lift_off")
    only(n.kind != Kind::component_bench), n.lift_off = true;
  else if (name == "progressive_tyre")
    only(n.kind != Kind::component_bench), n.tyre_cubic = p("cubic_stiffness");
  else if (name == "force_sensor_inertia")
    only(car), n.sensor_mass = p("mass");
  else if (name == "moving_mass")
    only(n.kind == Kind::component_bench), n.moving_mass = p("mass");  // a hil loop would be neutral
  else if (name == "asymmetric_damper")
    n.lopsided_damping = p("difference");
  else if (name == "stribeck_friction")
    n.coulomb = p("sliding"), n.static_friction = p("sliding") * p("excess"), n.stribeck_velocity = p("velocity");
  else if (name == "bouc_wen")
    n.wen = p("force"), n.wen_stiffness = p("stiffness"), n.wen_unloading = p("unloading");
  else if (name == "hardening_hysteresis")
    n.wen = p("force"), n.wen_stiffness = p("stiffness"), n.wen_unloading = p("unloading"), n.wen_loading = -1.0;
  else if (name == "position_ripple")
    n.ripple_length = p("period"), n.ripple_sine = p("sine"), n.ripple_cosine = p("cosine");
  else if (effect.channel.empty())
    throw std::invalid_argument("no such effect: " + name);
}

/// Effects that the catalogue of rigtwin does not hold.
void put_outside(const Truth& truth, Numbers& n) {
  const auto outside = [&](const char* key, double otherwise = 0.0) {
    const auto found = truth.unknown_parameters.find(key);
    return found == truth.unknown_parameters.end() ? otherwise : found->second;
  };
  n.fade = outside("fade");
  n.stiffening = outside("stiffening");
  n.wen = outside("wen_force", n.wen);
  n.wen_stiffness = outside("wen_stiffness", n.wen_stiffness);
  n.coulomb += outside("stribeck_force");
  n.static_friction = outside("stribeck_excess", n.static_friction);
  n.stribeck_velocity = outside("stribeck_velocity", n.stribeck_velocity);
  n.cubic_damping = outside("cubic_damping");
  n.asymmetry = outside("asymmetry");
  n.parasite = outside("parasitic_mass");
  n.parasite_stiffness = outside("parasitic_stiffness");
  n.parasite_damping = outside("parasitic_damping");
  n.leaf = outside("leaf_friction");
  n.lopsided = outside("lopsided");
  n.stroke_damping = outside("stroke_damping");
  n.bypass = outside("bypass");
  n.bypass_width = outside("bypass_width", 1.0);
  n.tyre_maxwell = outside("tyre_maxwell");
  n.tyre_time = outside("tyre_time", 1.0);
  n.imbalance = outside("imbalance");
  n.imbalance_turn = 2.0 * pi * outside("imbalance_frequency");
  n.machine_curve = outside("machine_curve");
  n.power = outside("power");
  n.exponent = outside("exponent", 1.0);
  n.smooth_friction = outside("smooth_friction");
  n.smooth_velocity = outside("smooth_velocity", 1.0);
  n.blow_off = outside("blow_off");
  n.blow_off_velocity = outside("blow_off_velocity", 1.0);
  n.bristle = outside("bristle");
  n.bristle_excess = outside("bristle_excess");
  n.bristle_stiffness = outside("bristle_stiffness");
  n.bristle_velocity = outside("bristle_velocity", 1.0);
  n.iwan = outside("iwan");
  n.iwan_travel = outside("iwan_travel", 1.0);
  n.fractional = outside("fractional");
  n.fractional_exponent = outside("fractional_exponent", 0.5);
  n.degressive = outside("degressive");
  n.degressive_velocity = outside("degressive_velocity", 1.0);
  n.machine_play = outside("machine_play");
}

/// Drifts of parameters and forces from outside during a run.
void put_rough(const Truth& truth, Numbers& n) {
  for (const auto& [path, relative] : truth.rough.drift) {
    if (path == "suspension.damping")
      n.fade -= relative;
    else if (path == "suspension.stiffness")
      n.stiffening += relative;
    else if (path == "tyre.stiffness")
      n.tyre_drift += relative;
    else
      throw std::invalid_argument("drift of " + path + " is not simulated");
  }
  n.events = truth.rough.events;
  for (Event& event : n.events) {
    event.from += truth.records.front().warm;
    event.to += truth.records.front().warm;
  }
}

}  // namespace

Numbers numbers_of(const Truth& truth) {
  Numbers n;
  n.kind = truth.kind;
  const auto value = [&](const char* path) {
    const auto found = truth.actual.find(path);
    return found == truth.actual.end() ? 0.0 : found->second;
  };
  n.body = value("body.mass");
  n.wheel = value("wheel.mass");
  n.tyre = value("tyre.stiffness");
  n.tyre_damping = value("tyre.damping");
  n.spring = value("suspension.stiffness");
  n.damping = value("suspension.damping");
  n.virtual_damping = value("machine.virtual_damping");
  n.fdva = truth.fdva;
  if (n.fdva) {
    const double diameter = value("fdva.duct_diameter");
    const double area = pi * diameter * diameter / 4.0;
    const double piston = value("fdva.piston_area");
    const double density = value("fdva.oil_density");
    const double length = value("fdva.duct_length");
    const double open = value("fdva.open_ducts");
    n.coupling = value("fdva.coupling_stiffness");
    n.locked = open < 1.0;
    if (!n.locked) {
      n.inertance = density * length * piston * piston / (open * area);
      n.laminar = 128.0 * density * value("fdva.oil_viscosity") * length / (pi * std::pow(diameter, 4)) * piston *
                  piston / open;
      n.turbulent = density * value("fdva.minor_loss") / (2.0 * area * area) * std::pow(piston, 3) / (open * open);
    }
  }
  for (const Effect& effect : truth.effects) put(effect, n);
  put_outside(truth, n);
  put_rough(truth, n);
  if (n.moving_mass > 0.0 && (n.machine_velocity > 0.0 || n.machine_curve > 0.0))
    throw std::invalid_argument("moving_mass behind a machine with a rate limit is not simulated");
  if (n.mount > 0.0 && n.gap > 0.0) throw std::invalid_argument("top_mount with backlash is not simulated");
  if (n.mount > 0.0 && n.coulomb > 0.0 && n.damping + n.quadratic <= 0.0)
    throw std::invalid_argument("top_mount with coulomb_friction needs some damping");
  return n;
}

Rig::Rig(const Numbers& numbers, const Signal& signal, double h, double duration, Sensor* force_sensor)
    : n_(numbers), signal_(signal), h_(h), duration_(duration), force_sensor_(force_sensor) {
  ideal_ = n_.kind == Kind::hil && n_.machine_delay <= 0.0 && n_.machine_lag <= 0.0 && n_.machine_turn <= 0.0 &&
           n_.machine_velocity <= 0.0 && n_.machine_play <= 0.0 && !force_sensor_->remembers() &&
           !force_sensor_->lags();
  if (n_.kind == Kind::component_bench) {
    const Motion start = signal_.at(0.0);
    s_[lag] = s_[res] = s_[d] = node_x_act_ = node_input_ = start.position;
  }
  remember();
}

bool Rig::has(std::size_t friction) const {
  switch (friction) {
    case suspension:
      return n_.coulomb > 0.0 && n_.mount <= 0.0 && (n_.kind == Kind::quarter_car || ideal_);
    case body_guide:
      return n_.body_friction > 0.0;
    case wheel_guide:
      return n_.wheel_friction > 0.0;
    default:
      return n_.seal > 0.0;
  }
}

double Rig::slip_velocity(std::size_t friction, const State& s) const {
  switch (friction) {
    case suspension:
      return s[vw] - s[vb];
    case body_guide:
      return s[vb];
    case wheel_guide:
      return s[vw];
    default:
      return s[vy];
  }
}

double Rig::largest(std::size_t friction) const {
  switch (friction) {
    case suspension:
      return n_.coulomb + n_.static_friction;
    case body_guide:
      return n_.body_friction;
    case wheel_guide:
      return n_.wheel_friction;
    default:
      return n_.seal;
  }
}

double Rig::strength(std::size_t friction, double velocity) const {
  if (friction != suspension) return largest(friction);
  const double ratio = velocity / n_.stribeck_velocity;
  return n_.coulomb + (n_.static_friction > 0.0 ? n_.static_friction * std::exp(-ratio * ratio) : 0.0);
}

bool Rig::located_play() const { return n_.gap > 0.0 && (n_.kind == Kind::quarter_car || ideal_); }

void Rig::machine(const State& s, double t, double u, double uv, double* position, double* velocity,
                  State* rate) const {
  if (n_.machine_delay > 0.0) {
    const double past = t - n_.machine_delay;
    if (n_.kind == Kind::component_bench) {
      const Motion m = signal_.at(past);
      u = m.position;
      uv = past < 0.0 ? 0.0 : m.velocity;
    } else {
      const double place = std::clamp(past / h_, 0.0, static_cast<double>(commands_.size() - 1));
      const std::size_t i = std::min(static_cast<std::size_t>(place), commands_.size() < 2 ? 0 : commands_.size() - 2);
      const Motion& p = commands_[i];
      const Motion& q = commands_[std::min(i + 1, commands_.size() - 1)];
      const double w = place - static_cast<double>(i);
      // Cubic through position and velocity at both nodes.
      const double rise = q.position - p.position;
      const double c2 = 3.0 * rise - (2.0 * p.velocity + q.velocity) * h_;
      const double c3 = -2.0 * rise + (p.velocity + q.velocity) * h_;
      u = p.position + w * (p.velocity * h_ + w * (c2 + w * c3));
      uv = p.velocity + w * (2.0 * c2 + w * 3.0 * c3) / h_;
    }
  }
  if (n_.machine_lag > 0.0) {
    uv = (u - s[lag]) / n_.machine_lag;
    (*rate)[lag] = uv;
    u = s[lag];
  }
  if (n_.machine_turn > 0.0) {
    (*rate)[res] = s[vres];
    (*rate)[vres] =
        n_.machine_turn * n_.machine_turn * (u - s[res]) - 2.0 * n_.machine_ratio * n_.machine_turn * s[vres];
    u = s[res];
    uv = s[vres];
  }
  if (n_.machine_velocity > 0.0) {
    constexpr double rounding = 1e-11;  // [m] so that following is not taken for being late
    const double late = node_input_ - node_x_act_;
    const double since = std::max(0.0, t - static_cast<double>(node_) * h_);
    double from = node_x_act_;
    double reach = n_.machine_velocity * since;
    if (std::abs(late) > rounding && (u - from) * sign(late) < reach) {
      // Caught up within this step, and from there on free to turn.
      const double begin = std::abs(late);
      const double share = begin / (begin + reach - (u - from) * sign(late));
      from += sign(late) * share * reach;
      reach *= 1.0 - share;
    }
    if (u > from + reach + rounding) {
      u = from + reach;
      uv = n_.machine_velocity;
    } else if (u < from - reach - rounding) {
      u = from - reach;
      uv = -n_.machine_velocity;
    } else {
      uv = std::clamp(uv, -n_.machine_velocity, n_.machine_velocity);
    }
  }
  if (n_.machine_play > 0.0) {  // what hangs behind follows where the play is used up
    const double behind = std::clamp(node_x_act_, u - 0.5 * n_.machine_play, u + 0.5 * n_.machine_play);
    const bool carried = behind != node_x_act_;
    u = behind;
    if (!carried) uv = 0.0;
  }
  if (n_.machine_curve > 0.0) {
    const double share = n_.machine_curve * u * u / (large_stroke * large_stroke);
    u *= 1.0 - share;
    uv *= 1.0 - 3.0 * share;
  }
  *position = u;
  *velocity = uv;
}

Rig::Rates Rig::rates(const State& s, double t) const {
  Rates r;
  const bool bench = n_.kind == Kind::component_bench;
  const Motion input = signal_.at(t);

  // What deflects the component.
  double deflection = bench ? input.position : s[zw] - s[zb];
  double velocity = bench ? input.velocity : s[vw] - s[vb];
  if (n_.kind != Kind::quarter_car) machine(s, t, deflection, velocity, &deflection, &velocity, &r.rate);
  r.x_act = deflection;

  const Deflection reached = component(s, t, deflection, velocity, r);
  piston_rates(s, reached.position, r);
  if (bench) {
    r.force += pushed("F", t);
    return r;
  }
  r.wheel_load = tyre_load(s, t, input, r);
  car_rates(s, t, reached.friction_held, r);
  return r;
}

double Rig::elastic(const State& s, double e, double spring) const {
  const double branch = n_.fdva ? n_.coupling : 0.0;
  double force = spring * e + branch * (e - s[y]);
  if (n_.cubic_spring != 0.0) force += n_.cubic_spring * e * e * e;
  if (n_.lopsided > 0.0) force += n_.lopsided * spring * e * e / large_stroke;
  if (n_.bump > 0.0) force += n_.bump * std::max(0.0, std::abs(e) - n_.clearance) * sign(e);
  if (n_.maxwell > 0.0) force += n_.maxwell * (e - s[x]);
  return force;
}

Rig::Deflection Rig::component(const State& s, double t, double deflection, double velocity, Rates& r) const {
  const double spring = n_.spring * (1.0 + n_.stiffening * t / duration_);
  const double damping = n_.damping * (1.0 - n_.fade * t / duration_);
  Deflection reached;
  if (n_.mount > 0.0) {
    reached.position = s[d];
    if (damping + n_.quadratic > 0.0) {
      r.force = n_.mount * (deflection - s[d]);
      r.rate[d] = velocity_under(r.force - elastic(s, s[d], spring), damping, n_.quadratic, n_.coulomb);
    } else {
      reached.position = undamped_behind_mount(s, deflection, spring);
      r.force = n_.mount * (deflection - reached.position);
    }
  } else {
    double e = deflection;
    double ev = velocity;
    bool free = false;
    if (n_.gap > 0.0) {
      const int side = located_play() ? m_.play : (std::abs(e) < 0.5 * n_.gap ? 0 : static_cast<int>(sign(e)));
      free = side == 0;
      e = free ? 0.0 : e - side * 0.5 * n_.gap;
      ev = free ? 0.0 : ev;
    }
    reached.position = e;
    r.force = elastic(s, e, spring);
    dissipative(s, e, ev, spring, damping, r);
    if (n_.coulomb > 0.0 && !free) {
      if (has(suspension)) {
        reached.friction_held = m_.slip[suspension] == 0;
        if (!reached.friction_held) r.force += m_.slip[suspension] * strength(suspension, ev);
      } else {
        r.force += sign(ev) * strength(suspension, ev);
      }
    }
  }
  if (n_.maxwell > 0.0) r.rate[x] = (reached.position - s[x]) / n_.maxwell_time;
  return reached;
}

double Rig::undamped_behind_mount(const State& s, double deflection, double spring) const {
  const double branch = n_.fdva ? n_.coupling : 0.0;
  double e = s[d];
  // Newton's method; the sum of the springs is monotone.
  for (int i = 0; i < 30; ++i) {
    const double rest = n_.mount * (deflection - e) - elastic(s, e, spring);
    double stiffness = n_.mount + spring + branch + n_.maxwell + std::max(0.0, 3.0 * n_.cubic_spring * e * e);
    if (n_.bump > 0.0 && std::abs(e) > n_.clearance) stiffness += n_.bump;
    e += rest / stiffness;
    if (std::abs(rest) < 1e-10) break;
  }
  return e;
}

void Rig::dissipative(const State& s, double e, double ev, double spring, double damping, Rates& r) const {
  double& force = r.force;
  const double along_stroke = e * e / (large_stroke * large_stroke);
  const double bypass = n_.bypass * std::tanh(e / n_.bypass_width);
  force += damping * ev * (1.0 + n_.asymmetry * sign(ev) + n_.stroke_damping * along_stroke + bypass);
  constexpr double slow = 1e-3;  // [m/s] below it leaves creep
  if (n_.leaf > 0.0) force += n_.leaf * spring * std::abs(e) * std::tanh(ev / slow);
  force += 0.5 * n_.lopsided_damping * std::abs(ev);
  const double turn = 2.0 * pi * e / n_.ripple_length;
  force += n_.ripple_sine * std::sin(turn) + n_.ripple_cosine * (std::cos(turn) - 1.0);
  force += n_.quadratic * ev * std::abs(ev) + n_.cubic_damping * ev * ev * ev;
  velocity_laws(s, ev, r);
  memory_laws(s, e, ev, r);
  if (n_.wen > 0.0) {
    force += n_.wen * s[wen];
    // ż = (k/F) (v − (l + u)/2 |v| z − (l − u)/2 v |z|): with l = 1 z stays within ± 1.
    const double back = 0.5 * (n_.wen_loading + n_.wen_unloading), on = n_.wen_loading - back;
    r.rate[wen] = n_.wen_stiffness / n_.wen * (ev - back * std::abs(ev) * s[wen] - on * ev * std::abs(s[wen]));
  }
  if (n_.parasite > 0.0) {
    const double pull = n_.parasite_stiffness * (e - s[up]) + n_.parasite_damping * (ev - s[vp]);
    force += pull;
    r.rate[up] = s[vp];
    r.rate[vp] = pull / n_.parasite;
  }
}

void Rig::velocity_laws(const State& s, double ev, Rates& r) const {
  if (n_.power > 0.0) r.force += n_.power * sign(ev) * std::pow(std::abs(ev), n_.exponent);
  if (n_.smooth_friction > 0.0) r.force += n_.smooth_friction * std::tanh(ev / n_.smooth_velocity);
  if (n_.degressive > 0.0) r.force += n_.degressive * ev / (1.0 + std::abs(ev) / n_.degressive_velocity);
  if (n_.blow_off > 0.0) {
    const double slow = std::min(std::abs(ev), n_.blow_off_velocity);
    r.force += n_.blow_off * sign(ev) * (slow + (std::abs(ev) - slow) / 7.0);
  }
  if (n_.bristle > 0.0) {
    // ż = v − σ₀|v| z / g(v), F = σ₀ z; g falls from the largest to the sliding force.
    const double ratio = ev / n_.bristle_velocity;
    const double limit = n_.bristle + n_.bristle_excess * std::exp(-ratio * ratio);
    r.force += n_.bristle_stiffness * s[bristle];
    r.rate[bristle] = ev - n_.bristle_stiffness * std::abs(ev) * s[bristle] / limit;
  }
}

void Rig::memory_laws(const State& s, double e, double ev, Rates& r) const {
  for (std::size_t i = 0; n_.iwan > 0.0 && i < sliders; ++i) {
    const double share = std::clamp(s[slider + i], -1.0, 1.0);
    const double travel = n_.iwan_travel * static_cast<double>(i + 1) / static_cast<double>(sliders);
    r.force += n_.iwan / static_cast<double>(sliders) * share;
    r.rate[slider + i] = share * sign(ev) >= 1.0 ? 0.0 : ev / travel;
  }
  if (n_.fractional <= 0.0) return;
  // s^α = sin(πα)/π ∫ T^(−α−1) sT/(1 + sT) dT: Maxwell branches whose T grow twofold, and what lies below and above
  // them, a damper and a spring.
  constexpr double shortest = 0.2e-3, ratio = 2.0;  // [s]
  const double alpha = n_.fractional_exponent, edge = std::sqrt(ratio);
  const double all = n_.fractional * std::sin(pi * alpha) / pi, softer = std::pow(ratio, -alpha);
  double time = shortest, stiffness = all * std::log(ratio) * std::pow(time, -alpha);
  r.force += all * std::pow(time / edge, 1.0 - alpha) / (1.0 - alpha) * ev;
  for (std::size_t i = 0; i < creeps; ++i, time *= ratio, stiffness *= softer) {
    r.force += stiffness * (e - s[creep + i]);
    r.rate[creep + i] = (e - s[creep + i]) / time;
  }
  r.force += all * std::pow(time / edge, -alpha) / alpha * e;
}

double Rig::pushed(const char* where, double t) const {
  double force = 0.0;
  for (const Event& event : n_.events)
    if (event.where == where && t > event.from && t < event.to)
      force += event.force * std::sin(pi * (t - event.from) / (event.to - event.from));
  return force;
}

void Rig::piston_rates(const State& s, double e, Rates& r) const {
  if (!n_.fdva || n_.locked) return;
  double net = n_.coupling * (e - s[y]) - n_.laminar * s[vy] - n_.turbulent * s[vy] * std::abs(s[vy]);
  r.rate[y] = s[vy];
  if (n_.seal > 0.0) {
    if (m_.slip[piston] == 0) {
      r.held[piston] = net;
      net = 0.0;
      r.rate[y] = 0.0;
    } else {
      net -= m_.slip[piston] * n_.seal;
    }
  }
  r.rate[vy] = net / n_.inertance;
}

double Rig::tyre_load(const State& s, double t, const Motion& input, Rates& r) const {
  const double tyre = input.position - s[zw];
  double load = n_.tyre * (1.0 + n_.tyre_drift * t / duration_) * tyre + n_.tyre_damping * (input.velocity - s[vw]) +
                n_.tyre_cubic * tyre * tyre * tyre;
  if (n_.tyre_maxwell > 0.0) {
    load += n_.tyre_maxwell * (tyre - s[tyre_x]);
    r.rate[tyre_x] = (tyre - s[tyre_x]) / n_.tyre_time;
  }
  if (n_.lift_off) load = std::max(load, -(n_.body + n_.wheel) * gravity);
  return load;
}

double Rig::felt_force(const State& s, double t, Rates& r) const {
  if (n_.kind != Kind::hil) return r.force;
  const double before = force_sensor_->before_noise(r.force, t);
  if (force_sensor_->remembers()) return force_sensor_->limited(force_sensor_->shown(t / h_));
  if (force_sensor_->lags()) {
    const double noise = force_sensor_->noise_at(node_);
    const bool taken = force_sensor_->lag_takes_noise();
    r.rate[lagged_force] = (before + (taken ? noise : 0.0) - s[lagged_force]) / force_sensor_->lag();
    return force_sensor_->limited(s[lagged_force] + (taken ? 0.0 : noise));
  }
  return force_sensor_->limited(before + force_sensor_->noise_at(node_));
}

void Rig::car_rates(const State& s, double t, bool friction_held, Rates& r) const {
  const double felt = felt_force(s, t, r);
  const double gain = n_.kind == Kind::hil ? force_sensor_->gain() : 1.0;
  const double load = r.wheel_load;
  const double dash = n_.virtual_damping * (s[vw] - s[vb]);
  double on_body = felt + dash - n_.body_damping * s[vb] + pushed("body", t);
  double on_wheel = pushed("wheel", t) + load - felt - dash - n_.wheel_damping * s[vw] +
                    n_.imbalance * std::sin(n_.imbalance_turn * t);

  // Friction: sliding ones are known, stuck ones are what keeps the slip velocity at zero.
  const bool b_stuck = has(body_guide) && m_.slip[body_guide] == 0;
  const bool w_stuck = has(wheel_guide) && m_.slip[wheel_guide] == 0;
  if (has(body_guide) && !b_stuck) on_body -= m_.slip[body_guide] * n_.body_friction;
  if (has(wheel_guide) && !w_stuck) on_wheel -= m_.slip[wheel_guide] * n_.wheel_friction;
  if (friction_held) {
    double between = 0.0;  // on the body, off the wheel
    if (b_stuck && w_stuck)
      between = 0.0;
    else if (b_stuck)
      between = on_wheel;
    else if (w_stuck)
      between = -on_body;
    else
      between = (n_.body * on_wheel - n_.wheel * on_body) / (n_.body + n_.wheel);
    r.held[suspension] = between / gain;
    r.force += between / gain;
    on_body += between;
    on_wheel -= between;
  }
  if (b_stuck) {
    r.held[body_guide] = on_body;
    on_body = 0.0;
  }
  if (w_stuck) {
    r.held[wheel_guide] = on_wheel;
    on_wheel = 0.0;
  }
  r.zdd_b = on_body / n_.body;
  r.zdd_w = on_wheel / n_.wheel;
  r.rate[zb] = s[vb];
  r.rate[vb] = r.zdd_b;
  r.rate[zw] = s[vw];
  r.rate[vw] = r.zdd_w;
}

Rig::State Rig::runge_kutta(double t, double h) const {
  const auto along = [&](const State& rate, double by) {
    State s = s_;
    for (std::size_t i = 0; i < state_count; ++i) s[i] += by * rate[i];
    return s;
  };
  const State k1 = rates(s_, t).rate;
  const State k2 = rates(along(k1, 0.5 * h), t + 0.5 * h).rate;
  const State k3 = rates(along(k2, 0.5 * h), t + 0.5 * h).rate;
  const State k4 = rates(along(k3, h), t + h).rate;
  State s = s_;
  for (std::size_t i = 0; i < state_count; ++i) s[i] += h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
  return s;
}

bool Rig::broken(const State& s, double t, bool repair) {
  bool any = false;
  if (located_play()) {
    const double deflection = s[zw] - s[zb];
    const double edge = 0.5 * n_.gap;
    const int side = deflection > edge ? 1 : (deflection < -edge ? -1 : 0);
    if (side != m_.play) {
      any = true;
      if (repair) {
        m_.play = side;
        m_.slip[suspension] = static_cast<int>(sign(s[vw] - s[vb]));
      }
    }
  }
  for (std::size_t f = 0; f < friction_count; ++f) {
    if (!has(f)) continue;
    if (f == suspension && located_play() && m_.play == 0) continue;
    if (m_.slip[f] != 0) {
      if (slip_velocity(f, s) * m_.slip[f] >= 0.0) continue;
      any = true;
      if (!repair) return true;
      // At rest: does it stick?
      const int before = m_.slip[f];
      m_.slip[f] = 0;
      const double needed = rates(s, t).held[f];
      if (std::abs(needed) > largest(f)) m_.slip[f] = needed > 0.0 ? 1 : -1;
      if (m_.slip[f] == before) m_.slip[f] = -before;  // it has crossed zero already
    } else if (const double velocity = slip_velocity(f, s); std::abs(velocity) > 1e-8) {
      any = true;  // a run that begins in motion
      if (!repair) return true;
      m_.slip[f] = velocity > 0.0 ? 1 : -1;
    } else {
      const double needed = rates(s, t).held[f];
      if (std::abs(needed) <= largest(f)) continue;
      any = true;
      if (!repair) return true;
      m_.slip[f] = needed > 0.0 ? 1 : -1;
    }
  }
  return any;
}

void Rig::step() {
  double t = static_cast<double>(node_) * h_;
  const double end = static_cast<double>(node_ + 1) * h_;
  bool events = located_play();
  for (std::size_t f = 0; f < friction_count; ++f) events = events || has(f);

  for (int tries = 0; tries < 40 && end - t > 1e-9 * h_; ++tries) {
    const double renewal = force_sensor_ != nullptr ? force_sensor_->next_renewal() : 2.0 * end;
    const bool renews = renewal > t && renewal < end;
    const double whole = (renews ? renewal : end) - t;
    State next = runge_kutta(t, whole);
    if (!events || tries == 39 || !broken(next, t + whole, false)) {
      s_ = next;
      t = renews ? renewal : end;
      if (events && tries == 39) (void)broken(s_, t, true);
      if (renews)
        force_sensor_->renew(force_sensor_->before_noise(rates(s_, t).force, t) + force_sensor_->noise_at(node_));
      continue;
    }
    double low = 0.0;
    double high = whole;
    for (int i = 0; i < 26; ++i) {
      const double middle = 0.5 * (low + high);
      const State trial = runge_kutta(t, middle);
      if (broken(trial, t + middle, false)) {
        high = middle;
        next = trial;
      } else {
        low = middle;
      }
    }
    s_ = next;
    t += high;
    (void)broken(s_, t, true);
  }

  for (std::size_t i = slider; i < creep; ++i) s_[i] = std::clamp(s_[i], -1.0, 1.0);

  // The algebraic and the limited parts, at the node.
  State unused{};
  if (n_.kind != Kind::quarter_car) {
    const bool bench = n_.kind == Kind::component_bench;
    const Motion input = signal_.at(end);
    double position = bench ? input.position : s_[zw] - s_[zb];
    double velocity = bench ? input.velocity : s_[vw] - s_[vb];
    double limited = 0.0;
    machine(s_, end, position, velocity, &limited, &velocity, &unused);
    if (n_.machine_velocity > 0.0) {
      const double velocity_limit = n_.machine_velocity;
      n_.machine_velocity = 0.0;
      machine(s_, end, position, velocity, &node_input_, &velocity, &unused);
      n_.machine_velocity = velocity_limit;
    }
    node_x_act_ = limited;
  }
  ++node_;
  remember();
}

void Rig::remember() {
  if (n_.kind == Kind::hil && n_.machine_delay > 0.0) commands_.push_back({s_[zw] - s_[zb], s_[vw] - s_[vb], 0.0});
  if (n_.kind == Kind::hil && (force_sensor_->remembers() || force_sensor_->lags())) {
    const double t = static_cast<double>(node_) * h_;
    force_sensor_->push(force_sensor_->before_noise(rates(s_, t).force, t));
    if (node_ == 0) s_[lagged_force] = force_sensor_->before_noise(rates(s_, t).force, t);
  }
}

double Rig::machine_acceleration(double t, const Rates& r) const {
  if (n_.machine_turn > 0.0) return r.rate[vres];
  const double past = t - n_.machine_delay;
  const Motion u = past < 0.0 ? Motion{} : signal_.at(past);
  if (n_.machine_lag > 0.0) return ((past < 0.0 ? 0.0 : u.velocity) - r.rate[lag]) / n_.machine_lag;
  return past < 0.0 ? 0.0 : u.acceleration;
}

Rig::Values Rig::values() const {
  const double t = static_cast<double>(node_) * h_;
  const Rates r = rates(s_, t);
  const Motion input = signal_.at(t);
  Values v;
  v.z_r = input.position;
  v.zdd_r = input.acceleration;
  v.zdd_w = r.zdd_w;
  v.zdd_b = r.zdd_b;
  v.wheel_load = r.wheel_load;
  v.x_cmd = n_.kind == Kind::component_bench ? input.position : s_[zw] - s_[zb];
  v.x_act = r.x_act;
  v.force = r.force + n_.moving_mass * machine_acceleration(t, r);
  return v;
}

}  // namespace truth
