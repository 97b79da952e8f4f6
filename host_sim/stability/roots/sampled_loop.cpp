#include "host_sim/stability/roots/sampled_loop.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "host_sim/stability/roots/delay_equation.hpp"
#include "host_sim/stability/roots/eigenvalues.hpp"
#include "host_sim/stability/roots/linear_rig.hpp"
#include "host_sim/stability/roots/step_state.hpp"
#include "model/rig/rig_model.hpp"

namespace host_sim::stability {
namespace {

using Rig = model::RigModel<>;

/// Calls visit(value, is_force) for every value of a state that the step reads, except the machine's delay line.
template <class Visit>
void for_each_own(const Rig& model, Rig::State& x, const Visit& visit) {
  for (Eigen::Index i = 0; i < x.core.size(); ++i) visit(x.core(i), false);
  for_each_behind_the_car(model, x, visit);
}

/// The same, followed by the delay line, newest sample first.
template <class Visit>
void for_each_scalar(const Rig& model, Rig::State& x, std::size_t line, const Visit& visit) {
  for_each_own(model, x, visit);
  for (std::size_t i = 0; i < line; ++i) {
    visit(x.line.ago(i).position, false);
    visit(x.line.ago(i).velocity, false);
  }
}

/// `x` with its value `at` moved by `unit`.
Rig::State moved(const Rig& model, Rig::State x, std::size_t line, Eigen::Index at, double unit) {
  Eigen::Index i = 0;
  for_each_scalar(model, x, line, [&](double& value, bool) { value += i++ == at ? unit : 0.0; });
  return x;
}

Eigen::VectorXd read(const Rig& model, Rig::State& x, std::size_t line, Eigen::Index size) {
  Eigen::VectorXd values(size);
  Eigen::Index i = 0;
  for_each_scalar(model, x, line, [&](double& value, bool) { values(i++) = value; });
  return values;
}

model::RigParameters<double> with_delay(model::RigParameters<double> rig, double delay) {
  rig.effects.add(model::ActuatorDelay<double>{delay});
  return rig;
}

/// Sets the model in motion, then runs model and matrix side by side. A linear rig in a large motion keeps its digits
/// (1e-7); one with a lever or an air spring moves by 0.1 µm, of which the square of the motion over a travel of some
/// 0.1 m leaves 1e-6, and rounding beside the pressure at rest less.
void check(const Rig& model, const StepMatrix& step) {
  const bool nonlinear = is_nonlinear(model.parameters());
  const double motion = nonlinear ? 1e-5 : 1.0, tolerance = nonlinear ? 1e-5 : 1e-7;
  Rig::State x = model.start();
  const Eigen::VectorXd rest = read(model, x, step.line, step.matrix.rows());
  Rig::Input in;
  const std::size_t warm_up = 3 * step.line + 50;
  for (std::size_t k = 0; k < warm_up; ++k) {
    const double t = static_cast<double>(k);
    in.foot_point = {motion * (1e-2 * std::sin(0.3 * t) + 5e-3 * std::sin(1.7 * t)), motion * std::cos(0.3 * t), 0.0};
    model.step(x, in);
  }
  in = {};
  model.step(x, in);  // the foot point comes to rest
  Eigen::VectorXd y = read(model, x, step.line, step.matrix.rows()) - rest;
  // Each value is compared with the largest of its kind, because the state mixes metres and newtons.
  std::array<double, 2> size{};
  const auto measure = [&] {
    Eigen::Index i = 0;
    for_each_scalar(model, x, step.line, [&](double& value, bool force) {
      size[force ? 1 : 0] = std::max(size[force ? 1 : 0], std::abs(value - rest(i++)));
    });
  };
  measure();
  for (int k = 0; k < 20; ++k) {
    model.step(x, in);
    y = (step.matrix * y).eval();
    measure();
  }
  Eigen::Index i = 0;
  for_each_scalar(model, x, step.line, [&](double& truth, bool force) {
    if (!(std::abs(y(i) + rest(i) - truth) <= tolerance * size[force ? 1 : 0])) {
      throw std::logic_error("stability: the matrix of a step departs from the model's step in state " +
                             std::to_string(i));
    }
    ++i;
  });
}

StepMatrix only_the_loop(const StepMatrix& step, std::size_t force_at) {
  const auto size = static_cast<std::size_t>(step.matrix.rows());
  std::vector<bool> force(size);
  force[force_at] = true;
  const std::vector<bool> driven = reached(step.matrix, force), seen = reached(step.matrix.transpose(), force);
  std::vector<Eigen::Index> kept;
  StepMatrix loop;
  loop.line = step.line;
  for (std::size_t i = 0; i < size; ++i) {
    const bool of_line = i >= step.own;
    if (!of_line && !(driven[i] && seen[i])) continue;
    if (i == force_at) loop.force = kept.size();
    kept.push_back(static_cast<Eigen::Index>(i));
    loop.own += of_line ? 0 : 1;
  }
  loop.matrix = step.matrix(kept, kept);
  return loop;
}

/// The eigenvector of an eigenvalue λ has λ^{−i} times the newest sample at the line's place i, which leaves a small
/// matrix M(λ) with det(M(λ) − λ) = 0.
class SmallEquation {
 public:
  explicit SmallEquation(const StepMatrix& step)
      : step_(step), own_(static_cast<Eigen::Index>(step.own)), size_(own_ + (step.line > 0 ? 2 : 0)) {}

