#include "host_sim/stability/roots/linear_rig.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "model/components/machine.hpp"
#include "model/components/subsystems.hpp"
#include "model/laws/surface.hpp"
#include "model/rig/lever_at_rest.hpp"
#include "model/rig/rig_equations.hpp"

namespace host_sim::stability {
namespace {

using Equations = model::RigEquations<double>;
using model::Linearisation;

Eigen::Index index_of(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// Car (1) of LinearRig: inputs F_s, z_r, ż_r; outputs z_w, z_b, F_w.
StateSpace car_of(const Equations& equations) {
  using State = Equations::CarState;
  using Input = Equations::CarInput;
  constexpr int n = State::RowsAtCompileTime;
  StateSpace car{Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, 3), Eigen::MatrixXd::Zero(3, n),
                 Eigen::MatrixXd::Zero(3, 3)};
  for (int j = 0; j < n; ++j) {
    const State unit = State::Unit(j);
    car.a.col(j) = equations.car(unit, Input{});
    car.c(2, j) = equations.tyre_force(unit, 0.0, 0.0);
  }
  car.b.col(0) = equations.car(State::Zero(), Input{.suspension_force = 1.0});
  car.b.col(1) = equations.car(State::Zero(), Input{.z_r = 1.0});
  car.b.col(2) = equations.car(State::Zero(), Input{.v_r = 1.0});
  car.c(0, 0) = 1.0;
  car.c(1, 2) = 1.0;
  car.d(2, 1) = equations.tyre_force(State::Zero(), 1.0, 0.0);
  car.d(2, 2) = equations.tyre_force(State::Zero(), 0.0, 1.0);
  return car;
}

/// i between wheel and component both ways, and the lever's own spring beside it.
void add_lever(model::LeverAtRest lever, StateSpace& car) {
  const Eigen::VectorXd force = car.b.col(0);
  car.a += lever.stiffness * force * (car.c.row(0) - car.c.row(1));
  car.b.col(0) *= lever.ratio * lever.ratio;
}

/// The area of the air spring moves: a skyhook commands it, and it is not stuck.
bool follows_skyhook(const model::RigParameters<double>& rig) {
  return rig.air_spring.skyhook > 0.0 && !rig.effects.get<model::StuckArea>().active;
}

/// The car with the skyhook of its air spring: the actuator's states u, u̇ behind it, whose force k_u u acts at once.
StateSpace with_skyhook(const StateSpace& car, const model::RigParameters<double>& rig, double lever_ratio) {
  const auto& spring = rig.air_spring;
  if (!follows_skyhook(rig)) return car;
  constexpr double two_pi = 6.283185307179586;
  const double omega = two_pi * spring.actuator_frequency;
  const bool second = spring.actuator_damping > 0.0;
  const Eigen::Index n = car.a.rows(), m = n + (second ? 2 : 1);
  StateSpace system{Eigen::MatrixXd::Zero(m, m), Eigen::MatrixXd::Zero(m, car.b.cols()),
                    Eigen::MatrixXd::Zero(car.c.rows(), m), car.d};
  system.a.topLeftCorner(n, n) = car.a;
  system.b.topRows(n) = car.b;
  system.c.leftCols(n) = car.c;
  system.a.block(0, n, n, 1) = car.b.col(0) * lever_ratio;  // the state is the force k_u u
  constexpr Eigen::Index body_velocity = 3;
  if (second) {
    system.a(n, n + 1) = 1.0;
    system.a(n + 1, n) = -omega * omega;
    system.a(n + 1, n + 1) = -2.0 * spring.actuator_damping * omega;
    system.a(n + 1, body_velocity) = -omega * omega * spring.skyhook;
  } else {
    system.a(n, n) = -omega;
    system.a(n, body_velocity) = -omega * spring.skyhook;
  }
  return system;
}

/// Component (3): inputs x_act, ẋ_act; output F.
StateSpace component_of(const Equations& equations, int open) {
  using State = Equations::ComponentState;
  using Input = Equations::ComponentInput;
  constexpr int n = State::RowsAtCompileTime;
  StateSpace component{Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, 2), Eigen::MatrixXd(1, n), Eigen::MatrixXd(1, 2)};
  for (int j = 0; j < n; ++j) {
    const State unit = State::Unit(j);
    component.a.col(j) = equations.component(unit, Input{}, open);
    component.c(0, j) = equations.component_force(unit, 0.0, 0.0);
  }
  component.b.col(0) = equations.component(State::Zero(), Input{.deflection = 1.0}, open);
  component.b.col(1) = equations.component(State::Zero(), Input{.velocity = 1.0}, open);
  component.d(0, 0) = equations.component_force(State::Zero(), 1.0, 0.0);
  component.d(0, 1) = equations.component_force(State::Zero(), 0.0, 1.0);
  return component;
}

/// Machine (2) without its delay: inputs x_cmd, ẋ_cmd; outputs x_act, ẋ_act.
StateSpace machine_of(const model::MachinePath<double>& path) {
  using Machine = model::Machine<double>;
  using State = Machine::State;
  constexpr int n = State::RowsAtCompileTime;
  constexpr double any_period = 1e-3;  // of its step, which is not asked for
  const Machine machine(path, any_period);
  const auto output = [&](const State& x, double position, double velocity) {
    const model::Stroke<double> reached = machine.output(x, {position, velocity});
    return Eigen::Vector2d(reached.position, reached.velocity);
  };
  StateSpace system{Eigen::MatrixXd(n, n), Eigen::MatrixXd::Zero(n, 2), Eigen::MatrixXd(2, n), Eigen::MatrixXd(2, 2)};
  for (int j = 0; j < n; ++j) {
    system.a.col(j) = machine.rates(State::Unit(j), 0.0);
    system.c.col(j) = output(State::Unit(j), 0.0, 0.0);
  }
  system.b.col(0) = machine.rates(State::Zero(), 1.0);
  system.d.col(0) = output(State::Zero(), 1.0, 0.0);
  system.d.col(1) = output(State::Zero(), 0.0, 1.0);
  return system;
}

/// Sensor of F (4) without its delay: equations (1) and (2) of model::Sensors, whose own step is discrete.
StateSpace force_sensor_of(const model::SensorPath<double>& path) {
  const bool lags = path.lag > 0.0;
  const Eigen::Index n = lags ? 1 : 0;
  StateSpace system{Eigen::MatrixXd(n, n), Eigen::MatrixXd(n, 1), Eigen::MatrixXd(1, n),
                    Eigen::MatrixXd::Constant(1, 1, lags ? 0.0 : path.gain)};
  if (lags) {
    system.a(0, 0) = -1.0 / path.lag;
    system.b(0, 0) = path.gain / path.lag;
    system.c(0, 0) = 1.0;
  }
  return system;
}

/// det(M + s diag(1 … 1, 0 … 0)) with `ones` ones, expanded by rows: a sum of products of entries, which keeps the
/// digits of every coefficient although entries differ by many powers of ten. Each set of columns is expanded once.
class PencilDeterminant {
 public:
  PencilDeterminant(const Eigen::MatrixXd& matrix, Eigen::Index ones)
      : matrix_(matrix), ones_(ones), size_(matrix.rows()), known_(std::size_t{1} << static_cast<unsigned>(size_)) {}

