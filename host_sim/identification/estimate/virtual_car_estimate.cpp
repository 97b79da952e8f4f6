#include "host_sim/identification/estimate/virtual_car_estimate.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "host_sim/identification/estimate/thresholds.hpp"
#include "host_sim/least_squares/bounded_step.hpp"

namespace host_sim::identification {
namespace {

using model::Channel;
constexpr std::array<std::string_view, 5> parameter_paths{"body.mass", "wheel.mass", "tyre.stiffness", "tyre.damping",
                                                          "machine.virtual_damping"};
enum : Eigen::Index { m_b, m_w, k_t, b_t, b_v, count };
using Row = Eigen::Matrix<double, count, 1>;

std::vector<double> velocity(const std::vector<double>& positions, double rate) {
  std::vector<double> result;
  for (const auto& m : firmware::through_samples(positions, rate)) result.push_back(m.velocity);
  return result;
}

/// The described values, and how far each may deviate from it.
struct Given {
  Row value, lower, upper;
  bool any = false;  ///< something may
};
Given given_values(const firmware::RigDescription& description) {
  Given given;
  model::RigParameters<double> rig = description.rig;
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::string path(parameter_paths[static_cast<std::size_t>(i)]);
    given.value(i) = *firmware::find_parameter(rig, path);
    const auto tolerance = description.tolerance.find(path);
    const double bound = tolerance == description.tolerance.end() ? 0.0 : tolerance->second * std::abs(given.value(i));
    given.lower(i) = -bound;
    given.upper(i) = bound;
    given.any = given.any || bound > 0.0;
  }
  return given;
}

/// Σ rows rowsᵀ and Σ rows rhs of one equation, over Σ rhs².
struct Normal {
  Eigen::Matrix<double, count, count> matrix = Eigen::Matrix<double, count, count>::Zero();
  Row right = Row::Zero();
  double square = 0.0;
  double samples = 0.0;

  void add(const Row& row, double rhs) {
    matrix.noalias() += row * row.transpose();
    right += row * rhs;
    square += rhs * rhs;
    samples += 1.0;
  }
  void add_to(Normal& all) const {
    if (!(square > 0.0)) return;
    const double weight = samples / square;
    all.matrix += weight * matrix;
    all.right += weight * right;
    all.square += weight * square;
    all.samples += samples;
  }
};

/// The deflection of the virtual tyre and its rate.
struct TyreMotion {
  std::vector<double> deflection, rate;
};
TyreMotion tyre_motion(const firmware::Recording& r) {
  TyreMotion motion;
  if (!r.has(Channel::z_r) || !r.has(Channel::z_w)) return motion;
  for (std::size_t k = 0; k < r.size(); ++k) motion.deflection.push_back(r[Channel::z_r][k] - r[Channel::z_w][k]);
  motion.rate = velocity(motion.deflection, 1.0 / r.sample_period);
  return motion;
}

/// Whether two loads are one, as written: the lower of them is negative.
bool is_as_low_as(double load, double lowest) { return load <= lowest * (1.0 - 1e-8); }

/// What one unit of a tyre law with one parameter adds to F_w.
double per_unit(const firmware::CatalogueEntry& law, double deflection) {
  return law.tyre_force(std::array{1.0}, 0.0, deflection, 0.0);
}

/// The tyre laws that least squares can find: in proportion to their only parameter.
std::vector<const firmware::CatalogueEntry*> proportional_laws() {
  constexpr double deflection = 1e-3, rounding = 1e-12;
  std::vector<const firmware::CatalogueEntry*> laws;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    if (entry.tyre_force == nullptr || entry.parameters.size() != 1) continue;
    const double one = per_unit(entry, deflection), two = entry.tyre_force(std::array{2.0}, 0.0, deflection, 0.0);
    if (one != 0.0 && std::abs(two - 2.0 * one) <= rounding * std::abs(one)) laws.push_back(&entry);
  }
  return laws;
}