  [[nodiscard]] Complex operator()(Complex lambda) const {
    Eigen::MatrixXcd m = step_.matrix.topLeftCorner(size_, size_).cast<Complex>();
    Complex factor = 1.0;
    for (std::size_t i = 1; i < step_.line; ++i) {
      factor /= lambda;
      const auto at = own_ + 2 * static_cast<Eigen::Index>(i);
      m.rightCols(2) += factor * step_.matrix.block(0, at, size_, 2).cast<Complex>();
    }
    m.diagonal().array() -= lambda;
    return m.determinant();
  }

  /// The eigenvalue next to `lambda`, by the secant method.
  [[nodiscard]] std::optional<Complex> settle(Complex lambda) const {
    Complex before = lambda * Complex(1.0, 1e-5);
    Complex f_before = (*this)(before);
    for (int i = 0; i < 50; ++i) {
      const Complex f = (*this)(lambda);
      const Complex slope = (f - f_before) / (lambda - before);
      if (f == Complex() || slope == Complex()) return lambda;
      const Complex step = f / slope;
      if (!std::isfinite(std::abs(step))) return std::nullopt;
      before = lambda;
      f_before = f;
      lambda -= step;
      if (std::abs(step) < 1e-14 || lambda == before) return lambda;
    }
    return std::nullopt;
  }