  [[nodiscard]] Polynomial polynomial() { return of(0, 0); }

 private:
  /// Of the rows from `row` on, without the columns of `used`.
  const Polynomial& of(Eigen::Index row, std::size_t used) {
    auto& [done, sum] = known_[used];
    if (done) return sum;
    done = true;
    if (row == size_) return sum = {1.0};
    bool positive = true;
    for (Eigen::Index j = 0; j < size_; ++j) {
      const std::size_t column = std::size_t{1} << static_cast<unsigned>(j);
      if ((used & column) != 0U) continue;
      const double entry = matrix_(row, j);
      const bool with_s = j == row && j < ones_;
      if (entry != 0.0 || with_s) {
        const Polynomial factor = with_s ? Polynomial{entry, 1.0} : Polynomial{entry};
        sum += (positive ? 1.0 : -1.0) * (factor * of(row + 1, used | column));
      }
      positive = !positive;
    }
    return sum;
  }

  const Eigen::MatrixXd& matrix_;
  Eigen::Index ones_, size_;
  std::vector<std::pair<bool, Polynomial>> known_;
};

/// det(sI − A)
Polynomial characteristic(const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd negative = -a;
  return PencilDeterminant(negative, a.rows()).polynomial();
}

/// Numerator from a displacement to `output` of a block that takes displacement (input 0) and velocity (input 1).
Polynomial by_displacement(const TransferMatrix& block, std::size_t output) {
  return block.numerator(output, 0) + Polynomial::s() * block.numerator(output, 1);
}

}  // namespace