/// A tyre law without parameters that keeps F_w above a bound.
struct BoundingLaw {
  const firmware::CatalogueEntry* entry;
  double bound;  ///< [N]
};
std::vector<BoundingLaw> bounding_laws(const model::RigParameters<double>& rig) {
  constexpr double beyond = -1e15, gravity = 9.81;  // [N], [m/s²]
  std::vector<BoundingLaw> laws;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    if (entry.tyre_force == nullptr || !entry.parameters.empty()) continue;
    const double bound = entry.tyre_force({}, beyond, 0.0, (rig.body.mass + rig.wheel.mass) * gravity);
    if (bound > beyond && bound < 0.0) laws.push_back({&entry, bound});
  }
  return laws;
}

/// The lowest F_w, where it is repeated and near the bound of a law.
std::optional<double> bounded_load(double bound, const std::vector<PreparedRecording>& recordings) {
  double lowest = INFINITY;
  for (const PreparedRecording& r : recordings) {
    if (!r.recording.has(Channel::F_w)) continue;
    for (const double f : r.recording[Channel::F_w]) lowest = std::min(lowest, f);
  }
  int equal = 0;
  for (const PreparedRecording& r : recordings) {
    if (!r.recording.has(Channel::F_w)) continue;
    for (const double f : r.recording[Channel::F_w]) equal += is_as_low_as(f, lowest) ? 1 : 0;
  }
  const bool repeated = equal >= thresholds::equal_lowest_loads;
  const bool near = std::abs(lowest - bound) < thresholds::lift_off_distance * std::abs(bound);
  return repeated && near ? std::optional(lowest) : std::nullopt;
}

/// The tyre law (3).
struct TyreLaw {
  double stiffness = 0.0, damping = 0.0;
  const firmware::CatalogueEntry* proportional = nullptr;
  double parameter = 0.0;        ///< p of the proportional law
  std::optional<double> lowest;  ///< F_w of a wheel that a law bounds [N]

  [[nodiscard]] bool bounds(double load) const { return lowest && is_as_low_as(load, *lowest); }
  [[nodiscard]] double force(double deflection) const {
    return proportional == nullptr ? 0.0 : parameter * per_unit(*proportional, deflection);
  }
  /// F_w
  [[nodiscard]] double load(double dz, double rate) const {
    const double free = stiffness * dz + damping * rate + force(dz);
    return lowest ? std::max(free, *lowest) : free;
  }
};

/// Calls what(deflection, rate, load) for the samples of a window that have a velocity.
template <class What>
void for_each_load(const PreparedRecording& r, Window window, const What& what) {
  if (!r.recording.has(Channel::F_w)) return;
  const TyreMotion tyre = tyre_motion(r.recording);
  if (tyre.deflection.empty()) return;
  const std::size_t from = std::max<std::size_t>(window.from, 2), to = std::min(window.to + 2, r.size()) - 2;
  for (std::size_t k = from; k < to; ++k) what(tyre.deflection[k], tyre.rate[k], r.recording[Channel::F_w][k]);
}

/// (3) around the described tyre, over fitted samples: deviations of k_t and b_t, and p, scaled to a unit diagonal.
struct TyreFit {
  const firmware::CatalogueEntry* law = nullptr;
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero(), scale = Eigen::Vector3d::Ones();
  double error = 0.0;          ///< Σ residual² as described, samples at a law's bound left out
  double error_bounded = 0.0;  ///< of those
  double loads = 0.0, samples = 0.0;

