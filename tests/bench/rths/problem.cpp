#include "tests/bench/rths/problem.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "model/numerics/exact_discretisation.hpp"

namespace rths {
namespace {

using Matrix3 = Eigen::Matrix3d;
using model::Block;
using model::Column;

constexpr double excitation_scale = 0.4;
constexpr double position_noise = 6.25e-14;        ///< power [m²/Hz]; variance = power × rate
constexpr double force_noise = 1.16e-3;            ///< [N²/Hz]
constexpr double converter_range = 3.8;            ///< ± [V], 1 V a metre
constexpr double converter_step = 1.0 / 262144.0;  ///< 18 bit a volt
constexpr double settling = 8.0;                   ///< [s] after the excitation
constexpr double out_of_bounds = 1.0;              ///< a floor that moves so far never comes back [m]
constexpr std::size_t longest_lag = 50;            ///< of J1 [samples]

/// Two inputs, force on floor 1 (held) and ground acceleration (straight from sample to sample).
class Structure {
 public:
  using State = Column<double, 6>;

  Structure(const Matrix3& mass, const Matrix3& damping, const Matrix3& stiffness, double carried_mass)
      : inverse_mass_(mass.inverse()), damping_(damping), stiffness_(stiffness), carried_(carried_mass) {
    Block<double, 6, 6> a = Block<double, 6, 6>::Zero();
    a.topRightCorner<3, 3>().setIdentity();
    a.bottomLeftCorner<3, 3>() = -inverse_mass_ * stiffness_;
    a.bottomRightCorner<3, 3>() = -inverse_mass_ * damping_;
    State force = State::Zero(), ground = State::Zero();
    force.tail<3>() = inverse_mass_.col(0);
    ground.tail<3>() = -carried_ * (inverse_mass_ * Eigen::Vector3d::Ones());
    const model::ExactDiscretisation<double, 6> exact(a, period);
    transition_ = exact.transition();
    force_ = exact.held(force);
    ground_ = exact.straight(ground);
  }

  [[nodiscard]] State next(const State& x, double force, double ground_before, double ground) const {
    return transition_ * x + force_ * force + ground_ * Eigen::Vector2d(ground_before, ground);
  }
  [[nodiscard]] double acceleration(const State& x, double force, double ground) const {
    const Eigen::Vector3d load = Eigen::Vector3d(force, 0.0, 0.0) - carried_ * ground * Eigen::Vector3d::Ones() -
                                 damping_ * x.tail<3>() - stiffness_ * x.head<3>();
    return inverse_mass_.row(0).dot(load);
  }

 private:
  Matrix3 inverse_mass_, damping_, stiffness_;
  double carried_;
  Block<double, 6, 6> transition_;
  State force_;
  Block<double, 6, 2> ground_;
};

Matrix3 stiffness_matrix() {
  Matrix3 k;
  k << 26054883.88, -23133938.88, 5937035.46, -23133938.88, 32560774.19, -14419970.78, 5937035.46, -14419970.78,
      9267275.51;
  return k;
}

/// C = M Φ diag(2ζω) Φᵀ M, with Φᵀ M Φ = I
Matrix3 modal_damping(double mass, double ratio) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> modes(stiffness_matrix() / mass);
  const Eigen::Vector3d rates = 2.0 * ratio * modes.eigenvalues().cwiseSqrt();
  return mass * (modes.eigenvectors() * rates.asDiagonal() * modes.eigenvectors().transpose());
}

/// The lead compensator and the PI controller of the problem, by Tustin's rule.
class Baseline {
 public:
  double next(double wanted, double measured) {
    const double lead = (over_now * wanted + over_before * wanted_ - under_before * lead_) / under_now;
    wanted_ = wanted;
    lead_ = lead;
    const double error = lead - measured;
    integral_ += 0.5 * period * (error + error_);
    error_ = error;
    return 2.0 * error + 95.0 * integral_;
  }

 private:
  static constexpr double zero_gain = 50.8316336, corner = 8570.39734, twice = 2.0 * rate;
  static constexpr double over_now = zero_gain * twice + corner, over_before = corner - zero_gain * twice;
  static constexpr double under_now = twice + corner, under_before = corner - twice;
  double wanted_ = 0.0, lead_ = 0.0, error_ = 0.0, integral_ = 0.0;
};

double converted(double value) {
  return converter_step * std::round(std::clamp(value, -converter_range, converter_range) / converter_step);
}

/// At a time that only grows.
class Ground {
 public:
  explicit Ground(const Excitation& excitation) : excitation_(excitation) {}
  double at(double time) {
    const auto& t = excitation_.time;
    while (at_ + 2 < t.size() && t[at_ + 1] <= time) ++at_;
    if (time >= t.back()) return 0.0;
    const double share = (time - t[at_]) / (t[at_ + 1] - t[at_]);
    const auto& a = excitation_.acceleration;
    return excitation_scale * ((1.0 - share) * a[at_] + share * a[at_ + 1]);
  }