std::vector<bool> reached(const Eigen::MatrixXd& links, std::vector<bool> start) {
  bool grown = true;
  while (grown) {
    grown = false;
    for (std::size_t i = 0; i < start.size(); ++i) {
      for (std::size_t j = 0; j < start.size() && !start[i]; ++j) {
        if (start[j] && links(index_of(i), index_of(j)) != 0.0) start[i] = grown = true;
      }
    }
  }
  return start;
}

StateSpace without_idle_states(const StateSpace& system) {
  const auto n = static_cast<std::size_t>(system.a.rows());
  std::vector<bool> driven(n), seen(n);
  for (std::size_t i = 0; i < n; ++i) {
    driven[i] = !system.b.row(index_of(i)).isZero(0.0);
    seen[i] = !system.c.col(index_of(i)).isZero(0.0);
  }
  driven = reached(system.a, driven);
  seen = reached(system.a.transpose(), seen);
  std::vector<Eigen::Index> kept;
  for (std::size_t i = 0; i < n; ++i) {
    if (driven[i] && seen[i]) kept.push_back(index_of(i));
  }
  return {system.a(kept, kept), system.b(kept, Eigen::all), system.c(Eigen::all, kept), system.d};
}

TransferMatrix::TransferMatrix(const StateSpace& full) : inputs_(static_cast<std::size_t>(full.d.cols())) {
  const StateSpace system = without_idle_states(full);
  denominator_ = characteristic(system.a);
  const Eigen::Index n = system.a.rows();  // 0: nothing but d, and no rows or columns to speak of
  for (Eigen::Index i = 0; i < system.d.rows(); ++i) {
    for (Eigen::Index j = 0; j < system.d.cols(); ++j) {
      // c adj(sI − A) b + d det(sI − A) = det [sI − A, b; −c, d]
      Eigen::MatrixXd bordered(n + 1, n + 1);
      if (n > 0) {
        bordered.topLeftCorner(n, n) = -system.a;
        bordered.topRightCorner(n, 1) = system.b.col(j);
        bordered.bottomLeftCorner(1, n) = -system.c.row(i);
      }
      bordered(n, n) = system.d(i, j);
      numerators_.push_back(PencilDeterminant(bordered, n).polynomial());
    }
  }
}

std::array<Polynomial, 2> LinearRig::machine_response() const {
  return {by_displacement(machine, 0), machine.denominator()};
}

std::array<Polynomial, 2> LinearRig::component_response() const {
  return {by_displacement(component, 0), component.denominator()};
}