  [[nodiscard]] double left(const Eigen::Vector3d& d) const {
    return std::max(error + 2.0 * gradient.dot(d) + d.dot(hessian * d), 0.0);
  }
  /// k_t and b_t inside their bounds, p free or zero.
  [[nodiscard]] Eigen::Vector3d solve(const Given& given, bool with_law) const {
    const double far = with_law ? 1e3 * gradient.cwiseAbs().maxCoeff() + 1.0 : 0.0;
    const Eigen::Vector3d low(given.lower(k_t) / scale(0), given.lower(b_t) / scale(1), -far);
    const Eigen::Vector3d high(given.upper(k_t) / scale(0), given.upper(b_t) / scale(1), far);
    return bounded_step(hessian, gradient, {low, high});
  }
  /// Of p, in units of `scale` and of the variance of a sample.
  [[nodiscard]] double variance_of_parameter() const { return hessian.inverse()(2, 2); }
  /// Whether the deflections tell p from a linear tyre: beyond that, rounding of the sums decides more than
  /// thresholds::rounding_share of its variance.
  [[nodiscard]] bool determines_parameter() const {
    const double rounded = variance_of_parameter() * std::numeric_limits<double>::epsilon();
    return rounded > 0.0 && rounded < thresholds::rounding_share;
  }
  /// Whether the law takes away half of what a linear tyre leaves and moves F_w, with a parameter that a tyre may have.
  [[nodiscard]] bool is_found(const Given& given) const {
    if (!determines_parameter()) return false;
    const Eigen::Vector3d all = solve(given, true);
    const double moves = std::sqrt(hessian(2, 2)) * std::abs(all(2)), parameter = all(2) * scale(2);
    const model::EffectParameter& card = law->parameters.front();
    return left(all) < thresholds::law_takes_away * left(solve(given, false)) &&
           moves > thresholds::law_moves * std::sqrt(loads) && parameter >= card.lower && parameter <= card.upper;
  }
  [[nodiscard]] TyreLaw with(const Given& given, const Eigen::Vector3d& d, std::optional<double> lowest) const {
    return {given.value(k_t) + d(0) * scale(0), given.value(b_t) + d(1) * scale(1), law, d(2) * scale(2), lowest};
  }
};
TyreFit tyre_fit(const std::vector<PreparedRecording>& recordings, const Given& given, const TyreLaw& bounded,
                 const firmware::CatalogueEntry& law) {
  TyreFit fit;
  fit.law = &law;
  for (const PreparedRecording& r : recordings) {
    for_each_load(r, r.fitted, [&](double dz, double rate, double load) {
      const double left = load - given.value(k_t) * dz - given.value(b_t) * rate;
      fit.loads += load * load;
      if (bounded.bounds(load)) {
        fit.error_bounded += left * left;
        return;
      }
      const Eigen::Vector3d row(dz, rate, per_unit(law, dz));
      fit.hessian += row * row.transpose();
      fit.gradient -= row * left;
      fit.error += left * left;
      fit.samples += 1.0;
    });
  }
  if (!(fit.samples > 0.0)) return fit;
  fit.scale = fit.hessian.diagonal().cwiseSqrt().cwiseInverse();
  fit.hessian = (fit.scale.asDiagonal() * fit.hessian * fit.scale.asDiagonal()).eval();
  fit.gradient = (fit.scale.asDiagonal() * fit.gradient).eval();
  return fit;
}

/// rms of what a law leaves ÷ rms of F_w, over held-out samples; over fitted ones where nothing is held out.
double tyre_error(const std::vector<PreparedRecording>& recordings, const TyreLaw& law) {
  double error = 0.0, loads = 0.0;
  for (const bool held_out : {true, false}) {
    if (loads > 0.0) break;
    for (const PreparedRecording& r : recordings) {
      for_each_load(r, held_out ? r.held_out : r.fitted, [&](double dz, double rate, double load) {
        error += std::pow(load - law.load(dz, rate), 2);
        loads += load * load;
      });
    }
  }
  return loads > 0.0 ? std::sqrt(error / loads) : 0.0;
}

/// The law that bounds F_w, if there is one; `law` holds the bound afterwards.
const firmware::CatalogueEntry* find_bounding_law(const model::RigParameters<double>& rig,
                                                  const std::vector<PreparedRecording>& recordings, TyreLaw& law) {
  for (const BoundingLaw& candidate : bounding_laws(rig)) {
    law.lowest = bounded_load(candidate.bound, recordings);
    if (law.lowest) return candidate.entry;
  }
  return nullptr;
}