 private:
  const StepMatrix& step_;
  Eigen::Index own_, size_;
};

constexpr std::size_t most_states_to_prove = 500;  // one dense eigenvalue problem of this size takes a second

/// Delay at which the eigenvalue that starts at e^{jωT} reaches the unit circle.
std::optional<double> follow(const model::RigParameters<double>& rig, double period, const ContinuousBorder& border) {
  const double longest = static_cast<double>(Rig::Line::longest) * period;
  Complex lambda = std::polar(1.0, border.omega * period);
  const double start = std::clamp(border.delay - 0.5 * period, 0.0, longest);
  const double beside = std::clamp(start * 0.999 + 1e-3 * period, 0.0, longest) - start;
  const auto found = value_on_circle([&](double delay) { return step_matrix(rig, period, delay); }, start, beside,
                                     period, lambda, 0.0, longest);
  return found;
}

/// The same by bisection on the spectral radius.
std::optional<double> search(const model::RigParameters<double>& rig, double period, double upper) {
  const auto unstable = [&](double delay) { return spectral_radius(step_matrix(rig, period, delay)) >= 1.0; };
  if (unstable(0.0) || !unstable(upper)) return std::nullopt;
  double low = 0.0, high = upper;
  while (high - low > 1e-12 * upper) {
    const double middle = 0.5 * (low + high);
    (unstable(middle) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

StepMatrix step_matrix(const model::RigParameters<double>& rig, double period, double delay) {
  if (!(delay <= static_cast<double>(Rig::Line::longest) * period)) {
    throw UnfitLoop("the loop delay exceeds the capacity of the delay line at this sample rate");
  }
  const Rig model(with_delay(rig, delay), period);
  StepMatrix result;
  Rig::State start = model.start();
  std::size_t force_at = 0;
  for_each_own(model, start, [&](double& value, bool) {
    if (&value == &start.received_force) force_at = result.own;
    ++result.own;
  });
  result.line = samples_read(delay, period);
  const auto size = static_cast<Eigen::Index>(result.own + 2 * result.line);
  result.matrix.resize(size, size);
  for (Eigen::Index j = 0; j < size; ++j) {
    result.matrix.col(j) = slope(model.parameters(), [&](double unit) {
      Rig::State x = moved(model, start, result.line, j, unit);
      model.step(x, {});
      return read(model, x, result.line, size);
    });
  }
  check(model, result);
  return only_the_loop(result, force_at);
}

LoopResponse::LoopResponse(StepMatrix step, double period) : closed_(std::move(step)), open_(closed_), period_(period) {
  open_.matrix.col(static_cast<Eigen::Index>(open_.force)).setZero();
}

Complex LoopResponse::operator()(double omega) const {
  const Complex z = std::polar(1.0, omega * period_);
  return SmallEquation(closed_)(z) / SmallEquation(open_)(z) - 1.0;
}

double spectral_radius(const StepMatrix& step) {
  double radius = 0.0;
  for (const Complex& value : eigenvalues(step.matrix)) radius = std::max(radius, std::abs(value));
  return radius;
}

std::optional<double> value_on_circle(const std::function<StepMatrix(double)>& step_at, double start, double beside,
                                      double period, Complex& lambda, double lowest, double highest) {
  const auto excess = [&](double value) -> std::optional<double> {
    const StepMatrix step = step_at(value);
    const auto settled = SmallEquation(step).settle(lambda);
    if (!settled) return std::nullopt;
    lambda = *settled;
    return std::log(std::abs(lambda)) / period;
  };
  double a = start, b = start + beside;
  auto at_a = excess(a);
  for (int i = 0; at_a && i < 60; ++i) {
    const auto at_b = excess(b);
    if (!at_b) return std::nullopt;
    if (std::abs(*at_b) < 1e-11 || std::abs(b - a) < 1e-15) return b;
    const double next = b - *at_b * (b - a) / (*at_b - *at_a);
    if (!(next >= lowest) || next > highest) return std::nullopt;
    a = b;
    at_a = at_b;
    b = next;
  }
  return std::nullopt;
}

std::optional<double> sampled_border(const model::RigParameters<double>& rig, double period,
                                     const ContinuousBorder& border) {
  return follow(rig, period, border);
}

SampledLoop sampled_loop(const model::RigParameters<double>& rig, double period, double delay,
                         const std::optional<ContinuousBorder>& critical) {
  SampledLoop result;
  result.period = period;
  const StepMatrix step = step_matrix(rig, period, delay);
  result.states = static_cast<std::size_t>(step.matrix.rows());
  for (const Complex& value : eigenvalues(step.matrix)) {
    if (value.imag() >= 0.0) result.eigenvalues.push_back(value);
  }
  std::sort(result.eigenvalues.begin(), result.eigenvalues.end(),
            [](Complex a, Complex b) { return std::abs(a) > std::abs(b); });
  result.spectral_radius = std::abs(result.eigenvalues.front());
  if (!critical) return result;

  result.critical_delay = follow(rig, period, *critical);
  if (result.critical_delay) {  // is it the largest eigenvalue that got there?
    const StepMatrix border = step_matrix(rig, period, *result.critical_delay);
    if (static_cast<std::size_t>(border.matrix.rows()) <= most_states_to_prove &&
        std::abs(spectral_radius(border) - 1.0) > 1e-8) {
      result.critical_delay.reset();
    }
  }
  const double upper = critical->delay + period;
  if (!result.critical_delay && upper / period < static_cast<double>(most_states_to_prove) / 2.0) {
    result.critical_delay = search(rig, period, std::min(upper, static_cast<double>(Rig::Line::longest) * period));
  }
  if (result.critical_delay) result.added_delay = critical->delay - *result.critical_delay;
  return result;
}

}  // namespace host_sim::stability