namespace {

using model::LawPlace;
using Laws = model::Laws<double>;

/// A curve over the velocity behind a spring k, of slope c at rest: a Maxwell branch of time constant c/k. None without
/// a slope, where the spring carries nothing.
std::optional<model::BranchNumbers<double>> as_branch(const model::CurveTable<double>& table) {
  if (!(table.behind > 0.0) || table.over != model::LawOver::velocity) return std::nullopt;
  const double slope = model::Curve<double>(table.at, table.value, table.count).slope(0.0);
  if (!(slope > 0.0)) return std::nullopt;
  return model::BranchNumbers<double>{
      .place = table.place, .stiffness = table.behind, .time_constant = slope / table.behind};
}

/// Laws of the loop with a slope at rest, as the parameters that they are there. A sensor's curve is a gain.
void add_law_slopes(const Laws& laws, model::RigParameters<double>& linear) {
  const auto add = [&linear](LawPlace place, double stiffness, double damping) {
    if (place == LawPlace::suspension) {
      linear.suspension.stiffness += stiffness;
      linear.suspension.damping += damping;
    } else if (place == LawPlace::tyre) {
      linear.tyre.stiffness += stiffness;
      linear.tyre.damping += damping;
    }
  };
  for (std::size_t i = 0; i < laws.curve_count; ++i) {
    const auto& table = laws.curves[i];
    const double slope = model::Curve<double>(table.at, table.value, table.count).slope(0.0);
    const bool velocity = table.over == model::LawOver::velocity;
    if (table.behind > 0.0) {
      if (!velocity) add(table.place, slope * table.behind / (slope + table.behind), 0.0);
      continue;  // over the velocity: a Maxwell branch, below
    }
    add(table.place, velocity ? 0.0 : slope, velocity ? slope : 0.0);
    if (table.place != LawPlace::sensor || table.channel != model::Channel::F) continue;
    auto& gain = linear.effects.get<model::SensorGain>(model::Channel::F);
    gain.effect.gain = (gain.active ? gain.effect.gain : 1.0) * slope;
    gain.active = true;
  }
  for (std::size_t i = 0; i < laws.surface_count; ++i) {
    const model::Surface<double> surface(laws.surfaces[i]);
    add(laws.surfaces[i].place, surface.over_deflection(0.0, 0.0), surface.over_velocity(0.0, 0.0));
  }
  const auto& gain = linear.effects.get<model::SensorGain>(model::Channel::F);
  if (linear.suspension.stiffness < 0.0 || linear.suspension.damping < 0.0 || !(linear.tyre.stiffness > 0.0) ||
      linear.tyre.damping < 0.0 || (gain.active && !(gain.effect.gain > 0.0))) {
    throw UnfitLoop("[laws] make a stiffness, a damping or the gain of F negative at rest");
  }
  auto& relaxation = linear.effects.get<model::Relaxation>();
  for (std::size_t i = 0; i < laws.curve_count; ++i) {
    const auto branch = as_branch(laws.curves[i]);
    if (branch && branch->place == LawPlace::suspension && !relaxation.active) {
      relaxation = {true, {branch->stiffness, branch->time_constant}};
    }
  }
  for (std::size_t i = 0; i < laws.branch_count; ++i) {
    const auto& branch = laws.branches[i];
    if (branch.slip_force > 0.0) {
      if (!(branch.gap > 0.0)) add(branch.place, branch.stiffness, 0.0);  // at rest it sticks, or is inside its play
    } else if (branch.place == LawPlace::suspension && !relaxation.active) {
      relaxation = {true, {branch.stiffness, branch.time_constant}};
    }
  }
}

/// What add_law_slopes() cannot say by a parameter: laws of the piston, and all Maxwell branches but the first of a
/// suspension without the effect relaxation. A curve behind a spring is such a branch.
std::vector<std::string> laws_left_out(const model::RigParameters<double>& rig) {
  const Laws& laws = rig.laws;
  std::vector<std::string> names;
  bool has_relaxation = rig.effects.get<model::Relaxation>().active || rig.air_spring.fitted;
  const auto name = [&names](std::string_view kind, std::size_t i, LawPlace place) {
    names.push_back("laws: " + std::string(kind) + " " + std::to_string(i + 1) + " of the " +
                    std::string(model::name(place)));
  };
  for (std::size_t i = 0; i < laws.curve_count; ++i) {
    const LawPlace place = laws.curves[i].place;
    const bool maxwell = as_branch(laws.curves[i]).has_value();
    const bool taken = maxwell && place == LawPlace::suspension && !has_relaxation;
    if (taken) has_relaxation = true;
    if (place == LawPlace::piston || (maxwell && !taken)) name("curve", i, place);
  }
  for (std::size_t i = 0; i < laws.surface_count; ++i) {
    if (laws.surfaces[i].place == LawPlace::piston) name("surface", i, LawPlace::piston);
  }
  for (std::size_t i = 0; i < laws.branch_count; ++i) {
    const auto& branch = laws.branches[i];
    const bool maxwell = branch.time_constant > 0.0;
    const bool taken = maxwell && branch.place == LawPlace::suspension && !has_relaxation;
    if (taken) has_relaxation = true;
    if (branch.place == LawPlace::piston || (maxwell && !taken)) name("branch", i, branch.place);
  }
  return names;
}

}  // namespace

namespace {

using Air = model::AirSpring<double>;

/// The air spring as spring and Maxwell branch; true: the branch has no place beside the effect relaxation.
bool add_air_spring(const model::RigParameters<double>& rig, model::RigParameters<double>& linear) {
  const double exponent = model::condition_of_air_spring(rig).polytropic_exponent;
  auto& relaxation = linear.effects.get<model::Relaxation>();
  const bool taken = relaxation.active;
  linear.suspension.stiffness += Air::stiffness(rig.air_spring, taken ? exponent : 1.0);
  if (!taken) relaxation = {true, {Air::heat_stiffness(rig.air_spring, exponent), rig.air_spring.heat_time}};
  return taken;
}

}  // namespace