/// The laws of the tyre; `law` becomes the law with them.
void find_tyre_effects(const firmware::RigDescription& description, const std::vector<PreparedRecording>& recordings,
                       const Given& given, TyreLaw& law, VirtualCarEstimate& car) {
  const firmware::CatalogueEntry* const bounding = find_bounding_law(description.rig, recordings, law);
  TyreFit fit;
  bool found = false;
  for (const firmware::CatalogueEntry* const candidate : proportional_laws()) {
    TyreFit other = tyre_fit(recordings, given, law, *candidate);
    if (!(other.samples > 0.0) || !(other.loads > 0.0)) return;
    const bool other_found = other.is_found(given);
    const bool better =
        other_found && (!found || other.left(other.solve(given, true)) < fit.left(fit.solve(given, true)));
    if (fit.law == nullptr || better) fit = other;
    found = found || other_found;
  }
  if (fit.law == nullptr) return;
  const Eigen::Vector3d linear = fit.solve(given, false), all = found ? fit.solve(given, true) : linear;
  // Neighbouring samples are off alike.
  const double independent = fit.samples / thresholds::correlated_samples;
  const double variance = std::max(fit.left(all), 1e-30 * fit.loads) / independent;
  const auto add = [&](const firmware::CatalogueEntry* entry, double gain) -> TyreEffect& {
    TyreEffect& added = car.effects.emplace_back();
    added.effect.entry = entry;
    added.gain = gain;
    added.count = independent;
    return added;
  };
  if (bounding != nullptr) add(bounding, fit.error_bounded / variance);
  if (found) {
    const double parameter = all(2) * fit.scale(2);
    const double deviation = std::sqrt(variance * fit.variance_of_parameter()) * fit.scale(2);
    TyreEffect& tyre = add(fit.law, (fit.left(linear) - fit.left(all)) / variance);
    tyre.effect.values.push_back(parameter);
    tyre.parameters.push_back({parameter, deviation + thresholds::law_difference_error * std::abs(parameter)});
  }
  car.tyre_error = {tyre_error(recordings, {given.value(k_t), given.value(b_t), nullptr, 0.0, std::nullopt}),
                    tyre_error(recordings, fit.with(given, linear, std::nullopt)),
                    tyre_error(recordings, fit.with(given, all, law.lowest))};
  law = fit.with(given, all, law.lowest);
}

/// (1)–(3) of one recording's fitted window.
void add_equations(const PreparedRecording& prepared, const TyreLaw& law, Normal& all) {
  const firmware::Recording& r = prepared.recording;
  if (prepared.fitted.size() == 0 || !r.has(Channel::x_cmd) || !r.has(Channel::F)) return;
  const auto x_rate = velocity(r[Channel::x_cmd], 1.0 / r.sample_period);
  const TyreMotion tyre = tyre_motion(r);
  Normal body, wheel, load;
  for (std::size_t k = prepared.fitted.from + 2; k + 2 < prepared.fitted.to; ++k) {
    const double force = r[Channel::F][k];
    Row row = Row::Zero();
    if (r.has(Channel::zdd_b)) {
      row(m_b) = r[Channel::zdd_b][k];
      row(b_v) = -x_rate[k];
      body.add(row, force);
    }
    if (r.has(Channel::zdd_w) && r.has(Channel::F_w)) {
      row.setZero();
      row(m_w) = r[Channel::zdd_w][k];
      row(b_v) = x_rate[k];
      wheel.add(row, r[Channel::F_w][k] - force);
    }
    if (r.has(Channel::F_w) && !tyre.deflection.empty() && !law.bounds(r[Channel::F_w][k])) {
      const double dz = tyre.deflection[k];
      row.setZero();
      row(k_t) = dz;
      row(b_t) = tyre.rate[k];
      load.add(row, r[Channel::F_w][k] - law.force(dz));
    }
  }
  body.add_to(all);
  wheel.add_to(all);
  load.add_to(all);
}

/// (1)–(3) with one law of the tyre, solved within bounds.
struct CarFit {
  Normal equations;
  Row values = Row::Zero();
  double left = 0.0;  ///< Σ residual², in units of the equations