 private:
  const Excitation& excitation_;
  std::size_t at_ = 0;
};

struct Signals {
  std::vector<double> wanted, reached, measured;         ///< x_n, x, x_m of floor 1
  std::array<std::vector<double>, 3> floors, undivided;  ///< of the hybrid and of the undivided structure
};

double deviation(const std::vector<double>& values) {
  double mean = 0.0, sum = 0.0;
  for (const double v : values) mean += v;
  mean /= static_cast<double>(values.size());
  for (const double v : values) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double peak(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

std::vector<double> difference(std::vector<double> a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

double lag(const std::vector<double>& wanted, const std::vector<double>& measured) {
  double most = -std::numeric_limits<double>::max();
  std::size_t best = 0;
  for (std::size_t n = 0; n < longest_lag; ++n) {
    double sum = 0.0;
    for (std::size_t i = n; i < wanted.size(); ++i) sum += wanted[i - n] * measured[i];
    if (sum > most) best = n;
    most = std::max(most, sum);
  }
  return static_cast<double>(best) * period;
}

std::array<double, 9> judge(const Signals& s) {
  std::array<double, 9> j{};
  const auto tracking = difference(s.reached, s.wanted);
  j[0] = 1e3 * lag(s.wanted, s.measured);
  j[1] = 100.0 * deviation(tracking) / deviation(s.wanted);
  j[2] = 100.0 * peak(tracking) / peak(s.wanted);
  // The released evaluation counts rms and peak of floor 1, then rms of floors 2 and 3, then their peaks.
  constexpr std::array<std::size_t, 3> rms_at{3, 5, 6}, peak_at{4, 7, 8};
  for (std::size_t floor = 0; floor < 3; ++floor) {
    const auto error = difference(floor == 0 ? s.reached : s.floors[floor], s.undivided[floor]);
    j[rms_at[floor]] = 100.0 * deviation(error) / deviation(s.undivided[floor]);
    j[peak_at[floor]] = 100.0 * peak(error) / peak(s.undivided[floor]);
  }
  return j;
}

struct PlantStep {
  Block<double, 5, 5> state;
  Column<double, 5> command;
};
enum PlantIndex : int { valve, valve_rate, force, position, velocity };

PlantStep plant_step(const Plant& p) {
  Block<double, 5, 5> a = Block<double, 5, 5>::Zero();
  a(valve, valve_rate) = 1.0;
  a(valve_rate, valve_rate) = -p.beta_1;
  a(valve_rate, valve) = -p.beta_2;
  a(valve_rate, position) = -Plant::a_1_beta_0;
  a(force, valve) = 1.0;
  a(force, force) = -p.a_3;
  a(force, velocity) = -Plant::a_2;
  a(position, velocity) = 1.0;
  a(velocity, force) = 1.0 / Plant::mass;
  a(velocity, velocity) = -p.damping() / Plant::mass;
  a(velocity, position) = -p.stiffness / Plant::mass;
  // Balanced by units of the size that each state has at 1 mm: the discretisation sums up rows.
  const Column<double, 5> unit{1e9, 3e11, 1e6, 1.0, 300.0};
  Block<double, 5, 5> scaled = unit.cwiseInverse().asDiagonal() * a * unit.asDiagonal();
  Column<double, 5> b = Column<double, 5>::Zero();
  b(valve_rate) = Plant::a_1_beta_0 * Plant::gain / unit(valve_rate);
  const model::ExactDiscretisation<double, 5> exact(scaled, period);
  return {unit.asDiagonal() * exact.transition() * unit.cwiseInverse().asDiagonal(), unit.asDiagonal() * exact.held(b)};
}

}  // namespace

Excitation read_excitation(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be read; expected a CSV file of t, a_g [m/s²]");
  Excitation result;
  std::string line;
  std::getline(in, line);
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    double t = 0.0, a = 0.0;
    char rest = 0;
    const int read = std::sscanf(line.c_str(), "%lf,%lf %c", &t, &a, &rest);
    const bool ascends = result.time.empty() || t > result.time.back();
    if (read != 2 || !std::isfinite(t) || !std::isfinite(a) || !ascends) {
      throw std::runtime_error(file.string() + ":" + std::to_string(number) +
                               ": expected a later time and an acceleration, two finite numbers");
    }
    result.time.push_back(t);
    result.acceleration.push_back(a);
  }
  if (result.time.size() < 2) throw std::runtime_error(file.string() + ": expected at least two rows");
  return result;
}

double Plant::damping() const { return 2.0 * damping_ratio * std::sqrt(stiffness * mass); }

Plant perturbed(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Plant plant;
  plant.stiffness += 50e3 * normal(random);
  plant.beta_1 += 3.3 * normal(random);
  plant.beta_2 += 3.3e3 * normal(random);
  plant.a_3 = std::max(0.1, plant.a_3 + 1.3 * normal(random));
  return plant;
}

std::array<double, 4> inverse_of(const Plant& p) {
  // f = (m s² + c s + k) x;  y = (s + a₃) f + a₂ s x;  a₁β₀ g u = (s² + β₁ s + β₂) y + a₁β₀ x
  const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result(a.size() + b.size() - 1, 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
    }
    return result;
  };
  std::vector<double> y = product({p.a_3, 1.0}, {p.stiffness, p.damping(), Plant::mass});
  y[1] += Plant::a_2;
  std::vector<double> u = product({p.beta_2, p.beta_1, 1.0}, y);
  u[0] += Plant::a_1_beta_0;
  std::array<double, 4> series{};
  for (std::size_t i = 0; i < 4; ++i) series[i] = u[i] / (Plant::a_1_beta_0 * Plant::gain);
  return series;
}

Criteria run(const Excitation& excitation, const Test& test, const Method& method) {
  const Case& structure = cases[test.structure];
  const Plant nominal;
  const Matrix3 whole_mass = structure.mass * Matrix3::Identity(), whole_stiffness = stiffness_matrix();
  const Matrix3 whole_damping = modal_damping(structure.mass, structure.damping);
  Matrix3 mass = whole_mass, damping = whole_damping, stiffness = whole_stiffness;
  mass(0, 0) -= Plant::mass;
  damping(0, 0) -= nominal.damping();
  stiffness(0, 0) -= nominal.stiffness;
  const Structure divided(mass, damping, stiffness, structure.mass);
  const Structure undivided(whole_mass, whole_damping, whole_stiffness, structure.mass);
  const PlantStep plant_model = plant_step(test.plant);

  const std::unique_ptr<firmware::Compensation> compensation(method.compensation ? method.compensation() : nullptr);
  if (compensation) compensation->start(0.0);
  Baseline baseline;
  Ground ground(excitation);
  std::mt19937_64 random(test.seed);
  std::normal_distribution<double> normal;

  Structure::State x = Structure::State::Zero(), truth = x;
  Column<double, 5> plant = Column<double, 5>::Zero();
  Criteria result;
  Signals s;
  double target = 0.0, command = 0.0, force_before = 0.0, ground_now = ground.at(0.0), added = 0.0;
  const auto steps = static_cast<std::size_t>((excitation.time.back() + settling) * rate);
  for (std::size_t k = 0; k < steps; ++k) {
    const double measured = plant(position) + std::sqrt(position_noise * rate) * normal(random);
    const double measured_force = plant(force) + std::sqrt(force_noise * rate) * normal(random);
    s.wanted.push_back(x(0));
    s.reached.push_back(plant(position));
    s.measured.push_back(measured);
    for (int floor = 0; floor < 3; ++floor) {
      s.floors[static_cast<std::size_t>(floor)].push_back(x(floor));
      s.undivided[static_cast<std::size_t>(floor)].push_back(truth(floor));
    }
    command = method.controller == Controller::baseline ? baseline.next(target, measured) : target;
    command = converted(command);
    result.largest_command = std::max(result.largest_command, std::abs(command));
    plant = (plant_model.state * plant + plant_model.command * command).eval();
    result.largest_force = std::max(result.largest_force, std::abs(plant(force)));

    const double received = method.late_force ? force_before : measured_force;
    force_before = measured_force;
    const double entering = compensation ? compensation->force(received) : received;
    added += (entering - received) * (entering - received);
    const double ground_next = ground.at(static_cast<double>(k + 1) * period);
    x = divided.next(x, -entering, ground_now, ground_next);
    truth = undivided.next(truth, 0.0, ground_now, ground_next);
    ground_now = ground_next;
    target = x(0);
    if (compensation) {
      // The force that enters the next step is known by then.
      const double next_force = method.late_force ? measured_force : entering;
      const model::Motion<double> wanted{x(0), x(3), divided.acceleration(x, -next_force, ground_now)};
      const auto answer =
          compensation->command({.wanted = wanted, .commanded = command, .reached = measured, .measured = true});
      target = answer.command.position;
    }
    if (!(std::abs(x(0)) < out_of_bounds) || !(std::abs(plant(position)) < out_of_bounds)) {
      result.values.fill(std::numeric_limits<double>::infinity());
      result.stable = false;
      return result;
    }
  }
  result.values = judge(s);
  result.noise_force = std::sqrt(added / static_cast<double>(steps));
  return result;
}

}  // namespace rths