model::RigParameters<double> linear_part(const model::RigParameters<double>& rig) {
  model::RigParameters<double> linear = rig;
  linear.air_spring = {};
  linear.lever = {};
  linear.delay_variation = {};
  linear.laws = {};
  linear.fdva.minor_loss = 0.0;
  linear.effects.for_each([&linear](auto& slot) {
    if (!slot.active) return;
    if constexpr (requires { slot.effect.tangent(); }) {
      const model::Tangent<double> tangent = slot.effect.tangent();
      linear.suspension.stiffness += tangent.stiffness;
      linear.suspension.damping += tangent.damping;
      slot.active = false;
    }
    if (slot.effect.card.linearisation == Linearisation::left_out) slot.active = false;
  });
  linear.effects.for_each_sensor([](auto& slot, model::Channel channel) {
    if (channel != model::Channel::F || slot.effect.card.linearisation == Linearisation::left_out) {
      slot.active = false;
    }
  });
  if (rig.air_spring.fitted) {
    add_air_spring(rig, linear);
    linear.effects.for_each([](auto& slot) {  // they are in its stiffness, and need a spring that is gone
      if (slot.effect.card.needs_air_spring) slot.active = false;
    });
  }
  add_law_slopes(rig.laws, linear);
  return linear;
}

model::RigParameters<double> sampled_part(const model::RigParameters<double>& rig) {
  model::RigParameters<double> with_linear_spring = rig;
  const bool follows = follows_skyhook(rig);
  if (follows) with_linear_spring.air_spring = {};
  model::RigParameters<double> result = linear_part(with_linear_spring);
  result.lever = rig.lever;
  if (!follows) return result;
  result.air_spring = rig.air_spring;
  result.air_spring.levelling_rate = 0.0;
  return result;
}

LinearRig linearise(const model::RigParameters<double>& rig) {
  if (rig.kind != model::RigKind::hil) {
    throw UnfitLoop("stability analysis needs the loop of a hil rig, this is a " + std::string(model::name(rig.kind)));
  }
  LinearRig result;
  if (rig.has_fdva && rig.fdva.minor_loss > 0.0 && rig.fdva.open_ducts > 0) {
    result.left_out.emplace_back("fdva.minor_loss");
  }
  const auto sort = [&](Linearisation linearisation, const std::string& name) {
    if (linearisation == Linearisation::left_out) result.left_out.push_back(name);
    if (linearisation == Linearisation::outside) result.outside_loop.push_back(name);
  };
  rig.effects.for_each([&](const auto& slot) {
    if (slot.active) sort(slot.effect.card.linearisation, std::string(slot.effect.card.name));
  });
  rig.effects.for_each_sensor([&](const auto& slot, model::Channel channel) {
    if (!slot.active) return;
    const std::string name = std::string(slot.effect.card.name) + "." + std::string(model::name(channel));
    if (channel == model::Channel::F) {
      sort(slot.effect.card.linearisation, name);
    } else {
      result.outside_loop.push_back(name);
    }
  });

  for (std::string& law : laws_left_out(rig)) result.left_out.push_back(std::move(law));
  if (rig.air_spring.fitted) {
    if (rig.effects.get<model::Relaxation>().active) result.left_out.emplace_back("air_spring.heat_time");
    if (rig.air_spring.levelling_rate > 0.0) result.left_out.emplace_back("air_spring.levelling_rate");
  }

  const model::RigParameters<double> linear = linear_part(rig);
  const Equations equations(linear);
  model::MachinePath<double> path{};
  linear.effects.act_on(path);
  const model::SensorPath<double> sensor = linear.effects.sensor_paths()[model::index(model::Channel::F)];
  const model::LeverAtRest lever = model::lever_at_rest(rig);
  const StateSpace car_alone = car_of(equations);
  result.car = with_skyhook(car_alone, rig, lever.ratio);
  result.lever_ratio = lever.ratio;
  if (result.car.a.rows() > car_alone.a.rows()) result.area_force = car_alone.a.rows();
  add_lever(lever, result.car);
  result.component = TransferMatrix(component_of(equations, rig.has_fdva ? rig.fdva.open_ducts : 0));
  result.machine = TransferMatrix(machine_of(path));
  result.force_sensor = TransferMatrix(force_sensor_of(sensor));
  result.machine_delay = path.delay;
  result.sensor_delay = sensor.delay;

  StateSpace loop = result.car;
  loop.b = result.car.b.leftCols(1).eval();
  loop.c = (result.car.c.row(0) - result.car.c.row(1)).eval();
  loop.d = Eigen::MatrixXd::Zero(1, 1);
  const TransferMatrix car(loop);
  const TransferMatrix& m = result.machine;
  const TransferMatrix& k = result.component;
  const TransferMatrix& s = result.force_sensor;
  result.p = car.denominator() * m.denominator() * k.denominator() * s.denominator();
  result.q = -1.0 * (car.numerator(0, 0) * s.numerator(0, 0) *
                     (k.numerator(0, 0) * by_displacement(m, 0) + k.numerator(0, 1) * by_displacement(m, 1)));
  return result;
}

}  // namespace host_sim::stability