  /// Standard error of a value, and what its differences are off.
  [[nodiscard]] double error(Eigen::Index i) const {
    const double variance = std::max(left, 0.0) / equations.samples;
    return std::sqrt(variance / std::max(equations.matrix(i, i), 1e-300)) +
           thresholds::difference_error * std::abs(values(i));
  }
};
CarFit fit_car(const Normal& equations, const Given& given) {
  CarFit fit{equations, given.value, 0.0};
  // In deviations from the given values, each in units of the value, so that all are of one size.
  const Row scale = given.value.cwiseAbs().cwiseMax(1e-9);
  const Eigen::MatrixXd h = scale.asDiagonal() * equations.matrix * scale.asDiagonal();
  const Eigen::VectorXd g = scale.asDiagonal() * (equations.matrix * given.value - equations.right);
  fit.values +=
      bounded_step(h, g, {given.lower.cwiseQuotient(scale), given.upper.cwiseQuotient(scale)}).cwiseProduct(scale);
  fit.left = fit.values.dot(equations.matrix * fit.values) - 2.0 * fit.values.dot(equations.right) + equations.square;
  return fit;
}

/// The same with these values bound by no tolerance: within a factor of thresholds::parameter_range.
Given freed(Given given, const std::vector<Eigen::Index>& which) {
  for (const Eigen::Index i : which) {
    given.lower(i) = (1.0 / thresholds::parameter_range - 1.0) * given.value(i);
    given.upper(i) = (thresholds::parameter_range - 1.0) * given.value(i);
  }
  return given;
}

/// The values with which the program does not compute as described: beyond their tolerance and the error of the
/// estimate, where freeing them takes away nearly all that is left without.
std::vector<Eigen::Index> values_off(const Normal& equations, const Given& given) {
  std::vector<Eigen::Index> seen, off;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (given.value(i) > 0.0 && equations.matrix(i, i) > 0.0) seen.push_back(i);
  }
  const CarFit wide = fit_car(equations, freed(given, seen));
  for (const Eigen::Index i : seen) {
    const double allowed = std::max(given.upper(i), thresholds::rounding * given.value(i));
    if (std::abs(wide.values(i) - given.value(i)) > allowed + 3.0 * wide.error(i)) off.push_back(i);
  }
  if (off.empty()) return off;
  const double left = fit_car(equations, freed(given, off)).left, without = fit_car(equations, given).left;
  return left < thresholds::freed_number_leaves * without ? off : std::vector<Eigen::Index>();
}

Normal equations_of(const std::vector<PreparedRecording>& recordings, const TyreLaw& law) {
  Normal all;
  for (const PreparedRecording& r : recordings) add_equations(r, law, all);
  return all;
}

}  // namespace

VirtualCarEstimate estimate_virtual_car(const firmware::RigDescription& description,
                                        const std::vector<PreparedRecording>& recordings) {
  VirtualCarEstimate car;
  if (description.rig.kind != model::RigKind::hil) return car;
  const Given given = given_values(description);
  // A tyre that is softer than described is no law of the tyre: the law is asked for beside free numbers, too.
  const Given free = freed(given, {k_t, b_t});
  TyreLaw law;
  find_tyre_effects(description, recordings, free, law, car);
  Normal all = equations_of(recordings, law);
  if (!(all.samples > 0.0)) return car;
  const std::vector<Eigen::Index> off = values_off(all, given);
  const auto is_off = [&](Eigen::Index i) { return std::find(off.begin(), off.end(), i) != off.end(); };
  if (!is_off(k_t) && !is_off(b_t)) {
    car = {};
    law = {};
    find_tyre_effects(description, recordings, given, law, car);
    all = equations_of(recordings, law);
  }
  const CarFit fit = fit_car(all, freed(given, off));
  const double without = off.empty() ? 0.0 : fit_car(all, given).left;
  const double variance = std::max(fit.left, 1e-30 * all.square) / all.samples;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (!(given.upper(i) > 0.0) && !is_off(i)) continue;
    const std::string path(parameter_paths[static_cast<std::size_t>(i)]);
    car.parameters[path] = {fit.values(i), fit.error(i)};
    if (is_off(i)) {
      car.off.push_back({path, given.value(i), (without - fit.left) / variance / thresholds::correlated_samples});
    }
  }
  return car;
}

}  // namespace host_sim::identification
